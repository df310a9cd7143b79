//! Atomic output: a file is written under a temporary name beside its destination and renamed when it is whole.
//!
//! A failed run leaves no half file and never destroys an older one. Missing parent directories are created. A
//! symbolic link is followed. What is no regular file (`/dev/null`, a pipe) cannot be replaced by renaming and is
//! written to directly.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};

use tempfile::NamedTempFile;

#[cfg(unix)]
use super::fifo;
use super::sink::Sink;
use super::temporary;

/// Failures of writing; every message names the file.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    #[error("cannot create the directory {}: {source}; name a place where directories can be made", .path.display())]
    CreateDirectory {
        /// Directory that was to be made.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    #[error("cannot write {}: it is a directory; name a file in it", .path.display())]
    IsDirectory {
        /// Destination, which is a directory.
        path: PathBuf,
    },
    #[error("cannot write {}: it is a pipe that no one reads, or no longer; start its reader first, or name a file", .path.display())]
    Unread {
        /// Destination, a pipe.
        path: PathBuf,
    },
    #[error("cannot write {}: the file is read-only; make it writable or name another", .path.display())]
    ReadOnly {
        /// Destination, which may not be written.
        path: PathBuf,
    },
    // The reason first: the path may be longer than a message.
    #[error("cannot write a file whose path or name is longer than the system takes; shorten {}", .path.display())]
    TooLong {
        /// Destination that cannot be.
        path: PathBuf,
    },
    #[error(
        "cannot write {}: {source}; name a file in a writable directory with free space", .path.display()
    )]
    Write {
        /// Destination, of which an older file is untouched.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

impl OutputError {
    /// The system's refusal to write `path`.
    fn of(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            ErrorKind::InvalidFilename => OutputError::TooLong { path },
            _ => OutputError::Write { path, source },
        }
    }
}

/// Writes `bytes` to `path`, whole or not at all.
///
/// # Errors
/// The directory cannot be made, the destination is a directory or read-only, or writing failed; an older file at
/// `path` is then untouched.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    write_with(path, |file| file.write_all(bytes))
}

/// As [`write_with()`], for a file that can be made again: the system writes it out when it likes, so that what is there
/// after the machine has crashed may be damaged. What killed processes left in its folder is removed.
///
/// # Errors
/// As [`write_with()`].
pub fn write_unsynced(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<Sink<&mut File>>) -> io::Result<()>,
) -> Result<(), OutputError> {
    let folder = parent(path);
    create_directory(&folder)?;
    temporary::sweep(&folder);
    replace(path, fill, false).map_err(|source| OutputError::of(path, source))
}

/// Fills a temporary file beside `path`, and puts it in its place.
fn replace(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<Sink<&mut File>>) -> io::Result<()>,
    is_synced: bool,
) -> io::Result<()> {
    let mut temporary = create_beside(path)?;
    buffered(Sink::file(temporary.as_file_mut()), fill)?;
    if is_synced {
        temporary.as_file().sync_all()?;
    }
    temporary.persist(path)?;
    Ok(())
}

/// Writes `path` through `fill`, whole or not at all: for encoders that want a writer.
///
/// # Errors
/// As [`write()`]; an error of `fill` counts as a failure to write.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<Sink<&mut File>>) -> io::Result<()>,
) -> Result<(), OutputError> {
    let failed = |source| OutputError::of(path, source);
    match Destination::find(path)? {
        Destination::Stream => {
            let unread = || OutputError::Unread { path: path.to_owned() };
            let mut stream = open_stream(path).map_err(failed)?.ok_or_else(unread)?;
            // Its reader may also leave meanwhile, or read no more.
            buffered(Sink::stream(&mut stream), fill).map_err(|source| match source.kind() {
                ErrorKind::BrokenPipe | ErrorKind::TimedOut => unread(),
                _ => failed(source),
            })
        }
        Destination::File(target) => {
            create_directory(&parent(&target))?;
            replace(&target, fill, true).map_err(failed)
        }
    }
}

/// Finds out, before a long run, whether [`write()`] to `path` can succeed: makes a temporary file in the directory, or in the one
/// that it would be made in, and removes it again; what killed processes left there is removed too. An older file at `path` is not
/// touched. A pipe must have a reader.
///
/// # Errors
/// As [`write()`].
pub fn check_writable(path: &Path) -> Result<(), OutputError> {
    let failed = |source| OutputError::of(path, source);
    match Destination::find(path)? {
        Destination::Stream => match has_reader(path).map_err(failed)? {
            true => Ok(()),
            false => Err(OutputError::Unread { path: path.to_owned() }),
        },
        Destination::File(target) => {
            let directory = parent(&target);
            let uncreated = |source| OutputError::CreateDirectory { path: directory.clone(), source };
            let there = nearest(&directory).map_err(uncreated)?;
            if is_name_too_long(&there, &target) {
                return Err(OutputError::TooLong { path: path.to_owned() });
            }
            temporary::sweep(&there);
            let made = temporary::create(&there).and_then(NamedTempFile::close);
            made.map_err(|source| if there == directory { failed(source) } else { uncreated(source) })
        }
    }
}

/// The directory, or else the nearest one above it that is there: what is between would be made.
fn nearest(directory: &Path) -> io::Result<PathBuf> {
    for above in directory.ancestors().filter(|above| !above.as_os_str().is_empty()) {
        match fs::symlink_metadata(above) {
            Ok(_) if above.is_dir() => return Ok(above.to_owned()),
            Ok(_) => return Err(ErrorKind::NotADirectory.into()),
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(PathBuf::from("."))
}

/// True where a name of the path is longer than the directory that is there takes, as those do that would be made in it.
fn is_name_too_long(there: &Path, path: &Path) -> bool {
    let is_too_long =
        |name| fs::symlink_metadata(there.join(name)).is_err_and(|error| error.kind() == ErrorKind::InvalidFilename);
    path.strip_prefix(there).unwrap_or(path).iter().any(is_too_long)
}

/// True for a pipe, which takes what is written to it once and is never replaced.
pub fn is_pipe(path: &Path) -> bool {
    #[cfg(unix)]
    if fifo::is_fifo(path) {
        return true;
    }
    // No other system keeps pipes among files.
    let _ = path;
    false
}

/// The regular file that `path` names or would name, every link followed; `None` for a device or a pipe, and where there can be
/// none.
pub fn destination(path: &Path) -> Option<PathBuf> {
    let target = match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => return None,
        Ok(_) => path.to_owned(),
        Err(_) => followed(path).ok()?,
    };
    // A file that is not there yet has its folder's place.
    let in_folder = || Some(placed(&parent(&target))?.join(target.file_name()?));
    fs::canonicalize(&target).ok().or_else(in_folder)
}

/// The place of a directory, of which the end need not be there yet.
fn placed(directory: &Path) -> Option<PathBuf> {
    let there = nearest(directory).ok()?;
    let mut place = fs::canonicalize(&there).ok()?;
    for component in directory.strip_prefix(&there).unwrap_or(directory).components() {
        match component {
            Component::ParentDir => {
                place.pop();
            }
            Component::Normal(name) => place.push(name),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    Some(place)
}

fn buffered(
    sink: Sink<&mut File>,
    fill: impl FnOnce(&mut BufWriter<Sink<&mut File>>) -> io::Result<()>,
) -> io::Result<()> {
    let mut writer = BufWriter::new(sink);
    fill(&mut writer)?;
    writer.flush()
}

enum Destination {
    /// A regular file or a name not yet taken, symbolic links resolved, in a directory that may not exist yet.
    File(PathBuf),
    /// A device or a pipe.
    Stream,
}

impl Destination {
    fn find(path: &Path) -> Result<Self, OutputError> {
        let failed = |source| OutputError::of(path, source);
        let metadata = match fs::metadata(path) {
            Ok(metadata) => metadata,
            Err(error) if error.kind() == ErrorKind::InvalidFilename => return Err(failed(error)),
            Err(_) => {
                // `Path` forgets a trailing separator, which asks for a directory.
                if path.as_os_str().as_encoded_bytes().ends_with(b"/") || path.file_name().is_none() {
                    return Err(OutputError::IsDirectory { path: path.to_owned() });
                }
                // A link to what is not there yet makes it there, as a link to an older file replaces that.
                return Ok(Self::File(followed(path).map_err(failed)?));
            }
        };
        if metadata.is_dir() {
            return Err(OutputError::IsDirectory { path: path.to_owned() });
        }
        if !metadata.is_file() {
            return Ok(Self::Stream);
        }
        if metadata.permissions().readonly() {
            return Err(OutputError::ReadOnly { path: path.to_owned() });
        }
        Ok(Self::File(fs::canonicalize(path).map_err(failed)?))
    }
}

/// A device or a pipe, to be written; `None` for a pipe without a reader, which the system would wait for.
fn open_stream(path: &Path) -> io::Result<Option<File>> {
    #[cfg(unix)]
    if fifo::is_fifo(path) {
        return fifo::open(path);
    }
    File::options().write(true).open(path).map(Some)
}

/// False for a pipe that no one reads; one that is read stays open until it is written.
fn has_reader(path: &Path) -> io::Result<bool> {
    #[cfg(unix)]
    if fifo::is_fifo(path) {
        return fifo::hold(path);
    }
    File::options().write(true).open(path).map(|_| true)
}

/// The end of a chain of symbolic links, of which nothing need exist.
fn followed(path: &Path) -> io::Result<PathBuf> {
    /// As many as Linux follows.
    const MOST_LINKS: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        if !fs::symlink_metadata(&path).is_ok_and(|metadata| metadata.is_symlink()) {
            return Ok(path);
        }
        path = parent(&path).join(fs::read_link(&path)?);
    }
    Err(io::Error::other("its symbolic links lead round in a circle"))
}

fn parent(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn create_directory(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|source| OutputError::CreateDirectory { path: path.to_owned(), source })
}

fn create_beside(target: &Path) -> io::Result<NamedTempFile> {
    temporary::create(&parent(target))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(directory: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn writes_and_replaces_in_new_directories() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a/b/result.json");
        write(&path, b"one").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(entries(path.parent().unwrap()), ["result.json"]);
    }

    #[test]
    fn a_failure_keeps_the_older_file_and_leaves_nothing() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("result.json");
        write(&path, b"older").unwrap();
        let error = write_with(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("disk full"))
        })
        .unwrap_err();
        assert!(error.to_string().contains("result.json"), "{error}");
        assert!(error.to_string().contains("disk full"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"older");
        assert_eq!(entries(root.path()), ["result.json"]);
    }

    #[test]
    fn checking_makes_nothing() {
        let root = tempfile::tempdir().unwrap();
        for path in ["out/result.json", "out/deep/er/result.json", "result.json"] {
            check_writable(&root.path().join(path)).unwrap();
            assert!(entries(root.path()).is_empty(), "{path}");
        }
        write(&root.path().join("out/deep/er/result.json"), b"x").unwrap();
        assert_eq!(entries(root.path()), ["out"]);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("gone", root.path().join("dangling")).unwrap();
            let error = check_writable(&root.path().join("dangling/result.json")).unwrap_err();
            assert!(matches!(error, OutputError::CreateDirectory { .. }), "{error}");
        }
    }

    #[test]
    fn impossible_destinations_are_named() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("file");
        write(&file, b"x").unwrap();
        for check in [check_writable, |path: &Path| write(path, b"y")] {
            let error = check(&file.join("under.json")).unwrap_err();
            assert!(matches!(error, OutputError::CreateDirectory { .. }), "{error}");
            let error = check(root.path()).unwrap_err();
            assert!(matches!(error, OutputError::IsDirectory { .. }), "{error}");
            let error = check(&root.path().join("new/")).unwrap_err();
            assert!(matches!(error, OutputError::IsDirectory { .. }), "{error}");
        }
        let mut permissions = fs::metadata(&file).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&file, permissions).unwrap();
        let error = check_writable(&file).unwrap_err();
        assert!(matches!(error, OutputError::ReadOnly { .. }), "{error}");
    }

    /// A file is written under another name first, which every folder takes.
    #[cfg(unix)]
    #[test]
    fn names_that_are_too_long_are_refused_before_the_work() {
        let root = tempfile::tempdir().unwrap();
        let long = "n".repeat(300);
        let deep = ["d"; 3_000].join("/");
        // The file itself, one in folders that are not there yet, such a folder, and all together.
        for path in [format!("{long}.json"), format!("new/er/{long}"), format!("new/{long}/a"), deep] {
            let path = root.path().join(path);
            let error = check_writable(&path).unwrap_err();
            assert!(matches!(error, OutputError::TooLong { .. }), "{error}");
            assert_eq!(entries(root.path()), [""; 0], "{}", path.display());
        }
        check_writable(&root.path().join("n".repeat(250))).unwrap();
        let (path, link) = (root.path().join(&long), root.path().join("link"));
        std::os::unix::fs::symlink(&long, &link).unwrap();
        for error in [write(&path, b"x").unwrap_err(), check_writable(&link).unwrap_err()] {
            assert!(matches!(error, OutputError::TooLong { .. }), "{error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn files_are_ordinary_and_links_are_followed() {
        use std::os::unix::fs::PermissionsExt;
        let root = tempfile::tempdir().unwrap();
        let (plain, path) = (root.path().join("plain"), root.path().join("result"));
        File::create(&plain).unwrap();
        write(&path, b"x").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&plain));

        let link = root.path().join("link");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write(&link, b"through").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"through");

        let dangling = root.path().join("dangling");
        std::os::unix::fs::symlink("new/file", &dangling).unwrap();
        check_writable(&dangling).unwrap();
        write(&dangling, b"made").unwrap();
        assert!(fs::symlink_metadata(&dangling).unwrap().is_symlink());
        assert_eq!(fs::read(root.path().join("new/file")).unwrap(), b"made");
        let circle = root.path().join("circle");
        std::os::unix::fs::symlink("circle", &circle).unwrap();
        assert!(write(&circle, b"x").unwrap_err().to_string().contains("circle"));
    }

    #[test]
    fn ways_to_one_file_have_one_destination() {
        let root = tempfile::tempdir().unwrap();
        let (file, folder) = (root.path().join("a"), root.path().join("folder"));
        fs::create_dir(&folder).unwrap();
        for is_there in [false, true] {
            let found = destination(&file).unwrap();
            assert_eq!(destination(&folder.join("../a")).as_ref(), Some(&found), "{is_there}");
            assert_ne!(destination(&folder.join("a")).as_ref(), Some(&found), "{is_there}");
            fs::write(&file, "x").unwrap();
        }
        // Nor need their folders be there.
        let new = destination(&root.path().join("new/er/a")).unwrap();
        assert_eq!(destination(&root.path().join("new/./er/../er/a")).as_ref(), Some(&new));
        assert_eq!(destination(&folder.join("../new/er/a")).as_ref(), Some(&new));
        assert_ne!(destination(&root.path().join("new/a")).as_ref(), Some(&new));
        assert_eq!(destination(&folder), None);
        #[cfg(unix)]
        assert_eq!(destination(Path::new("/dev/null")), None);
    }

    #[test]
    fn no_message_names_a_temporary_file() {
        // Not even root makes files there.
        let error = check_writable(Path::new("/proc/result.json")).unwrap_err().to_string();
        assert!(error.contains("/proc/result.json") && !error.contains(".tmp"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_whose_reader_leaves_is_one_that_no_one_reads() {
        use std::os::unix::fs::OpenOptionsExt;
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        assert!(is_pipe(&path) && !is_pipe(root.path()) && !is_pipe(Path::new("/dev/null")));
        let reader = File::options().read(true).custom_flags(nix::libc::O_NONBLOCK).open(&path).unwrap();
        let written = write_with(&path, |stream| {
            drop(reader);
            // More than it holds: a program that another test starts has the other end for a moment, too.
            stream.write_all(&[7; 1 << 20])
        });
        let error = written.unwrap_err();
        assert!(matches!(error, OutputError::Unread { .. }), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_regular_file_is_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&path).unwrap();
        let error = write(&path, b"x").unwrap_err();
        assert!(matches!(error, OutputError::Write { .. }), "{error}");
        assert!(fs::metadata(&path).unwrap().file_type().is_socket());
    }
}
