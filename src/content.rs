//! Identity by content: what a record says of files, pictures and binaries, whatever their names.

use std::fs;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::file;

/// SHA-256 of bytes in lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::digest(bytes).as_ref())
}

/// SHA-256 of bytes that come one after another.
#[derive(Default)]
pub struct Hasher(Sha256);

impl Hasher {
    /// Takes the next bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// As [`sha256`], of all bytes so far.
    pub fn sha256(self) -> String {
        hexadecimal(self.0.finalize().as_ref())
    }
}

/// SHA-256 of a regular file in lower-case hexadecimal.
///
/// # Errors
/// As [`file::open`]; the file cannot be read.
pub fn file_sha256(path: &Path) -> io::Result<String> {
    let mut hasher = Hasher::default();
    let mut input = BufReader::with_capacity(1 << 20, file::open(path)?.0);
    loop {
        let block = input.fill_buf()?;
        if block.is_empty() {
            return Ok(hasher.sha256());
        }
        hasher.add(block);
        let length = block.len();
        input.consume(length);
    }
}

/// SHA-256 of the names and contents of all files below a folder, whatever the folder is called.
///
/// # Errors
/// A file or folder that cannot be read.
pub fn folder_sha256(folder: &Path) -> io::Result<String> {
    let mut files = files_below(folder)?;
    files.sort();
    let digest = |path: &PathBuf| {
        let name = path.strip_prefix(folder).unwrap_or(path).display().to_string();
        Ok(format!("{name}\0{}\n", file_sha256(path)?))
    };
    Ok(sha256(files.iter().map(digest).collect::<io::Result<String>>()?.as_bytes()))
}

/// All files below a folder, in no order.
///
/// # Errors
/// A folder that cannot be read.
pub fn files_below(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            files.extend(files_below(&entry.path())?);
        } else {
            files.push(entry.path());
        }
    }
    Ok(files)
}

fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_bytes_have_the_published_digest() {
        // FIPS 180-2, appendix B.1.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(b"abc"), expected);
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "abc").unwrap();
        assert_eq!(file_sha256(file.path()).unwrap(), expected);
    }

    #[test]
    fn a_folder_is_its_names_and_contents() {
        let [a, b] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        for folder in [&a, &b] {
            fs::create_dir(folder.path().join("below")).unwrap();
            fs::write(folder.path().join("below/one"), "1").unwrap();
            fs::write(folder.path().join("two"), "2").unwrap();
        }
        let digest = folder_sha256(a.path()).unwrap();
        assert_eq!(folder_sha256(b.path()).unwrap(), digest);
        fs::write(b.path().join("below/one"), "3").unwrap();
        assert_ne!(folder_sha256(b.path()).unwrap(), digest);
        fs::rename(a.path().join("two"), a.path().join("three")).unwrap();
        assert_ne!(folder_sha256(a.path()).unwrap(), digest);
        assert!(folder_sha256(&a.path().join("nowhere")).is_err());
    }
}
