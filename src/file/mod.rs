//! Files that a user names: input that is there to its end, and output that appears whole or not at all. CPU only.

use std::io;
use std::path::Path;

use tempfile::NamedTempFile;

#[cfg(unix)]
mod fifo;
mod input;
mod output;
mod temporary;

pub use input::{below, open, read, read_text};
pub use output::{OutputError, check_writable, destination, is_pipe, write, write_unsynced, write_with};

/// A file in the system's temporary folder, removed when dropped; the next one removes what killed processes left there.
///
/// # Errors
/// Of a temporary folder that takes no file.
pub fn temporary() -> io::Result<NamedTempFile> {
    let folder = std::env::temp_dir();
    temporary::sweep(&folder);
    temporary::create(&folder)
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
