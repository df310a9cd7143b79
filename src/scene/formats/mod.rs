//! Mesh files. Every reader takes the bytes of a file and gives a valid mesh or the place of the
//! first fault: it checks the sizes that a header claims against the bytes that are there before it
//! allocates, and checks what the format's library would panic on before it hands the bytes over.

mod gltf;
mod gltf_accessor;
mod gltf_buffer;
mod obj;
mod ply;
mod stl;

use crate::scene::error::{Asset, Fault};
use crate::scene::{Error, Mesh, file};
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
            asset: Asset::Mesh,
            ending: ending.into_owned(),
            known: FORMATS.map(|(known, _)| format!(".{known}")).join(", "),
        });
    };
    let bytes = read(path)?;
    let directory = path.parent().unwrap_or(Path::new(""));
    let mesh = parse(bytes, directory).map_err(|fault| malformed(path, fault))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(Mesh { name: name.into_owned(), ..mesh })
}

/// The scanned mesh that the program carries.
pub(super) fn bunny() -> Result<Mesh, Error> {
    let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/bunny.obj"));
    let mesh = obj::parse(bytes).map_err(|fault| malformed(Path::new("bunny.obj"), fault))?;
    Ok(Mesh { name: "bunny".to_owned(), ..mesh })
}

fn malformed(path: &Path, fault: Fault) -> Error {
    Error::Malformed { path: path.to_owned(), asset: Asset::Mesh, fault }
}

/// The bytes of a regular file.
fn read(path: &Path) -> Result<Vec<u8>, Error> {
    crate::file::read(path, MAX_FILE_BYTES).map_err(|source| file::failed(path, Asset::Mesh, source))
}

#[cfg(test)]
mod tests;
