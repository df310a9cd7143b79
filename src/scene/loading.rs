//! Options of loading a mesh, who waits for it, and the times of its steps.

use std::cell::Cell;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::formats::Stop;

/// Options of loading a mesh file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshOptions {
    /// Degrees between two triangles along an edge up to which they share a normal there, where the file has none.
    pub crease_deg: f32,
    /// Triangles and vertices are put into the order that the device's vertex cache likes best.
    pub is_optimised: bool,
    /// The parts that the file names and the colours of its vertices are kept ([`Mesh::tags`](super::Mesh::tags)).
    pub keeps_tags: bool,
}

/// Crease angle of meshes that none is given for, degrees.
pub const CREASE_DEG: f32 = 30.0;

impl Default for MeshOptions {
    /// Vertices and triangles in the file's order.
    fn default() -> Self {
        MeshOptions { crease_deg: CREASE_DEG, is_optimised: false, keeps_tags: false }
    }
}

impl MeshOptions {
    /// For drawing: what is drawn does not depend on the order.
    pub fn to_draw(crease_deg: f32) -> Self {
        MeshOptions { crease_deg, is_optimised: true, keeps_tags: false }
    }
}

/// Who waits for a file.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Set when nobody does any more.
    pub interrupted: &'a AtomicBool,
    /// Told the bytes that are done and those of the whole file.
    pub progress: &'a (dyn Fn(u64, u64) + Sync),
}

impl Default for Watch<'_> {
    /// Somebody who waits to the end, in silence.
    fn default() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Watch { interrupted: &NEVER, progress: &|_, _| {} }
    }
}

impl Watch<'_> {
    /// Tells how far it is.
    ///
    /// # Errors
    /// [`Stop::Interrupted`].
    pub(super) fn look(&self, done_bytes: u64, size_bytes: u64) -> Result<(), Stop> {
        (self.progress)(done_bytes, size_bytes);
        if self.interrupted.load(Ordering::Relaxed) { Err(Stop::Interrupted) } else { Ok(()) }
    }
}

/// Conditions of all loads of this process.
#[derive(Clone)]
pub struct Conditions {
    /// Who waits.
    pub watch: Watch<'static>,
    /// Folder of the meshes that were loaded before; none to read every file anew.
    pub cache: Option<PathBuf>,
}

impl Conditions {
    /// Without a cache, for somebody who waits to the end in silence.
    pub const fn plain() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Conditions { watch: Watch { interrupted: &NEVER, progress: &|_, _| {} }, cache: None }
    }

    /// Folder of the tiles of maps that were read before, beside that of the meshes; none to make them for one run alone.
    pub fn tiles_folder() -> Option<PathBuf> {
        Some(Self::current().cache.as_ref()?.with_file_name("tiles"))
    }

    /// Those that [`Conditions::hold`] set, else the plain ones.
    pub(super) fn current() -> &'static Self {
        static PLAIN: Conditions = Conditions::plain();
        CURRENT.get().unwrap_or(&PLAIN)
    }

    /// Makes these hold from now on; the first of a process stay.
    pub fn hold(self) {
        CURRENT.get_or_init(|| self);
    }
}

static CURRENT: OnceLock<Conditions> = OnceLock::new();

/// Milliseconds of what loading meshes consisted of, and the bytes of their files.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoadParts {
    /// Of the files that were read, bytes.
    pub bytes: u64,
    /// Reading and parsing.
    pub read_ms: f64,
    /// Joining vertices and cutting polygons.
    pub weld_ms: f64,
    /// Computing normals.
    pub normals_ms: f64,
    /// Ordering triangles and vertices.
    pub optimise_ms: f64,
    /// Looking into the cache, and keeping there what was not in it.
    pub cache_ms: f64,
    /// Meshes that were in the cache.
    pub from_cache: u32,
}

thread_local! {
    static PARTS: Cell<LoadParts> = const { Cell::new(LoadParts {
        bytes: 0, read_ms: 0.0, weld_ms: 0.0, normals_ms: 0.0, optimise_ms: 0.0, cache_ms: 0.0, from_cache: 0,
    }) };
}

impl LoadParts {
    /// Those of this thread so far.
    pub(super) fn current() -> Self {
        PARTS.get()
    }

    /// Those of this thread since the last call.
    pub fn take() -> Self {
        PARTS.take()
    }

    /// Counts the time since `started` as that of joining vertices.
    pub(super) fn welded_since(started: Instant) {
        Self::add(|parts| parts.weld_ms += started.elapsed().as_secs_f64() * 1e3);
    }

    /// Changes those of this thread.
    pub(super) fn add(change: impl FnOnce(&mut Self)) {
        let mut parts = PARTS.get();
        change(&mut parts);
        PARTS.set(parts);
    }
}

/// Runs a part of a load and adds its time to the field.
pub(super) fn timed<T>(field: fn(&mut LoadParts) -> &mut f64, work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let result = work();
    LoadParts::add(|parts| *field(parts) += started.elapsed().as_secs_f64() * 1e3);
    result
}
