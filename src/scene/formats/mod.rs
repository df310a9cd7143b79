//! Mesh files. Every reader takes the bytes of a file and gives a valid mesh or the place of the
//! first fault: it checks the sizes that a header claims against the bytes that are there before it
//! allocates, and checks what the format's library would panic on before it hands the bytes over.

mod gltf;
mod gltf_accessor;
mod obj;
mod ply;
mod stl;

use crate::scene::error::Fault;
use crate::scene::{Error, Mesh};
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// Largest file that is read; 32-bit vertex numbers do not reach much further.
const MAX_FILE_BYTES: u64 = 4 << 30;

type Parse = fn(bytes: Vec<u8>, directory: &Path) -> Result<Mesh, Fault>;

/// File endings and their readers. A reader may look for further files in the mesh file's
/// directory.
const FORMATS: [(&str, Parse); 5] = [
    ("obj", |bytes, _| obj::parse(&bytes)),
    ("ply", |bytes, _| ply::parse(&bytes)),
    ("stl", |bytes, _| stl::parse(bytes)),
    ("gltf", |bytes, directory| gltf::parse(&bytes, directory)),
    ("glb", |bytes, directory| gltf::parse(&bytes, directory)),
];

/// Reads the mesh at `path` with the reader for its ending, in either case; the mesh takes the
/// file's name.
pub(super) fn load(path: &Path) -> Result<Mesh, Error> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let Some((_, parse)) = FORMATS.iter().find(|(known, _)| ending.eq_ignore_ascii_case(known)) else {
        return Err(Error::UnknownEnding {
            path: path.to_owned(),
            ending: ending.into_owned(),
            known: FORMATS.map(|(known, _)| format!(".{known}")).join(", "),
        });
    };
    let bytes = read(path)?;
    let directory = path.parent().unwrap_or(Path::new(""));
    let mesh = parse(bytes, directory).map_err(|fault| Error::Malformed { path: path.to_owned(), fault })?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(Mesh { name: name.into_owned(), ..mesh })
}

/// The scanned mesh that the program carries.
pub(super) fn bunny() -> Result<Mesh, Error> {
    let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/bunny.obj"));
    let mesh = obj::parse(bytes).map_err(|fault| Error::Malformed { path: "bunny.obj".into(), fault })?;
    Ok(Mesh { name: "bunny".to_owned(), ..mesh })
}

/// The bytes of a regular file, which rules out devices and pipes that never end.
fn read(path: &Path) -> Result<Vec<u8>, Error> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(Error::NotAFile { path: path.to_owned() });
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(Error::TooLarge { path: path.to_owned(), size_bytes: metadata.len(), limit_bytes: MAX_FILE_BYTES });
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(metadata.len() as usize).map_err(|error| failed(error.into()))?;
    // A file that grows meanwhile is cut, and its reader says so.
    File::open(path).and_then(|file| file.take(MAX_FILE_BYTES).read_to_end(&mut bytes)).map_err(failed)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests;
