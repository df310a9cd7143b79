//! Files that a command reads, which nothing that it writes may replace.

use std::fs;
use std::path::{Path, PathBuf};

use super::options::MachineArgs;
use crate::measure::parameter::Parameter;
use crate::measure::study::Study;
use crate::scene::read_files;

/// Folders in each other, and entries of one, that are looked at: a larger tree is refused as shaders.
const MOST_FOLDERS: usize = 16;
const MOST_ENTRIES: usize = 8192;

/// The files that parameters of `values` name, with those that are read through them.
pub fn named<S: 'static>(parameters: &[Parameter<S>], values: &S) -> Vec<PathBuf> {
    let files = parameters.iter().flat_map(|parameter| parameter.files(values));
    files.flat_map(|path| read_files(&path)).collect()
}

/// The files that a paper reads, as its parameters name them, and the shaders that stand in for the built-in ones.
pub fn by_study<S: Study>(study: &S, machine: &MachineArgs) -> Vec<PathBuf> {
    let mut read = named(&S::parameters(), study);
    read.extend(by_machine(machine));
    read
}

/// The shaders that stand in for the built-in ones.
pub fn by_machine(machine: &MachineArgs) -> Vec<PathBuf> {
    let mut found = Vec::new();
    if let Some(folder) = machine.shader_dir() {
        list_shaders(folder, 0, &mut found);
    }
    found
}

/// Links to folders are left out: shaders below one are refused.
fn list_shaders(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().take(MOST_ENTRIES).flatten() {
        let path = entry.path();
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            if depth < MOST_FOLDERS {
                list_shaders(&path, depth + 1, found);
            }
        } else {
            // A shader may include any of them.
            found.push(path);
        }
    }
}
