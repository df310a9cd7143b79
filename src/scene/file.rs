//! Files of the scene, with messages that say what they were read as.

use crate::file;
use crate::scene::Error;
use crate::scene::error::Asset;
use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Opens a regular file, and tells its size in bytes.
pub(super) fn open(path: &Path, asset: Asset) -> Result<(File, u64), Error> {
    file::open(path).map_err(|source| failed(path, asset, source))
}

/// The error of a file that cannot be read.
pub(super) fn failed(path: &Path, asset: Asset, source: io::Error) -> Error {
    let path = path.to_owned();
    if source.kind() == ErrorKind::InvalidInput {
        Error::NotAFile { path, asset }
    } else {
        Error::Read { path, source }
    }
}

/// The file beside `path` with another ending, if there is one.
///
/// # Errors
/// A link out of the folder: what is read there could be shown by a message.
pub(super) fn beside(path: &Path, ending: &str) -> Result<Option<PathBuf>, Error> {
    let path = path.with_extension(ending);
    let folder = path.parent().unwrap_or(Path::new(""));
    let Some(name) = path.file_name().filter(|_| path.is_file()) else { return Ok(None) };
    match file::below(folder, Path::new(name)) {
        Ok(_) => Ok(Some(path)),
        Err(source) => Err(Error::Read { path, source }),
    }
}

/// The file beside `path` with one of some endings, the first that is there.
///
/// # Errors
/// As [`beside`]; `missing` of the name without an ending where there is none.
pub(super) fn first_beside(
    path: &Path,
    endings: &[&str],
    missing: impl FnOnce(&str) -> Error,
) -> Result<PathBuf, Error> {
    for ending in endings {
        if let Some(found) = beside(path, ending)? {
            return Ok(found);
        }
    }
    Err(missing(&path.with_extension("").file_name().unwrap_or_default().to_string_lossy()))
}
