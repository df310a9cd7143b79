//! Pipes that have a name: whoever opens one to write waits for a reader, and whoever closes it ends what is read.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::os::unix::fs::{FileTypeExt, MetadataExt, OpenOptionsExt};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::libc;

/// Time that a reader has to come: a shell starts it beside this program.
const PATIENCE: Duration = Duration::from_secs(2);
const BETWEEN_LOOKS: Duration = Duration::from_millis(5);

/// The device and the number of a file, which its other names share.
type Identity = (u64, u64);

/// Pipes that were found to have a reader: closed before they are written, they would have told it that this was all.
static HELD: Mutex<Vec<(Identity, File)>> = Mutex::new(Vec::new());

fn identity(path: &Path) -> Option<Identity> {
    let metadata = fs::metadata(path).ok().filter(|metadata| metadata.file_type().is_fifo())?;
    Some((metadata.dev(), metadata.ino()))
}

/// True of a pipe.
pub fn is_fifo(path: &Path) -> bool {
    identity(path).is_some()
}

/// Holds the pipe open until it is [written](open), if it has a reader; false if none has come after a while.
///
/// # Errors
/// Those of the system.
pub fn hold(path: &Path) -> io::Result<bool> {
    let identity = identity(path);
    let is_held = |held: &[(Identity, File)]| held.iter().any(|(known, _)| Some(*known) == identity);
    if is_held(&HELD.lock().unwrap_or_else(PoisonError::into_inner)) {
        return Ok(true);
    }
    let Some(file) = with_reader(path)? else { return Ok(false) };
    let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
    held.extend(identity.map(|identity| (identity, file)));
    Ok(true)
}

/// The pipe, to be written; `None` if no reader has come after a while. Once it is closed its reader is at the end.
///
/// # Errors
/// Those of the system.
pub fn open(path: &Path) -> io::Result<Option<File>> {
    let identity = identity(path);
    // Not opened a second time: where its reader has gone meanwhile, that would wait for another one.
    let file = with_reader(path)?.map(waiting_for_room).transpose()?;
    if file.is_some() {
        HELD.lock().unwrap_or_else(PoisonError::into_inner).retain(|(known, _)| Some(*known) != identity);
    }
    Ok(file)
}

/// The pipe, whose writes wait for room: what was opened without waiting does not wait for that either.
fn waiting_for_room(file: File) -> io::Result<File> {
    let flags = OFlag::from_bits_retain(fcntl(&file, FcntlArg::F_GETFL)?);
    fcntl(&file, FcntlArg::F_SETFL(flags - OFlag::O_NONBLOCK))?;
    Ok(file)
}

/// The pipe, opened without waiting for a reader in the system, which no signal but a deadly one would end.
fn with_reader(path: &Path) -> io::Result<Option<File>> {
    let begun = Instant::now();
    loop {
        match OpenOptions::new().write(true).custom_flags(libc::O_NONBLOCK).open(path) {
            Ok(file) => return Ok(Some(file)),
            Err(error) if error.raw_os_error() != Some(libc::ENXIO) => return Err(error),
            Err(_) if begun.elapsed() >= PATIENCE => return Ok(None),
            Err(_) => thread::sleep(BETWEEN_LOOKS),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::path::PathBuf;
    use std::process::{Command, Stdio};

    /// A folder with a pipe.
    fn pipe() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        (folder, path)
    }

    #[test]
    fn a_pipe_is_held_until_it_is_written() {
        let (folder, path) = pipe();
        assert!(is_fifo(&path) && !is_fifo(folder.path()));
        let reader = Command::new("cat").arg(&path).stdout(Stdio::piped()).spawn().unwrap();
        assert!(hold(&path).unwrap() && hold(&path).unwrap());
        let mut file = open(&path).unwrap().unwrap();
        file.write_all(b"all of it").unwrap();
        drop(file);
        assert_eq!(reader.wait_with_output().unwrap().stdout, b"all of it");
        assert!(!hold(&path).unwrap() && open(&path).unwrap().is_none());
    }

    /// Far more than a pipe has room for, to a reader that takes its time.
    #[test]
    fn what_is_written_waits_for_room() {
        let (_folder, path) = pipe();
        let script = "sleep 0.3; wc -c";
        let reader = Command::new("sh").args(["-c", script]).stdin(read_end(&path)).stdout(Stdio::piped()).spawn();
        let mut file = open(&path).unwrap().unwrap();
        file.write_all(&vec![7; 3 << 20]).unwrap();
        drop(file);
        let counted = String::from_utf8(reader.unwrap().wait_with_output().unwrap().stdout).unwrap();
        assert_eq!(counted.trim(), (3 << 20).to_string());
    }

    /// It is there when the pipe is found to have one, and gone when it is to be written.
    #[test]
    fn a_reader_that_leaves_keeps_no_one_waiting() {
        let (_folder, path) = pipe();
        let reader = read_end(&path);
        let file = with_reader(&path).unwrap().unwrap();
        drop(reader);
        // More than it holds: a program that another test starts has the other end for a moment, too.
        let written = waiting_for_room(file).unwrap().write_all(&[7; 1 << 20]);
        assert_eq!(written.unwrap_err().kind(), io::ErrorKind::BrokenPipe);
    }

    /// The end that is read, without waiting for a writer.
    fn read_end(path: &Path) -> File {
        let file = OpenOptions::new().read(true).custom_flags(libc::O_NONBLOCK).open(path).unwrap();
        waiting_for_room(file).unwrap()
    }
}
