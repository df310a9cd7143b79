use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// Opens a regular file, which rules out devices and pipes that never end, and tells its size in bytes.
///
/// # Errors
/// Those of the system; [`io::ErrorKind::InvalidInput`] for anything but a regular file.
pub fn open(path: &Path) -> io::Result<(File, u64)> {
    // Asked before it is opened: opening a pipe waits for its writer.
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file"));
    }
    Ok((File::open(path)?, metadata.len()))
}

/// The bytes of a regular file of at most `limit_bytes`, also of one that grows meanwhile.
///
/// # Errors
/// As [`open`]; [`io::ErrorKind::FileTooLarge`] for more bytes.
pub fn read(path: &Path, limit_bytes: u64) -> io::Result<Vec<u8>> {
    let (file, size_bytes) = open(path)?;
    let too_large = |size_bytes: u64| {
        let reason = format!("its {size_bytes} bytes exceed the limit of {limit_bytes}");
        Err(io::Error::new(io::ErrorKind::FileTooLarge, reason))
    };
    if size_bytes > limit_bytes {
        return too_large(size_bytes);
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(size_bytes as usize)?;
    file.take(limit_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    let read_bytes = bytes.len() as u64;
    if read_bytes > limit_bytes { too_large(read_bytes) } else { Ok(bytes) }
}

/// As [`read`], for text.
///
/// # Errors
/// As [`read`]; [`io::ErrorKind::InvalidData`] for what is not UTF-8.
pub fn read_text(path: &Path, limit_bytes: u64) -> io::Result<String> {
    String::from_utf8(read(path, limit_bytes)?)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text"))
}

/// The file that `name`, found in a file of `folder`, means: a relative path that stays below the folder, symbolic links
/// followed.
///
/// # Errors
/// [`io::ErrorKind::InvalidInput`] for a name that leaves the folder; what the system answers for one that is missing.
pub fn below(folder: &Path, name: &Path) -> io::Result<PathBuf> {
    let leaves = || io::Error::new(io::ErrorKind::InvalidInput, "it lies outside the folder of the file that names it");
    if !name.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err(leaves());
    }
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let target = fs::canonicalize(folder.join(name))?;
    if target.starts_with(fs::canonicalize(folder)?) { Ok(target) } else { Err(leaves()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_below_their_folder() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("folder");
        fs::create_dir_all(folder.join("deep")).unwrap();
        for name in ["folder/a", "folder/deep/b", "secret"] {
            fs::write(root.path().join(name), "x").unwrap();
        }
        for name in ["a", "./a", "deep/b", "deep/./b"] {
            assert!(below(&folder, Path::new(name)).unwrap().is_file(), "{name}");
        }
        for name in ["../secret", "deep/../a", "deep/../../secret", "/etc/passwd", ".."] {
            let error = below(&folder, Path::new(name)).expect_err(name);
            assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{name}");
        }
        assert_eq!(below(&folder, Path::new("missing")).unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn links_out_of_the_folder_are_seen_through() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("folder");
        fs::create_dir(&folder).unwrap();
        fs::write(root.path().join("secret"), "x").unwrap();
        fs::write(folder.join("a"), "x").unwrap();
        symlink("a", folder.join("inside")).unwrap();
        symlink("../secret", folder.join("outside")).unwrap();
        symlink("..", folder.join("up")).unwrap();
        assert!(below(&folder, Path::new("inside")).is_ok());
        for name in ["outside", "up/secret"] {
            assert_eq!(below(&folder, Path::new(name)).unwrap_err().kind(), io::ErrorKind::InvalidInput, "{name}");
        }
        // The folder itself may be reached by a link.
        symlink(&folder, root.path().join("link")).unwrap();
        assert!(below(&root.path().join("link"), Path::new("a")).is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn what_has_no_end_is_not_opened() {
        for path in ["/dev/zero", "/dev/null", "/"] {
            assert_eq!(read(Path::new(path), 8).unwrap_err().kind(), io::ErrorKind::InvalidInput, "{path}");
        }
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), [0xff; 9]).unwrap();
        assert_eq!(read(file.path(), 8).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        assert_eq!(read(file.path(), 9).unwrap(), [0xff; 9]);
        assert_eq!(read_text(file.path(), 9).unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
