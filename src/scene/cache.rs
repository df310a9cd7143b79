//! Folders of what was made of files once and can be made again: an entry is a file, named by what it was made of.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Marks an entry as used now: those that are used stay longest.
pub fn touch(path: &Path) {
    // Nothing is lost where it cannot be told.
    let _ = File::options().append(true).open(path).and_then(|file| file.set_modified(SystemTime::now()));
}

/// Removes the entries of an ending that were not used for longest, until the others take at most so many bytes.
pub fn evict(folder: &Path, ending: &str, most_bytes: u64) {
    let mut entries: Vec<(SystemTime, u64, PathBuf)> = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|of| of == ending)
            && let Ok(metadata) = entry.metadata()
        {
            entries.push((metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH), metadata.len(), path));
        }
    }
    entries.sort_unstable();
    let mut taken: u64 = entries.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, bytes, path) in entries {
        if taken <= most_bytes {
            return;
        }
        // Another process may have been first.
        let _ = fs::remove_file(path);
        taken -= bytes;
    }
}
