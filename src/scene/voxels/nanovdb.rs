//! NanoVDB, the flat form of OpenVDB: grids of floats, without compression, read into one dense grid each.
//!
//! A tree of fixed depth: a root with a list of tiles, upper nodes of 32 x 32 x 32 entries, lower ones of 16 x 16 x 16,
//! leaves of 8 x 8 x 8 samples. What no node says is the background.

use std::io::{BufReader, Read, Seek};
use std::path::Path;

use glam::DVec3;

use super::VoxelGrid;
use super::grid::{check_size, check_steps};
use super::lines::shown;
use super::source::malformed;
use crate::scene::binary::{allocate, spare_bytes};
use crate::scene::error::{Asset, Fault, Place};
use crate::scene::{Error, file};

const SEGMENT_BYTES: u64 = 16;
const META_BYTES: u64 = 176;
const GRID_BYTES: usize = 672;
const ROOT_BYTES: usize = 64;
const TILE_BYTES: usize = 32;
const LEAF_BYTES: usize = 2144;
/// The class of grids whose type is a float.
const FLOAT: u32 = 1;

/// Reads the grid of that number, from 0.
pub(super) fn load(path: &Path, number: u32) -> Result<VoxelGrid, Error> {
    let (file, size_bytes) = file::open(path, Asset::Volume)?;
    let mut input = Input { file: BufReader::new(file), at: 0, size_bytes };
    let bytes = grid_bytes(&mut input, number).map_err(|fault| malformed(path, fault))?;
    dense(&bytes, input.size_bytes).map_err(|fault| malformed(path, fault))
}

fn fault(reason: impl Into<String>) -> Fault {
    Fault::new(Place::Whole, reason)
}

/// The bytes of a grid, found by the segments' lists of them.
fn grid_bytes(input: &mut Input<impl Read + Seek>, number: u32) -> Result<Vec<u8>, Fault> {
    let mut found = 0_u64;
    let mut at = 0_u64;
    while at < input.size_bytes {
        let here = |reason: &str| Fault::new(Place::Byte(at as usize), reason);
        let segment = Bytes(input.read(at, SEGMENT_BYTES)?);
        let magic = segment.slice(0, 8)?;
        if magic != b"NanoVDB0" && magic != b"NanoVDB2" {
            return Err(here("it does not begin as NanoVDB does; it is damaged or something else"));
        }
        let major = segment.int(8)? >> 21;
        if major != 32 {
            return Err(here(&format!("its version is {major}; 32 can be read")));
        }
        if segment.short(14)? != 0 {
            return Err(here("it is compressed; write it without, as `nanovdb_convert` does by itself"));
        }
        let count = segment.short(12)?;
        if count == 0 {
            return Err(here("a segment of it has no grid; it is damaged"));
        }
        let mut grids = Vec::new();
        at += SEGMENT_BYTES;
        for _ in 0..count {
            let meta = Bytes(input.read(at, META_BYTES)?);
            // The name follows.
            at = at.saturating_add(META_BYTES + u64::from(meta.int(136)?));
            grids.push((meta.long(8)?, meta.int(32)?));
        }
        for (length, kind) in grids {
            if found == u64::from(number) {
                if kind != FLOAT {
                    return Err(fault(format!("grid {number} holds no floats; write it as a grid of floats")));
                }
                return input.read(at, length);
            }
            found += 1;
            at = at.saturating_add(length);
        }
    }
    let last = found.saturating_sub(1);
    Err(fault(format!("it has no grid {number}: give `volume-component` 0 to {last}")))
}

/// A file, read at offsets that mostly follow each other.
struct Input<R> {
    size_bytes: u64,
    /// Offset at which `file` stands.
    at: u64,
    file: BufReader<R>,
}

impl<R: Read + Seek> Input<R> {
    /// Bytes of the file, which has to have them.
    fn read(&mut self, at: u64, length: u64) -> Result<Vec<u8>, Fault> {
        if at.checked_add(length).is_none_or(|end| end > self.size_bytes) {
            let reason = format!("{length} bytes should stand here; the file is cut off");
            return Err(Fault::new(Place::Byte(at as usize), reason));
        }
        let mut bytes = allocate::<u8>(length as usize)?;
        let read = self.file.seek_relative(at as i64 - self.at as i64);
        let read = read.and_then(|()| self.file.read_exact(&mut bytes));
        read.map_err(|error| Fault::foreign(Place::Whole, &error))?;
        self.at = at + length;
        Ok(bytes)
    }
}

/// Little-endian numbers at offsets.
struct Bytes<T>(T);

impl<T: AsRef<[u8]>> Bytes<T> {
    fn slice(&self, at: usize, length: usize) -> Result<&[u8], Fault> {
        let bytes = at.checked_add(length).and_then(|end| self.0.as_ref().get(at..end));
        bytes.ok_or_else(|| Fault::new(Place::Part(format!("byte {at} of its grid")), "it ends before; it is damaged"))
    }

    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N], Fault> {
        Ok(self.slice(at, N)?.try_into().unwrap_or([0; N]))
    }

    fn short(&self, at: usize) -> Result<u16, Fault> {
        self.array(at).map(u16::from_le_bytes)
    }

    fn int(&self, at: usize) -> Result<u32, Fault> {
        self.array(at).map(u32::from_le_bytes)
    }

    fn long(&self, at: usize) -> Result<u64, Fault> {
        self.array(at).map(u64::from_le_bytes)
    }

    fn float(&self, at: usize) -> Result<f32, Fault> {
        self.array(at).map(f32::from_le_bytes)
    }

    fn double(&self, at: usize) -> Result<f64, Fault> {
        self.array(at).map(f64::from_le_bytes)
    }

    fn coordinates(&self, at: usize) -> Result<[i64; 3], Fault> {
        Ok([self.int(at)?, self.int(at + 4)?, self.int(at + 8)?].map(|c| i64::from(c as i32)))
    }

    /// An offset by what stands at `at`, from `base` on.
    fn offset(&self, at: usize, base: usize) -> Result<usize, Fault> {
        let target = i64::from_le_bytes(self.array(at)?).checked_add(base as i64);
        target.and_then(|target| usize::try_from(target).ok()).ok_or_else(|| fault("a node lies before its grid"))
    }

    fn is_on(&self, mask: usize, bit: usize) -> Result<bool, Fault> {
        Ok(self.slice(mask + bit / 8, 1)?[0] >> (bit % 8) & 1 != 0)
    }
}

/// The kinds of nodes between root and leaves.
struct Level {
    bytes: usize,
    /// Entries along each axis, as a power of 2.
    log2: usize,
    /// Samples along each axis of an entry.
    entry: i64,
    masks: usize,
    table: usize,
}

const UPPER: Level = Level { bytes: 270_400, log2: 5, entry: 128, masks: 4096, table: 8256 };
const LOWER: Level = Level { bytes: 33_856, log2: 4, entry: 8, masks: 512, table: 1088 };

/// A grid in the making.
struct Dense<'a> {
    bytes: Bytes<&'a [u8]>,
    low: [i64; 3],
    size: [i64; 3],
    samples: Vec<f32>,
    /// Bytes of nodes and samples of tiles that are left to read: in a sound file no two overlap.
    node_bytes: usize,
    tile_samples: i64,
}

/// All samples in the box of those that are active.
fn dense(bytes: &[u8], size_bytes: u64) -> Result<VoxelGrid, Fault> {
    let bytes = Bytes(bytes);
    let name = bytes.slice(40, 256)?;
    let name = String::from_utf8_lossy(name.split(|byte| *byte == 0).next().unwrap_or_default()).into_owned();
    let root = bytes.offset(GRID_BYTES + 24, GRID_BYTES)?;
    let (low, high) = (bytes.coordinates(root)?, bytes.coordinates(root + 12)?);
    let size: [i64; 3] = std::array::from_fn(|axis| high[axis] - low[axis] + 1);
    if size.iter().any(|&side| side < 1) {
        return Err(fault(format!("its grid {} has no active samples", shown(&name))));
    }
    let sides = check_size(size.map(|side| side as u64)).map_err(|reason| fault(format!("its grid {reason}")))?;
    let count: i64 = size.iter().product();
    if count as u64 * 4 > spare_bytes(size_bytes) {
        let [x, y, z] = size;
        let reason = format!(
            "the box of its samples has {x} x {y} x {z}, too many for so small a file; cut it, or write it as a dense one"
        );
        return Err(fault(reason));
    }
    // The matrix stands row by row.
    let steps = [0, 1, 2].map(|axis| [0, 1, 2].map(|row| bytes.double(296 + 88 + 8 * (3 * row + axis))));
    let mut axes = [DVec3::ZERO; 3];
    for (axis, step) in axes.iter_mut().zip(steps) {
        let [x, y, z] = step;
        // Its y is up, and its z comes towards the one who looks at the front.
        *axis = DVec3::new(x?, -z?, y?);
    }
    check_steps(axes)?;
    let background = bytes.float(root + 28)?;
    let mut samples = allocate::<f32>(count as usize)?;
    samples.fill(background);
    let node_bytes = bytes.0.len();
    let mut dense = Dense { bytes, low, size, samples, node_bytes, tile_samples: count };
    for number in 0..dense.bytes.int(root + 24)? as usize {
        let tile = root + ROOT_BYTES + number * TILE_BYTES;
        dense.take(TILE_BYTES)?;
        let key = dense.bytes.long(tile)?;
        let along = |shift: u32| i64::from(((key >> shift) as u32 & 0xf_ffff).wrapping_shl(12) as i32);
        let origin = [along(42), along(21), along(0)];
        if dense.bytes.long(tile + 8)? == 0 {
            let value = dense.bytes.float(tile + 20)?;
            dense.fill(origin, 4096, value)?;
        } else {
            let node = dense.bytes.offset(tile + 8, root)?;
            dense.node(&UPPER, node, origin)?;
        }
    }
    VoxelGrid::new(sides, axes, dense.samples)
}

impl Dense<'_> {
    /// Counts the bytes of a node.
    fn take(&mut self, count: usize) -> Result<(), Fault> {
        self.node_bytes = self
            .node_bytes
            .checked_sub(count)
            .ok_or_else(|| fault("its nodes overlap, or end beyond it; it is damaged"))?;
        Ok(())
    }

    /// The entries of a node whose first sample is `origin`.
    fn node(&mut self, level: &Level, at: usize, origin: [i64; 3]) -> Result<(), Fault> {
        self.take(level.bytes)?;
        self.bytes.slice(at, level.bytes)?;
        let children = at + 32 + level.masks;
        let along = (1 << level.log2) - 1;
        for entry in 0..1_usize << (3 * level.log2) {
            let place = [entry >> (2 * level.log2), entry >> level.log2 & along, entry & along];
            let corner = std::array::from_fn(|axis| origin[axis] + place[axis] as i64 * level.entry);
            let slot = at + level.table + 8 * entry;
            if !self.bytes.is_on(children, entry)? {
                let value = self.bytes.float(slot)?;
                self.fill(corner, level.entry, value)?;
                continue;
            }
            let child = self.bytes.offset(slot, at)?;
            if level.entry == LOWER.entry {
                self.leaf(child, corner)?;
            } else {
                self.node(&LOWER, child, corner)?;
            }
        }
        Ok(())
    }

    fn leaf(&mut self, at: usize, origin: [i64; 3]) -> Result<(), Fault> {
        self.take(LEAF_BYTES)?;
        for place in 0..512_usize {
            let value = self.bytes.float(at + 96 + 4 * place)?;
            let corner = [place >> 6, place >> 3 & 7, place & 7];
            self.fill(std::array::from_fn(|axis| origin[axis] + corner[axis] as i64), 1, value)?;
        }
        Ok(())
    }

    /// Sets all samples of a cube that lie in the box.
    fn fill(&mut self, origin: [i64; 3], side: i64, value: f32) -> Result<(), Fault> {
        let low: [i64; 3] = std::array::from_fn(|axis| (origin[axis] - self.low[axis]).max(0));
        let high: [i64; 3] = std::array::from_fn(|axis| (origin[axis] + side - self.low[axis]).min(self.size[axis]));
        if (0..3).any(|axis| low[axis] >= high[axis]) {
            return Ok(());
        }
        self.tile_samples -= (0..3).map(|axis| high[axis] - low[axis]).product::<i64>();
        if self.tile_samples < 0 {
            return Err(fault("its nodes overlap, or end beyond it; it is damaged"));
        }
        for z in low[2]..high[2] {
            for y in low[1]..high[1] {
                let row = (z * self.size[1] + y) * self.size[0];
                self.samples[(row + low[0]) as usize..(row + high[0]) as usize].fill(value);
            }
        }
        Ok(())
    }
}
