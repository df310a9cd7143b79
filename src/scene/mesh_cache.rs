//! Meshes as they came out of their files, kept in a folder of the user's: joined, indexed, with normals, in order.
//!
//! An entry is named by the contents of its files and by what was made of them, so that none is ever stale. It appears
//! whole or not at all, and is checked when it is read: one that is damaged is made anew. It is read, not mapped into
//! memory: a mapped file ends the program where another process cuts it, and every paper moves the mesh to its place
//! and so has it in memory of its own.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice, cast_slice_mut};
use glam::{Vec2, Vec3};

use super::cache;
use super::identity::source_sha256;
use super::loading::MeshOptions;
use super::{Mesh, Tags};
use crate::{content, file};

/// Files below this load about as fast as their entries, bytes.
pub(super) const LEAST_BYTES: u64 = 1 << 20;
/// Most bytes of all entries together.
const MOST_BYTES: u64 = 4 << 30;
const ENDING: &str = "mesh";
/// The layout of an entry and the readers that it came from: one more wherever either gives something else.
const MAGIC: [u8; 16] = *b"fumarole mesh 2\n";

/// The name of an entry.
pub(super) struct Key(String);

impl Key {
    /// None where the file cannot be read: its reader will say so.
    pub fn of(path: &Path, options: &MeshOptions) -> Option<Self> {
        let contents = source_sha256(path).ok()?;
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let MeshOptions { crease_deg, is_optimised, .. } = options;
        let made_of = format!("{contents} {ending} {:08x} {is_optimised}", crease_deg.to_bits());
        Some(Key(content::sha256(&[&MAGIC, made_of.as_bytes()].concat())))
    }

    fn path(&self, folder: &Path) -> PathBuf {
        folder.join(format!("{}.{ENDING}", self.0))
    }
}

/// The start of an entry; the lists follow, then nothing.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Start {
    magic: [u8; 16],
    positions: u64,
    texture_coordinates: u64,
    indices: u64,
    /// CRC-32 of the lists.
    checksum: u32,
    /// 1 in the byte order of the machine.
    one: u32,
}

/// The folder of the entries; none for a user without a home.
pub fn folder() -> Option<PathBuf> {
    let variable = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = std::env::home_dir().filter(|path| path.is_absolute());
    let caches = if cfg!(windows) {
        variable("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        home.map(|home| home.join("Library/Caches"))
    } else {
        variable("XDG_CACHE_HOME").or_else(|| home.map(|home| home.join(".cache")))
    };
    caches.map(|folder| folder.join("fumarole/meshes"))
}

/// The entry, if there is one and it is sound; its name is empty.
pub(super) fn find(folder: &Path, key: &Key) -> Option<Mesh> {
    let path = key.path(folder);
    let mut file = File::open(&path).ok()?;
    match read(&mut file) {
        Some(mesh) => {
            cache::touch(&path);
            Some(mesh)
        }
        None => {
            let _ = fs::remove_file(&path);
            None
        }
    }
}

/// Reads an entry; none where it is damaged.
pub fn read(file: &mut File) -> Option<Mesh> {
    let size_bytes = file.metadata().ok()?.len();
    let mut start = Start::zeroed();
    file.read_exact(bytemuck::bytes_of_mut(&mut start)).ok()?;
    let is_known = start.magic == MAGIC && start.one == 1;
    let lists = start.positions.checked_mul(24)?.checked_add(start.texture_coordinates.checked_mul(8)?)?;
    let lists = lists.checked_add(start.indices.checked_mul(4)?)?;
    if !is_known || size_bytes != lists.checked_add(size_of::<Start>() as u64)? {
        return None;
    }
    let mut checksum = crc32fast::Hasher::new();
    let mesh = Mesh {
        name: String::new(),
        positions: list(file, start.positions, &mut checksum)?,
        normals: list(file, start.positions, &mut checksum)?,
        texture_coordinates: list(file, start.texture_coordinates, &mut checksum)?,
        indices: list(file, start.indices, &mut checksum)?,
        tags: Tags::default(),
    };
    (checksum.finalize() == start.checksum && mesh.validate().is_ok()).then_some(mesh)
}

/// A list of so many values, which the file has room for.
fn list<T: Pod>(file: &mut File, count: u64, checksum: &mut crc32fast::Hasher) -> Option<Vec<T>> {
    const BLOCK: usize = 1 << 18;
    // Memory that the system has zeroed is not touched before it is read into.
    let mut values = bytemuck::allocation::try_zeroed_vec::<T>(usize::try_from(count).ok()?).ok()?;
    // Block by block: what was read is in the processor's cache when it is checked.
    for block in values.chunks_mut(BLOCK) {
        let bytes: &mut [u8] = cast_slice_mut(block);
        file.read_exact(bytes).ok()?;
        checksum.update(bytes);
    }
    Some(values)
}

/// Keeps a mesh. Nothing is said where it cannot be kept: it will be read from its file again.
pub(super) fn keep(folder: &Path, key: &Key, mesh: &Mesh) {
    let lists: [&[u8]; 4] = [
        cast_slice::<Vec3, u8>(&mesh.positions),
        cast_slice::<Vec3, u8>(&mesh.normals),
        cast_slice::<Vec2, u8>(&mesh.texture_coordinates),
        cast_slice(&mesh.indices),
    ];
    let size_bytes = lists.iter().map(|list| list.len() as u64).sum::<u64>() + size_of::<Start>() as u64;
    if size_bytes > MOST_BYTES {
        return;
    }
    let mut checksum = crc32fast::Hasher::new();
    lists.iter().for_each(|list| checksum.update(list));
    let start = Start {
        magic: MAGIC,
        positions: mesh.positions.len() as u64,
        texture_coordinates: mesh.texture_coordinates.len() as u64,
        indices: mesh.indices.len() as u64,
        checksum: checksum.finalize(),
        one: 1,
    };
    cache::evict(folder, ENDING, MOST_BYTES - size_bytes);
    let _ = file::write_unsynced(&key.path(folder), |file| {
        file.write_all(bytes_of(&start))?;
        lists.iter().try_for_each(|list| file.write_all(list))
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shapes;
    use std::time::SystemTime;

    fn key(text: &str) -> Key {
        Key(content::sha256(text.as_bytes()))
    }

    fn named(mesh: Mesh, name: &str) -> Mesh {
        Mesh { name: name.to_owned(), ..mesh }
    }

    #[test]
    fn what_is_kept_is_found_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("new/folder");
        for mesh in [shapes::teapot(), shapes::cuboid(), shapes::sphere(3, 3)] {
            let name = mesh.name.clone();
            assert!(find(&folder, &key(&name)).is_none());
            keep(&folder, &key(&name), &mesh);
            assert_eq!(find(&folder, &key(&name)).map(|found| named(found, &name)), Some(mesh));
        }
    }

    #[test]
    fn damage_anywhere_is_seen_and_removed() {
        let folder = tempfile::tempdir().unwrap();
        let (folder, key) = (folder.path(), key("box"));
        keep(folder, &key, &shapes::cuboid());
        let path = key.path(folder);
        let whole = fs::read(&path).unwrap();
        for place in (0..whole.len()).step_by(7) {
            let mut damaged = whole.clone();
            damaged[place] ^= 0x10;
            fs::write(&path, damaged).unwrap();
            assert!(find(folder, &key).is_none() && !path.exists(), "byte {place}");
        }
        for length in [0, 5, whole.len() - 1] {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(find(folder, &key).is_none(), "{length} bytes");
        }
        fs::write(&path, [&whole[..], b"more"].concat()).unwrap();
        assert!(find(folder, &key).is_none());
        // Sums that fit and numbers that do not: the mesh itself is checked.
        let mut wrong = shapes::cuboid();
        wrong.indices[0] = 99;
        keep(folder, &key, &wrong);
        assert!(find(folder, &key).is_none());
    }

    #[test]
    fn the_least_used_make_room() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let mesh = shapes::cuboid();
        for (age, name) in [(3, "a"), (2, "b"), (1, "c")] {
            keep(folder, &key(name), &mesh);
            let at = SystemTime::now() - std::time::Duration::from_secs(100 * age);
            File::options().append(true).open(key(name).path(folder)).unwrap().set_modified(at).unwrap();
        }
        assert!(find(folder, &key("a")).is_some(), "it is the newest now");
        let bytes = fs::metadata(key("a").path(folder)).unwrap().len();
        fs::write(folder.join("notes"), "no entry").unwrap();
        cache::evict(folder, ENDING, 2 * bytes);
        let is_there = |name| key(name).path(folder).exists();
        assert_eq!((is_there("a"), is_there("b"), is_there("c")), (true, false, true));
        assert!(folder.join("notes").exists());
    }

    /// Writers and readers of one entry at once.
    #[test]
    fn nobody_sees_half_an_entry() {
        let folder = tempfile::tempdir().unwrap();
        let (folder, key, mesh) = (folder.path(), &key("sphere"), &shapes::sphere(64, 64));
        keep(folder, key, mesh);
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| (0..50).for_each(|_| keep(folder, key, mesh)));
                scope.spawn(|| (0..50).for_each(|_| assert!(find(folder, key).is_some())));
            }
        });
        assert_eq!(fs::read_dir(folder).unwrap().count(), 1);
    }

    #[test]
    fn keys_tell_contents_and_options_apart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.stl");
        let key = |path: &Path, options| Key::of(path, &options).unwrap().0;
        fs::write(&path, "one").unwrap();
        let plain = MeshOptions::default();
        let first = key(&path, plain);
        assert_eq!(first, key(&path, plain));
        assert_ne!(first, key(&path, MeshOptions { crease_deg: 31.0, ..plain }));
        assert_ne!(first, key(&path, MeshOptions::to_draw(plain.crease_deg)));
        fs::write(&path, "two").unwrap();
        assert_ne!(first, key(&path, plain));
        assert!(Key::of(Path::new("missing.stl"), &plain).is_none());
    }
}
