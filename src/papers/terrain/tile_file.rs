//! A file of the tiles of a map's levels, from which they are read one by one, so that neither the map nor its levels are ever
//! held whole.
//!
//! It is named by the contents that it was made of, appears whole or not at all, and is checked: as a whole when it is opened,
//! where one that is damaged is made anew, and tile by tile when they are read, where a damage ends the run. It is read, not
//! mapped into memory: a mapped file ends the program where another process cuts it.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use bytemuck::{Pod, Zeroable, bytes_of, bytes_of_mut, cast_slice, cast_slice_mut};
use tempfile::NamedTempFile;

use super::page_table::{PageTable, TILE};
use super::parameters::Interpolation;
use super::pyramid::Shape;
use super::tile_writer::write_tiles;
use crate::file;
use crate::measure::Error;
use crate::scene::{HeightMap, RowSource, Samples, SourceState, cache};

/// Most bytes of all files of tiles together, but for one that is larger alone.
const MOST_BYTES: u64 = 64 << 30;
const ENDING: &str = "tiles";
/// The layout of a file, and the levels in it: one more wherever either changes.
const MAGIC: [u8; 16] = *b"fumarole tiles 2";
/// Bytes before the checksums: the start, and what the map says of itself.
const HEAD_BYTES: u64 = 4096;

/// The begin of a file. What the map says of itself follows, then a CRC-32 of each tile, then the tiles.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Start {
    magic: [u8; 16],
    tiles: u64,
    /// Of what the map says of itself.
    record_bytes: u64,
    /// CRC-32 of that and of the checksums.
    checksum: u32,
    /// 1 in the byte order of the machine.
    one: u32,
}

impl Start {
    /// True where a file of so many bytes has room for all that this promises, of the smallest tiles.
    fn fits(&self, size_bytes: u64) -> bool {
        let tile_bytes = u64::from(TILE) * u64::from(TILE) * size_of::<u16>() as u64;
        let tiles_bytes = self.tiles.checked_mul(size_of::<u32>() as u64 + tile_bytes);
        let end = tiles_bytes.and_then(|bytes| bytes.checked_add(HEAD_BYTES));
        self.record_bytes <= HEAD_BYTES - size_of::<Start>() as u64 && end.is_some_and(|end| end <= size_bytes)
    }
}

/// The tiles of a map's levels on a disk.
#[derive(Debug)]
pub struct TileFile {
    path: PathBuf,
    file: Mutex<File>,
    map: Arc<HeightMap>,
    checksums: Vec<u32>,
    /// Removes the file in the end where it is of one run alone.
    _temporary: Option<NamedTempFile>,
}

/// Bytes of a tile of a map's kind of samples.
pub fn tile_bytes(map: &HeightMap) -> usize {
    let texel = if matches!(map.samples(), Samples::Float(_)) { size_of::<f32>() } else { size_of::<u16>() };
    TILE as usize * TILE as usize * texel
}

/// The numbers of a map's tiles.
fn numbers(map: &HeightMap, interpolation: Interpolation) -> PageTable {
    PageTable::new(Shape::new(map.width(), map.height()), interpolation, 0, u32::MAX)
}

impl TileFile {
    /// The file in `folder` that `key` names, made of the rows of `source` where it is not there or damaged; without a folder a
    /// temporary one, which needs no key. `name` is the map's, for messages, and `state` that of its files.
    ///
    /// # Errors
    /// Of the source; [`Error::Input`] of a folder without room, and where `state` is another when the file is made:
    /// the map was changed meanwhile.
    pub fn open(
        folder: Option<&Path>,
        name: &Path,
        interpolation: Interpolation,
        key: impl FnOnce() -> Result<String, Error>,
        state: impl Fn() -> Result<SourceState, Error>,
        source: impl FnOnce() -> Result<RowSource, Error>,
    ) -> Result<Self, Error> {
        // Before the key: what it tells of is read after this.
        let state_before = state()?;
        let Some(folder) = folder else {
            let untaken = |error: io::Error| Error::Input(format!("`map` {}: its tiles: {error}", name.display()));
            let failed = |error: io::Error| {
                let reason = "name a folder with room in TMPDIR";
                Error::Input(format!("`map` {}: its tiles need a temporary file: {error}; {reason}", name.display()))
            };
            let mut temporary = file::temporary().map_err(untaken)?;
            let source = source()?;
            let mut wrong = None;
            let mut out = BufWriter::new(temporary.as_file_mut());
            let made = make(&mut out, name, interpolation, source, &mut wrong).and_then(|()| out.flush());
            drop(out);
            wrong.map_or(Ok(()), Err)?;
            made.map_err(failed)?;
            check_same(name, &state_before, &state()?)?;
            let opened = temporary.reopen().ok().and_then(|file| read_head(file, temporary.path(), interpolation));
            let opened = opened.ok_or_else(|| failed(io::ErrorKind::UnexpectedEof.into()))?;
            return Ok(TileFile { _temporary: Some(temporary), ..opened });
        };
        let path = folder.join(format!("{}.{ENDING}", key()?));
        if let Ok(file) = File::open(&path) {
            if let Some(opened) = read_head(file, &path, interpolation) {
                cache::touch(&path);
                return Ok(opened);
            }
            // Damaged: as good as none.
            let _ = fs::remove_file(&path);
        }
        let source = source()?;
        let bytes = file_bytes(source.map(), interpolation);
        cache::evict(folder, ENDING, MOST_BYTES.saturating_sub(bytes));
        let mut wrong = None;
        let made = file::write_unsynced(&path, |out| make(out, name, interpolation, source, &mut wrong));
        wrong.map_or(Ok(()), Err)?;
        made.map_err(|error| {
            let way_out =
                "or another cache by its variable (XDG_CACHE_HOME, LOCALAPPDATA under Windows), or `no-cache`";
            Error::Input(format!("`map` {}: its tiles go to the user's cache: {error}, {way_out}", name.display()))
        })?;
        check_same(name, &state_before, &state()?).inspect_err(|_| {
            let _ = fs::remove_file(&path);
        })?;
        let opened = File::open(&path).ok().and_then(|file| read_head(file, &path, interpolation));
        opened.ok_or_else(|| {
            let reason = "it was changed or removed as soon as it was made; start again";
            Error::Input(format!("`map` {}: its tiles in {}: {reason}", name.display(), path.display()))
        })
    }

    /// The map without its samples.
    pub fn map(&self) -> &Arc<HeightMap> {
        &self.map
    }

    /// The texels of a tile, row by row; those beyond its level are zero.
    ///
    /// # Errors
    /// A line on a tile that cannot be read or is not what was written.
    pub fn read(&self, number: usize) -> Result<Vec<u8>, String> {
        let mut bytes = vec![0; tile_bytes(&self.map)];
        let place = first_tile(self.checksums.len()) + (number * bytes.len()) as u64;
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let read = file.seek(SeekFrom::Start(place)).and_then(|_| file.read_exact(&mut bytes));
        let fault = match read {
            Err(error) => Some(error.to_string()),
            Ok(()) if self.checksums.get(number) != Some(&crc32fast::hash(&bytes)) => {
                Some("its checksum is another".to_owned())
            }
            Ok(()) => None,
        };
        let Some(fault) = fault else { return Ok(bytes) };
        // The next start makes it anew.
        let _ = fs::remove_file(&self.path);
        Err(format!(
            "tile {number} of {}: {fault}; the file was changed or damaged after it was opened; start again, it is made anew",
            self.path.display()
        ))
    }
}

fn check_same(name: &Path, before: &SourceState, after: &SourceState) -> Result<(), Error> {
    if before == after {
        return Ok(());
    }
    Err(Error::Input(format!("`map` {}: it was changed while it was read; start again", name.display())))
}

/// The place of the first tile, of so many.
fn first_tile(tiles: usize) -> u64 {
    HEAD_BYTES + 4 * tiles as u64
}

fn file_bytes(map: &HeightMap, interpolation: Interpolation) -> u64 {
    let tiles = numbers(map, interpolation).count();
    first_tile(tiles) + tiles as u64 * tile_bytes(map) as u64
}

/// Writes all of a file; `wrong` is what is wrong with the source.
fn make(
    out: &mut (impl Write + Seek),
    name: &Path,
    interpolation: Interpolation,
    source: RowSource,
    wrong: &mut Option<Error>,
) -> io::Result<()> {
    let table = numbers(source.map(), interpolation);
    let first = first_tile(table.count());
    let (map, checksums) = match write_tiles(out, first, &table, interpolation, source, name) {
        Ok(written) => written?,
        Err(error) => {
            *wrong = Some(error.into());
            return Err(io::ErrorKind::InvalidData.into());
        }
    };
    let record = map.to_record()?;
    let checksum = crc32fast::hash(&[record.as_bytes(), cast_slice(&checksums)].concat());
    let (tiles, record_bytes) = (checksums.len() as u64, record.len() as u64);
    out.seek(SeekFrom::Start(0))?;
    out.write_all(bytes_of(&Start { magic: MAGIC, tiles, record_bytes, checksum, one: 1 }))?;
    out.write_all(record.as_bytes())?;
    out.seek(SeekFrom::Start(HEAD_BYTES))?;
    out.write_all(cast_slice(&checksums))
}

/// The file, if it is whole: of the tiles themselves the number alone.
pub fn read_head(mut file: File, path: &Path, interpolation: Interpolation) -> Option<TileFile> {
    let size_bytes = file.metadata().ok()?.len();
    let mut start = Start::zeroed();
    file.read_exact(bytes_of_mut(&mut start)).ok()?;
    // Before its checksum is known it may promise anything.
    if start.magic != MAGIC || start.one != 1 || !start.fits(size_bytes) {
        return None;
    }
    let mut record = vec![0; start.record_bytes as usize];
    file.read_exact(&mut record).ok()?;
    let mut checksums = vec![0_u32; start.tiles as usize];
    file.seek(SeekFrom::Start(HEAD_BYTES)).ok()?;
    file.read_exact(cast_slice_mut(&mut checksums)).ok()?;
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&record);
    hasher.update(cast_slice(&checksums));
    if hasher.finalize() != start.checksum {
        return None;
    }
    let map = HeightMap::from_record(std::str::from_utf8(&record).ok()?)?;
    let is_whole =
        numbers(&map, interpolation).count() == checksums.len() && file_bytes(&map, interpolation) == size_bytes;
    is_whole.then(|| TileFile {
        path: path.to_owned(),
        file: Mutex::new(file),
        map: Arc::new(map),
        checksums,
        _temporary: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::terrain::height_field::HeightField;
    use crate::papers::terrain::pyramid::Cover;
    use crate::papers::terrain::tiles::Texels;
    use crate::scene::random::Random;

    const SIZE: (u32, u32) = (300, 517);

    fn maps() -> [HeightMap; 2] {
        let mut random = Random::new(5);
        let values: Vec<u16> = (0..SIZE.0 * SIZE.1).map(|_| (random.unit() * 60_000.0) as u16).collect();
        let heights = values.iter().map(|&value| f32::from(value) - 30_000.5).collect();
        let steps = Samples::Steps { values, origin_m: -5.0, step_m: 0.1 };
        [steps, Samples::Float(heights)].map(|samples| HeightMap::new(SIZE.0, SIZE.1, samples).unwrap())
    }

    fn open(folder: Option<&Path>, map: &HeightMap, interpolation: Interpolation) -> Result<TileFile, Error> {
        let key = || Ok("key".to_owned());
        let state = || Ok(SourceState::default());
        TileFile::open(folder, Path::new("land"), interpolation, key, state, || {
            RowSource::of(map.clone()).map_err(Error::from)
        })
    }

    fn refuse() -> Result<RowSource, Error> {
        Err(Error::Input("made anew".into()))
    }

    fn reopen(folder: &Path) -> Result<TileFile, Error> {
        let key = || Ok("key".to_owned());
        let state = || Ok(SourceState::default());
        TileFile::open(Some(folder), Path::new("land"), Interpolation::Bilinear, key, state, refuse)
    }

    /// Every tile of a file is the one that lies in memory.
    #[test]
    fn tiles_on_disk_are_those_in_memory() {
        let folder = tempfile::tempdir().unwrap();
        for (number, map) in maps().into_iter().enumerate() {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let at = folder.path().join(format!("{number} {interpolation:?}"));
                let field = HeightField::new(&Arc::new(map.clone()), interpolation, Cover::Nodes);
                let table = numbers(&map, interpolation);
                for at in [Some(&*at), None] {
                    let tiles = open(at, &map, interpolation).unwrap();
                    assert_eq!(HeightMap::from_record(&map.to_record().unwrap()).as_ref(), Some(&**tiles.map()));
                    for number in 0..table.count() {
                        let expected = field.with(Texels(table.tile(number)));
                        assert!(tiles.read(number).unwrap() == expected, "{interpolation:?}: tile {number}");
                    }
                    assert!(tiles.read(table.count()).is_err());
                }
            }
        }
    }

    #[test]
    fn a_file_is_made_once_and_a_temporary_one_goes() {
        let folder = tempfile::tempdir().unwrap();
        let [map, _] = maps();
        assert!(reopen(folder.path()).unwrap_err().to_string().contains("made anew"));
        open(Some(folder.path()), &map, Interpolation::Bilinear).unwrap();
        let again = reopen(folder.path()).unwrap();
        assert_eq!(again.read(0).unwrap().len(), tile_bytes(&map));
        let temporary = open(None, &map, Interpolation::Bilinear).unwrap();
        let path = temporary.path.clone();
        assert!(path.exists());
        drop(temporary);
        assert!(!path.exists());
    }

    #[test]
    fn a_cache_that_cannot_be_made_is_named_with_ways_out() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let [map, _] = maps();
        let error = open(Some(&file.path().join("tiles")), &map, Interpolation::Bilinear).unwrap_err().to_string();
        assert!(error.contains("`map` land") && error.contains("XDG_CACHE_HOME"), "{error}");
        assert!(error.contains("`no-cache`"), "{error}");
    }

    /// Checksums take less than an eight-thousandth of a file's size, whatever its begin says.
    #[test]
    fn a_head_promises_no_more_than_its_file_holds() {
        let start = |tiles, record_bytes| Start { magic: MAGIC, tiles, record_bytes, checksum: 0, one: 1 };
        let size_bytes = 64 << 30;
        let most = (size_bytes - HEAD_BYTES) / (4 + 2 * 128 * 128);
        for (tiles, fits) in [
            (0, true),
            (most, true),
            (most + 1, false),
            (size_bytes / 4, false),
            (u64::MAX / 4, false),
            (u64::MAX, false),
        ] {
            assert_eq!(start(tiles, 0).fits(size_bytes), fits, "{tiles}");
        }
        assert!(4 * most < size_bytes / 8_000 && !start(1, HEAD_BYTES).fits(size_bytes));
    }

    /// A damage of the head, of the checksums or of the length is seen when the file is opened, and it is made anew.
    #[test]
    fn a_damaged_file_is_made_anew() {
        let folder = tempfile::tempdir().unwrap();
        let [map, _] = maps();
        open(Some(folder.path()), &map, Interpolation::Bilinear).unwrap();
        let path = folder.path().join("key.tiles");
        let whole = fs::read(&path).unwrap();
        let head = first_tile(numbers(&map, Interpolation::Bilinear).count()) as usize;
        let damage = |place: usize| {
            let mut bytes = whole.clone();
            bytes[place] ^= 4;
            bytes
        };
        let mut damaged: Vec<Vec<u8>> = [0, 17, 25, 33, 37, 60, HEAD_BYTES as usize, head - 1].map(damage).into();
        damaged.extend([0, 20, 200, head, whole.len() - 1].map(|bytes| whole[..bytes].to_vec()));
        damaged.push([&whole[..], b"more"].concat());
        for (number, bytes) in damaged.into_iter().enumerate() {
            fs::write(&path, bytes).unwrap();
            assert!(reopen(folder.path()).is_err(), "damage {number} is not seen");
            assert!(!path.exists(), "damage {number} stays");
        }
        open(Some(folder.path()), &map, Interpolation::Bilinear).unwrap();
        assert!(fs::read(&path).unwrap() == whole);
    }

    /// A tile that is changed or cut off after the file was opened is told of in one line, and the file goes.
    #[test]
    fn a_file_that_changes_under_us_is_told_of() {
        let folder = tempfile::tempdir().unwrap();
        let [map, _] = maps();
        let path = folder.path().join("key.tiles");
        for cut in [false, true] {
            let tiles = open(Some(folder.path()), &map, Interpolation::Bilinear).unwrap();
            let last = tiles.checksums.len() - 1;
            if cut {
                File::options().write(true).open(&path).unwrap().set_len(HEAD_BYTES).unwrap();
            } else {
                let mut file = File::options().write(true).open(&path).unwrap();
                file.seek(SeekFrom::End(-1)).unwrap();
                file.write_all(&[7]).unwrap();
                assert!(tiles.read(0).is_ok());
            }
            let line = tiles.read(last).unwrap_err();
            assert!(line.starts_with(&format!("tile {last} of {}", path.display())) && line.contains("start again"));
            // Some systems keep the name of what is open.
            drop(tiles);
            assert!(!line.contains('\n') && !path.exists(), "{line}");
        }
    }

    /// Of the files' sizes and times alone: their contents, which name the file, are read once.
    #[test]
    fn a_map_that_changes_while_it_is_read_is_refused() {
        for at in [true, false] {
            let folder = tempfile::tempdir().unwrap();
            let land = tempfile::NamedTempFile::new().unwrap();
            let [map, _] = maps();
            let key = || Ok("key".to_owned());
            let state = || Ok(SourceState::of(land.path()).unwrap());
            let folder_of = at.then_some(folder.path());
            let source = || {
                fs::write(land.path(), "more").unwrap();
                RowSource::of(map.clone()).map_err(Error::from)
            };
            let open = || TileFile::open(folder_of, Path::new("land"), Interpolation::Bilinear, key, state, source);
            assert_eq!(open().unwrap_err().to_string(), "`map` land: it was changed while it was read; start again");
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
            let same = || RowSource::of(map.clone()).map_err(Error::from);
            TileFile::open(folder_of, Path::new("land"), Interpolation::Bilinear, key, state, same).unwrap();
        }
    }
}
