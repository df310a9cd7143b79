//! Identity of an input by its content.

use std::collections::HashSet;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::Deserialize;

use super::formats::gltf_buffer::percent_decoded;
use super::formats::gltf_document::buffer_uris;
use super::{formats, height_map, voxels, world_file};
use crate::{content, file};

/// Endings of the files that a raster may be read with, in small or in large letters.
const BESIDE_A_RASTER: [&str; 5] = ["hdr", "prj", "bil", "dem", "bsq"];

/// SHA-256 of a file, or of all of a folder, in lower-case hexadecimal; where others are read with it (buffers of a
/// glTF document, header and projection of a raster, parts of a mosaic, world file of a picture, samples of a volume,
/// texture of a table of materials), that of all their digests in order.
///
/// # Errors
/// A file cannot be read.
pub fn source_sha256(path: &Path) -> io::Result<String> {
    if path.is_dir() {
        return content::folder_sha256(path);
    }
    let own = content::file_sha256(path)?;
    let companions = companions(path);
    if companions.is_empty() {
        return Ok(own);
    }
    let digests = companions.iter().map(|companion| content::file_sha256(companion)).collect::<io::Result<Vec<_>>>()?;
    Ok(content::sha256(format!("{own}{}", digests.concat()).as_bytes()))
}

/// The files that are read of a source: of a folder its SRTM tiles, of a file itself and those that [`source_sha256`]
/// reads with it.
pub fn read_files(path: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(path) else {
        return std::iter::once(path.to_owned()).chain(companions(path)).collect();
    };
    let files = entries.filter_map(|entry| Some(entry.ok()?.path()));
    files.filter(|file| file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("hgt"))).collect()
}

/// The files of a source, their sizes and when they were last written to: another where one of them was changed.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SourceState(Vec<(PathBuf, u64, SystemTime)>);

impl SourceState {
    /// Of what [`source_sha256`] reads of `path`.
    ///
    /// # Errors
    /// A file or folder that is not there.
    pub fn of(path: &Path) -> io::Result<Self> {
        let files = if path.is_dir() {
            let mut files = content::files_below(path)?;
            files.sort();
            files
        } else {
            read_files(path)
        };
        let state = |path: PathBuf| {
            let metadata = std::fs::metadata(&path)?;
            Ok((path, metadata.len(), metadata.modified()?))
        };
        files.into_iter().map(state).collect::<io::Result<_>>().map(SourceState)
    }
}

/// The other file that a table of materials names; the rest of it is passed over.
#[derive(Deserialize)]
struct MaterialTable {
    texture: Option<String>,
}

/// Largest file that may be a table of materials, bytes: no larger one is taken for one.
const MOST_TABLE_BYTES: u64 = 96 << 10;

/// The other files that are read with a file, as far as they are there.
fn companions(path: &Path) -> Vec<PathBuf> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    if ending == "gltf" {
        return gltf_buffers(path);
    }
    if ending == "toml" {
        let text = file::read_text(path, MOST_TABLE_BYTES).unwrap_or_default();
        let texture = toml::from_str::<MaterialTable>(&text).ok().and_then(|table| table.texture);
        let folder = path.parent().unwrap_or(Path::new(""));
        let file = texture.and_then(|name| file::below(folder, Path::new(&name)).ok());
        return file.filter(|file| file.is_file()).into_iter().collect();
    }
    if ending == "vrt" {
        // A part is no mosaic itself, and one that names another is refused: looking into that might have no end.
        let is_mosaic = |part: &Path| part.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("vrt"));
        let of_part = |part: PathBuf| {
            let others = if is_mosaic(&part) { Vec::new() } else { companions(&part) };
            std::iter::once(part).chain(others)
        };
        return height_map::mosaic_parts(path).into_iter().flat_map(of_part).collect();
    }
    let samples = voxels::companions(path);
    if !samples.is_empty() {
        return samples;
    }
    let mut world_files = world_file::endings(path).into_iter().map(|ending| path.with_extension(ending));
    let world_file = world_files.find(|file| file.is_file()).filter(|_| height_map::is_picture(path));
    let beside: &[&str] = match () {
        () if ending == "asc" || world_file.is_some() => &["prj"],
        () if BESIDE_A_RASTER.iter().any(|known| ending == *known) => &BESIDE_A_RASTER,
        () => &[],
    };
    // One file of each ending but its own: some systems find it under either name.
    let others = beside.iter().filter(|other| ending != **other);
    let spelled =
        |ending: &str| [ending.to_owned(), ending.to_ascii_uppercase()].map(|ending| path.with_extension(ending));
    let found = others.filter_map(|other| spelled(other).into_iter().find(|file| file.is_file()));
    world_file.into_iter().chain(found).collect()
}

/// The files of a glTF document's buffers, up to the first that is not there: its reader ends with that one.
fn gltf_buffers(path: &Path) -> Vec<PathBuf> {
    let text = file::read(path, formats::MAX_FILE_BYTES).unwrap_or_default();
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut known = HashSet::new();
    let uris = buffer_uris(&text).into_iter().filter(|uri| !uri.starts_with("data:") && known.insert(uri.clone()));
    let file = |uri: String| file::below(folder, Path::new(&percent_decoded(&uri)?)).ok().filter(|file| file.is_file());
    uris.map_while(file).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_with_a_file_counts() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let gltf = write("a.gltf", r#"{"buffers": [{"uri": "a.bin"}, {"uri": "data:,x"}, {"uri": "a%20b.bin"}]}"#);
        for name in ["a.bin", "a b.bin"] {
            write(name, "one");
            let first = source_sha256(&gltf).unwrap();
            write(name, "two");
            assert_ne!(source_sha256(&gltf).unwrap(), first, "{name}");
        }

        // One of so many objects is refused by its reader, and so is a name of no file.
        let objects = format!(r#"{{"buffers": [{{"uri": "a.bin"}}{}]}}"#, ",{}".repeat(200_000));
        let names = |uris: [&str; 3]| {
            let text = format!(r#"{{"buffers": [{{"uri": "{}"}}]}}"#, uris.join(r#""}, {"uri": ""#));
            read_files(&write("names.gltf", &text)).len()
        };
        assert_eq!(read_files(&write("objects.gltf", &objects)).len(), 1);
        assert_eq!([names(["a.bin", "a.bin", "a%20b.bin"]), names(["a.bin", "gone.bin", "a%20b.bin"])], [3, 2]);

        let raster = write("b.bil", "raster");
        let alone = source_sha256(&raster).unwrap();
        assert_eq!(alone, content::sha256(b"raster"));
        write("b.hdr", "header");
        assert_ne!(source_sha256(&raster).unwrap(), alone);
        let (mesh, picture) = (write("d.obj", "mesh"), write("d.png", "MM\0*"));
        assert_eq!(source_sha256(&picture).unwrap(), content::sha256(b"MM\0*"));
        write("d.pgw", "place");
        let placed = source_sha256(&picture).unwrap();
        assert_ne!(placed, content::sha256(b"MM\0*"));
        write("d.prj", "projection");
        assert_ne!(source_sha256(&picture).unwrap(), placed);
        let raster = write("h.of-heights", "MM\0*");
        assert_eq!(source_sha256(&raster).unwrap(), content::sha256(b"MM\0*"));
        write("h.WLD", "place");
        write("d.WLD", "place");
        assert_ne!(source_sha256(&raster).unwrap(), content::sha256(b"MM\0*"));
        assert_eq!(source_sha256(&mesh).unwrap(), content::sha256(b"mesh"));
        let grid = write("f.asc", "grid");
        let alone = source_sha256(&grid).unwrap();
        assert_eq!(alone, content::sha256(b"grid"));
        write("f.prj", "projection");
        assert_ne!(source_sha256(&grid).unwrap(), alone);
        let table = write("g.toml", "texture = \"g.png\"\n[[material]]\nkind = \"wood\"\n");
        let alone = source_sha256(&table).unwrap();
        write("g.png", "texture");
        assert_ne!(source_sha256(&table).unwrap(), alone);
        let volume = write("e.nhdr", "NRRD0004\ndata file: e.raw\n");
        write("e.raw", "one");
        let first = source_sha256(&volume).unwrap();
        write("e.raw", "two");
        assert_ne!(source_sha256(&volume).unwrap(), first);
        write("c.obj", "mesh");
        assert_eq!(source_sha256(&folder.path().join("c.obj")).unwrap(), content::sha256(b"mesh"));
    }

    /// A part of a mosaic has companions of its own; a mosaic that names itself has an end.
    #[test]
    fn what_is_read_with_the_parts_of_a_mosaic_counts() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        let part = |name: &str| {
            format!(
                "<SimpleSource><SourceFilename relativeToVRT=\"1\">{name}</SourceFilename>\
                 <SrcRect xOff=\"0\" yOff=\"0\" xSize=\"2\" ySize=\"2\"/>\
                 <DstRect xOff=\"0\" yOff=\"0\" xSize=\"2\" ySize=\"2\"/></SimpleSource>"
            )
        };
        let parts = part("a.asc") + &part("b.bil") + &part("all.vrt");
        write(
            "all.vrt",
            &format!(
                "<VRTDataset rasterXSize=\"2\" rasterYSize=\"2\"><VRTRasterBand dataType=\"Int16\" band=\"1\">\
                 {parts}</VRTRasterBand></VRTDataset>"
            ),
        );
        write("a.asc", "grid");
        write("b.bil", "raster");
        let path = folder.path().join("all.vrt");
        let mut before = (source_sha256(&path).unwrap(), SourceState::of(&path).unwrap());
        for name in ["a.prj", "b.hdr"] {
            write(name, "beside");
            let now = (source_sha256(&path).unwrap(), SourceState::of(&path).unwrap());
            assert!(now.0 != before.0 && now.1 != before.1, "{name}");
            before = now;
        }
    }

    #[test]
    fn of_a_folder_the_tiles_are_read() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["N00E000.hgt", "N00E001.HGT", "notes.txt", "a.bil", "a.hdr"] {
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        let names = |path: &Path| {
            let of = |file: PathBuf| file.file_name().unwrap().to_string_lossy().into_owned();
            let mut names: Vec<String> = read_files(path).into_iter().map(of).collect();
            names.sort();
            names
        };
        assert_eq!(names(folder.path()), ["N00E000.hgt", "N00E001.HGT"]);
        assert_eq!(names(&folder.path().join("a.bil")), ["a.bil", "a.hdr"]);
        assert_eq!(names(&folder.path().join("nowhere")), ["nowhere"]);
    }

    #[test]
    fn a_state_is_another_after_any_of_the_files_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let raster = folder.path().join("b.bil");
        for name in ["b.bil", "b.hdr"] {
            std::fs::write(folder.path().join(name), "one").unwrap();
        }
        let [alone, whole] = [&*raster, folder.path()].map(|path| SourceState::of(path).unwrap());
        assert_eq!(
            [&*raster, folder.path()].map(|path| SourceState::of(path).unwrap()),
            [alone.clone(), whole.clone()]
        );
        std::fs::write(folder.path().join("b.hdr"), "three").unwrap();
        assert_ne!(SourceState::of(&raster).unwrap(), alone);
        assert_ne!(SourceState::of(folder.path()).unwrap(), whole);
        assert!(SourceState::of(&folder.path().join("nowhere")).is_err());
    }
}
