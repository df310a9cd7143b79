//! Mesh files. Every reader takes a file from its start to its end, a piece at a time, and gives the parts of a mesh or
//! the place of the first fault: it checks the sizes that a header claims against the bytes that are there before it
//! allocates, and checks what the format's library would panic on before it hands the bytes over.

mod gltf;
mod gltf_accessor;
pub(super) mod gltf_buffer;
pub(super) mod gltf_document;
mod gltf_scene;
mod obj;
mod ply;
mod stl;
mod stream;

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::time::Instant;

pub(super) use self::stream::Stop;
use self::stream::Stream;
use super::error::{Asset, Fault};
use super::loading::{Conditions, LoadParts, MeshOptions, Watch, timed};
use super::mesh::Parts;
use super::mesh_cache::{self, Key};
use super::{Error, Mesh, file, notes};

/// Largest file that is read; 32-bit vertex numbers do not reach much further.
pub(super) const MAX_FILE_BYTES: u64 = 4 << 30;

type Read = fn(&mut Stream<'_>, directory: &Path) -> Result<Parts, Stop>;

/// File endings and their readers. A reader may look for further files in the mesh file's
/// directory.
const FORMATS: [(&str, Read); 5] = [
    ("obj", |stream, _| obj::read(stream)),
    ("ply", |stream, _| ply::read(stream)),
    ("stl", |stream, _| stl::read(stream)),
    ("gltf", gltf::read),
    ("glb", gltf::read),
];

/// Reads the mesh at `path` with the reader for its ending, in either case; the mesh takes the
/// file's name.
pub(super) fn load(path: &Path, options: &MeshOptions, conditions: &Conditions) -> Result<Mesh, Error> {
    let read = reader(path)?;
    let (file, size_bytes) = open(path)?;
    let written = || std::fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    let written_before = written();
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    // What is kept there has no tags.
    let is_kept = size_bytes >= mesh_cache::LEAST_BYTES && !options.keeps_tags;
    let cache = conditions.cache.as_deref().filter(|_| is_kept);
    let entry = timed(|parts| &mut parts.cache_ms, || cache.and_then(|folder| Some((folder, Key::of(path, options)?))));
    if let Some((folder, key)) = &entry {
        conditions.watch.look(0, size_bytes).map_err(|stop| stopped(path, stop))?;
        if let Some(mesh) = timed(|parts| &mut parts.cache_ms, || mesh_cache::find(folder, key)) {
            LoadParts::add(|parts| parts.from_cache += 1);
            conditions.watch.look(size_bytes, size_bytes).map_err(|stop| stopped(path, stop))?;
            return Ok(Mesh { name: name.into_owned(), ..mesh });
        }
    }
    let directory = path.parent().unwrap_or(Path::new(""));
    let mut stream = Stream::new(file, size_bytes, &conditions.watch);
    stream.keeps_tags = options.keeps_tags;
    let (parts, has_notes) = notes::of(Asset::Mesh, path, || parts(read, &mut stream, directory));
    let parts = parts.map_err(|stop| stopped(path, stop))?;
    let mut mesh = parts.into_mesh(options.crease_deg).map_err(|fault| malformed(path, fault))?;
    conditions.watch.look(size_bytes, size_bytes).map_err(|stop| stopped(path, stop))?;
    if options.is_optimised {
        timed(|parts| &mut parts.optimise_ms, || mesh.optimise_order());
    }
    // A file that was written to meanwhile is not the one that the key tells of, and one with notes is to tell them each time.
    if let Some((folder, key)) = entry.filter(|_| written() == written_before && !has_notes) {
        timed(|parts| &mut parts.cache_ms, || mesh_cache::keep(folder, &key, &mesh));
    }
    Ok(Mesh { name: name.into_owned(), ..mesh })
}

/// Triangles that the file says it has, where it says so before they come: binary STL, PLY, and glTF; those of a PLY file may be
/// polygons, and more triangles then.
///
/// # Errors
/// As [`load`], of what stands before the triangles.
pub(super) fn promised_triangles(path: &Path) -> Result<Option<u64>, Error> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    reader(path)?;
    let (file, size_bytes) = open(path)?;
    let watch = Watch::default();
    let mut stream = Stream::new(file, size_bytes, &watch);
    let promised = match ending.to_str() {
        Some("stl") => {
            let mut start = Vec::new();
            stream.append(&mut start, 84).map(|_| stl::triangles(&start, size_bytes))
        }
        Some("ply") => ply::Header::read(&mut stream).map(|header| Some(header.faces())),
        Some("gltf" | "glb") => gltf::promised_triangles(&mut stream),
        _ => Ok(None),
    };
    promised.map_err(|stop| stopped(path, stop))
}

fn reader(path: &Path) -> Result<Read, Error> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let found = FORMATS.iter().find(|(known, _)| ending.eq_ignore_ascii_case(known));
    found.map(|(_, read)| *read).ok_or_else(|| {
        let known = FORMATS.map(|(known, _)| format!(".{known}")).join(", ");
        file::of_unknown_ending(path, Asset::Mesh, &ending, known)
    })
}

/// Opens a file that is not too large, and tells its size in bytes.
fn open(path: &Path) -> Result<(File, u64), Error> {
    let (file, size_bytes) = file::open(path, Asset::Mesh)?;
    if size_bytes <= MAX_FILE_BYTES {
        return Ok((file, size_bytes));
    }
    let reason = format!("its {size_bytes} bytes exceed the limit of {MAX_FILE_BYTES}");
    Err(file::failed(path, Asset::Mesh, io::Error::new(ErrorKind::FileTooLarge, reason)))
}

/// Result of the reader on a stream; the time that it does not count itself is that of reading.
fn parts(read: Read, stream: &mut Stream<'_>, directory: &Path) -> Result<Parts, Stop> {
    let (started, before) = (Instant::now(), LoadParts::current().weld_ms);
    let parts = read(stream, directory);
    LoadParts::add(|parts| {
        parts.bytes += stream.done_bytes();
        parts.read_ms += started.elapsed().as_secs_f64() * 1e3 - (parts.weld_ms - before);
    });
    parts
}

/// The scanned mesh that the program carries. It is as smooth as what was scanned.
pub(super) fn bunny() -> Result<Mesh, Error> {
    let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/bunny.obj"));
    let (path, watch) = (Path::new("bunny.obj"), Watch::default());
    let parts = obj::read(&mut Stream::new(&bytes[..], bytes.len() as u64, &watch));
    let mesh = parts.map_err(|stop| stopped(path, stop))?.into_mesh(180.0).map_err(|fault| malformed(path, fault))?;
    Ok(Mesh { name: "bunny".to_owned(), ..mesh })
}

fn malformed(path: &Path, fault: Fault) -> Error {
    Error::Malformed { path: path.to_owned(), asset: Asset::Mesh, fault }
}

fn stopped(path: &Path, stop: Stop) -> Error {
    match stop {
        Stop::Fault(fault) => malformed(path, fault),
        Stop::Read(source) => file::failed(path, Asset::Mesh, source),
        Stop::Interrupted => Error::Interrupted { path: path.to_owned() },
    }
}

#[cfg(test)]
mod tests;
