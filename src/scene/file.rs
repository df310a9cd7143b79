use crate::scene::Error;
use crate::scene::error::Asset;
use std::fs::{self, File};
use std::path::Path;

/// Opens a regular file, which rules out devices and pipes that never end, and tells its size in bytes.
pub(super) fn open(path: &Path, asset: Asset) -> Result<(File, u64), Error> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(Error::NotAFile { path: path.to_owned(), asset });
    }
    Ok((File::open(path).map_err(failed)?, metadata.len()))
}
