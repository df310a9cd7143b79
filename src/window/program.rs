//! The program that workers and benchmarks run in.

use std::io;
use std::path::PathBuf;

/// The umbrella program, which knows every paper: this one, or from a paper's own binary the one beside it.
///
/// # Errors
/// This program has no place, or nothing lies beside it.
pub fn umbrella() -> io::Result<PathBuf> {
    let own = std::env::current_exe()?;
    let name = format!("fumarole{}", std::env::consts::EXE_SUFFIX);
    let umbrella = own.with_file_name(name);
    if umbrella.is_file() {
        return Ok(umbrella);
    }
    let problem = format!("{} is not there; build it with cargo build --release", umbrella.display());
    Err(io::Error::new(io::ErrorKind::NotFound, problem))
}
