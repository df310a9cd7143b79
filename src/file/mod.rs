//! Files that a user names: input that is there to its end, and output that appears whole or not at all. CPU only.

use std::io;
use std::path::Path;

use tempfile::NamedTempFile;

#[cfg(unix)]
mod fifo;
mod input;
mod output;
mod sink;
mod temporary;

pub use input::{below, open, read, read_text};
pub use output::{OutputError, check_writable, destination, is_pipe, write, write_unsynced, write_with};
pub use sink::{Sink, heed};

/// A file in the system's temporary folder, removed when dropped; the next one removes what killed processes left there.
///
/// # Errors
/// Of a temporary folder that takes no file; the message names it.
pub fn temporary() -> io::Result<NamedTempFile> {
    temporary_in(&std::env::temp_dir())
}

fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let variable = if cfg!(windows) { "TMP" } else { "TMPDIR" };
    temporary::sweep(folder);
    temporary::create(folder).map_err(|error| {
        let reason = if folder.is_dir() { error.to_string() } else { "it is no folder".to_owned() };
        let making = format!("making a temporary file in {}: {reason}", folder.display());
        io::Error::new(error.kind(), format!("{making}; name a folder that takes files in {variable}"))
    })
}

/// A file for what two processes of this program hand each other, removed when dropped: in `TMPDIR` where that is set, else
/// in memory where the system has a folder for that.
///
/// # Errors
/// Of a temporary folder that takes no file.
pub fn exchange() -> io::Result<NamedTempFile> {
    let folder = Path::new("/dev/shm");
    if std::env::var_os("TMPDIR").is_some() || !folder.is_dir() {
        return temporary();
    }
    temporary::sweep(folder);
    temporary::create(folder).or_else(|_| temporary())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_temporary_folder_that_takes_no_file_is_named() {
        let file = NamedTempFile::new().unwrap();
        for folder in [file.path(), &file.path().join("below"), Path::new("/no/such/folder")] {
            let error = temporary_in(folder).unwrap_err().to_string();
            let told = format!("making a temporary file in {}: it is no folder; name a folder", folder.display());
            assert!(error.starts_with(&told) && error.contains("TMP"), "{error}");
        }
    }
}
