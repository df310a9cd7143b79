//! Temporary files that tell whose they are, so that those of killed processes can be swept.

use std::fs;
use std::io;
use std::path::Path;
use std::process;
use std::time::Duration;

use sha2::{Digest, Sha256};
use tempfile::NamedTempFile;

const PREFIX: &str = ".fumarole-";
const SUFFIX: &str = ".tmp";
/// Age of what another machine's process left, of which nothing else is known.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// Makes a temporary file in `folder`, with the permissions of an ordinary one. It is removed when dropped.
///
/// # Errors
/// Of a folder that takes no file.
pub fn create(folder: &Path) -> io::Result<NamedTempFile> {
    let prefix = format!("{PREFIX}{}-{}-", process::id(), home());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX);
    // Temporary files are private by default; a result is an ordinary file, as the umask says.
    #[cfg(unix)]
    let everyone = <fs::Permissions as std::os::unix::fs::PermissionsExt>::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(everyone);
    // The kind alone: the message names the temporary file, which means nothing to the user.
    builder.tempfile_in(folder).map_err(|error| io::Error::from(error.kind()))
}

/// Removes what processes that are gone left in `folder`, as far as it can.
pub fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        if name.to_str().and_then(owner).is_some_and(|(id, home)| is_abandoned(id, home, &entry)) {
            // Whoever may not remove it leaves it.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Process and home in the name of a temporary file.
fn owner(name: &str) -> Option<(u32, &str)> {
    let (id, rest) = name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?.split_once('-')?;
    let (home, _) = rest.split_once('-')?;
    Some((id.parse().ok()?, home))
}

fn is_abandoned(id: u32, of: &str, entry: &fs::DirEntry) -> bool {
    if of == home() && tells_of_processes() {
        return !Path::new("/proc").join(id.to_string()).exists();
    }
    let age = entry.metadata().and_then(|metadata| metadata.modified()).ok().and_then(|at| at.elapsed().ok());
    age.is_some_and(|age| age > ABANDONED)
}

/// True where living processes can be told from dead ones: by Linux alone (others may show its `/proc` among their files).
fn tells_of_processes() -> bool {
    cfg!(target_os = "linux") && Path::new("/proc/self").exists()
}

/// Short name of the space in which process numbers mean something: this start of this machine, and of its containers this
/// one. Others may share the folder.
fn home() -> String {
    let start = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    let space = fs::read_link("/proc/self/ns/pid").unwrap_or_default();
    let digest = Sha256::digest(format!("{start}{}", space.display()));
    digest.iter().take(4).map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_dead_processes_are_swept() {
        let folder = tempfile::tempdir().unwrap();
        let living = create(folder.path()).unwrap();
        // No process has this number: Linux gives at most 2^22.
        let dead = folder.path().join(format!("{PREFIX}4294967295-{}-abc{SUFFIX}", home()));
        let elsewhere = folder.path().join(format!("{PREFIX}4294967295-00000000-abc{SUFFIX}"));
        let foreign = folder.path().join(".fumarole-notes.tmp");
        for path in [&dead, &elsewhere, &foreign] {
            fs::write(path, "half").unwrap();
        }
        sweep(folder.path());
        assert!(living.path().exists() && elsewhere.exists() && foreign.exists());
        assert_eq!(dead.exists(), !tells_of_processes());
        let file = fs::File::options().write(true).open(&elsewhere).unwrap();
        file.set_modified(std::time::SystemTime::now() - 2 * ABANDONED).unwrap();
        drop(file);
        sweep(folder.path());
        assert!(!elsewhere.exists());
    }
}
