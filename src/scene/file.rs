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
    let is_name = source.kind() == ErrorKind::NotFound && path.extension().is_none();
    let path = path.to_owned();
    match (source.kind(), asset.built_in()) {
        (ErrorKind::InvalidInput, _) => Error::NotAFile { path, asset },
        (_, Some(names)) if is_name => Error::UnknownName { path, asset, known: format!("{names}, or a file") },
        _ => Error::Read { path, source },
    }
}

/// The error of a file with an ending that is not known, or of a name that no file has.
pub(super) fn of_unknown_ending(path: &Path, asset: Asset, ending: &str, known: String) -> Error {
    let is_missing = std::fs::symlink_metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound);
    let (path, ending) = (path.to_owned(), ending.to_owned());
    match asset.built_in() {
        Some(names) if is_missing && ending.is_empty() => {
            Error::UnknownName { path, asset, known: format!("{names}, or a file that ends in {known}") }
        }
        _ => Error::UnknownEnding { path, asset, ending, known },
    }
}

/// The file beside `path` with another ending, if there is one: whoever opens it finds out that it is none.
///
/// # Errors
/// A link out of the folder: what is read there could be shown by a message.
pub(super) fn beside(path: &Path, ending: &str) -> Result<Option<PathBuf>, Error> {
    let path = path.with_extension(ending);
    let folder = path.parent().unwrap_or(Path::new(""));
    let Some(name) = path.file_name().filter(|_| path.symlink_metadata().is_ok()) else { return Ok(None) };
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
