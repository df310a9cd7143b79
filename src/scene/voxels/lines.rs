//! Lines of the text that a file of samples begins with.

use std::collections::HashMap;
use std::fmt::Display;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::VoxelGrid;
use super::header::Header;
use super::source::{beside, malformed};
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::{Error, file};

/// Headers are a few lines.
const MOST_BYTES: u64 = 1 << 20;
/// Bytes of the longest path that Linux takes.
const LONGEST_NAME: usize = 4096;

/// Reads the fields of a format's header.
type ReadFields = fn(&mut BufReader<File>) -> Result<Fields, Fault>;
/// The file of the samples by the fields of the header at that path, where they are not behind it.
type SamplesPath = fn(&Fields, &Path) -> Result<Option<PathBuf>, Error>;

/// Reads a file with its samples in it, or the one that its header names.
///
/// # Errors
/// [`Error::Read`]; [`Error::Malformed`] with the file that is.
pub(super) fn load(
    path: &Path,
    component: u32,
    fields: ReadFields,
    header: fn(&Fields) -> Result<Header, Fault>,
    samples_path: SamplesPath,
) -> Result<VoxelGrid, Error> {
    let (file, size_bytes) = file::open(path, Asset::Volume)?;
    let mut input = BufReader::new(file);
    let fields = fields(&mut input).map_err(|fault| malformed(path, fault))?;
    let header = header(&fields).map_err(|fault| malformed(path, fault))?;
    let Some(data) = samples_path(&fields, path)? else {
        return header.grid(input, size_bytes, component).map_err(|fault| malformed(path, fault));
    };
    let (file, size_bytes) = file::open(&data, Asset::Volume)?;
    header.grid(BufReader::new(file), size_bytes, component).map_err(|fault| malformed(&data, fault))
}

/// The file of the samples, where they are not in the header's own.
///
/// # Errors
/// As [`load`].
pub(super) fn data_path(path: &Path, fields: ReadFields, samples_path: SamplesPath) -> Result<Option<PathBuf>, Error> {
    let (file, _) = file::open(path, Asset::Volume)?;
    let fields = fields(&mut BufReader::new(file)).map_err(|fault| malformed(path, fault))?;
    samples_path(&fields, path)
}

/// The lines of a header, from 1, up to the first of which `is_last` says so, or the end; what follows is left.
///
/// # Errors
/// A header of more than a megabyte; what the system answers.
pub(super) fn read(input: &mut impl BufRead, is_last: impl Fn(&str) -> bool) -> Result<Vec<(usize, String)>, Fault> {
    let mut lines = Vec::new();
    let mut left = MOST_BYTES;
    for number in 1.. {
        let mut bytes = Vec::new();
        let read = input.by_ref().take(left).read_until(b'\n', &mut bytes);
        let read = read.map_err(|error| Fault::foreign(Place::Line(number), &error))? as u64;
        if read == 0 {
            break;
        }
        left -= read;
        if left == 0 {
            return Err(Fault::new(Place::Whole, "its header takes more than 1 MiB; it is damaged or something else"));
        }
        let line = String::from_utf8_lossy(&bytes).trim_end_matches(['\r', '\n']).to_owned();
        let is_end = is_last(&line);
        lines.push((number, line));
        if is_end {
            break;
        }
    }
    Ok(lines)
}

/// A text of the file, short enough for a message.
pub(super) fn shown(text: &str) -> String {
    format!("{:?}", text.chars().take(40).collect::<String>())
}

/// The fields of a header by their names, with their lines.
#[derive(Default)]
pub(super) struct Fields(HashMap<String, (usize, String)>);

impl Fields {
    /// Takes in a field.
    ///
    /// # Errors
    /// One that is there.
    pub(super) fn insert(&mut self, line: usize, key: String, value: &str) -> Result<(), Fault> {
        let Some((before, _)) = self.0.get(&key) else {
            self.0.insert(key, (line, value.trim().to_owned()));
            return Ok(());
        };
        Err(Fault::new(Place::Line(line), format!("{} stands on line {before} already", shown(&key))))
    }

    pub(super) fn get(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(|(_, value)| value.as_str())
    }

    pub(super) fn required(&self, key: &str) -> Result<&str, Fault> {
        self.get(key).ok_or_else(|| Fault::new(Place::Whole, format!("its header has no field {key}")))
    }

    pub(super) fn fault(&self, key: &str, reason: impl Display) -> Fault {
        let place = self.0.get(key).map_or(Place::Whole, |(line, _)| Place::Line(*line));
        Fault::new(place, format!("{key} {reason}"))
    }

    pub(super) fn number<T: FromStr>(&self, key: &str, text: &str) -> Result<T, Fault> {
        text.parse().map_err(|_| self.fault(key, format!("has {}, not a number of its kind", shown(text))))
    }

    /// The file of the samples by the field of that name, in the header's folder or below.
    pub(super) fn data_path(&self, key: &str, header: &Path) -> Result<Option<PathBuf>, Error> {
        let Some(name) = self.get(key) else { return Ok(None) };
        if name == "LIST" || name.starts_with("LIST ") || name.contains('%') {
            let fault = self.fault(key, "names several files; save the volume as one file");
            return Err(malformed(header, fault));
        }
        // A message would show what no file is called.
        if name.len() > LONGEST_NAME || name.contains(char::is_control) {
            let fault = self.fault(key, format!("is {}, no name of a file", shown(name)));
            return Err(malformed(header, fault));
        }
        beside(header, name).map(Some)
    }
}
