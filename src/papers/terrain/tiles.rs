//! The levels of a map in tiles: all in memory or in a file, on the device a pool of those that rays asked for.

use std::sync::Arc;
use std::time::Instant;

use ash::vk;

use super::height_field::{Field, FieldWork, HeightField};
use super::page_table::{PageTable, TILE, Tile};
use super::parameters::Interpolation;
use super::pyramid::{Cover, Shape, Texel};
use super::tile_file::{TileFile, tile_bytes};
use crate::gpu::bindings::Resource;
use crate::gpu::transfer::{read_buffer, update, upload, upload_rectangle};
use crate::gpu::{Buffer, BufferDesc, Device, Error, Image, ImageDesc, ImageView, Location};
use crate::scene::{HeightMap, Samples};

/// Exchanges after which a picture is shown with what its pool has: tiles that a pool has no room for can ask for each other in
/// turn.
const MOST_EXCHANGES: u32 = 64;

/// Numbers of the tiles of one map, or of several.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TileCounts {
    /// All that there are.
    pub tiles: usize,
    /// Those that the pool holds.
    pub held: usize,
    /// Those that the last picture asked for and the pool has no room for.
    pub missing: usize,
    /// Those that were copied to the device so far.
    pub loaded: u64,
    /// Pictures so far after which tiles were copied.
    pub exchanges: u32,
    /// Milliseconds of looking for what is asked for and of copying it.
    pub loading_ms: f64,
    /// The pool is as large as an image of the device, and smaller than its memory.
    pub is_cut: bool,
}

impl TileCounts {
    /// Of both together.
    pub fn and(self, other: Self) -> Self {
        TileCounts {
            tiles: self.tiles + other.tiles,
            held: self.held + other.held,
            missing: self.missing + other.missing,
            loaded: self.loaded + other.loaded,
            exchanges: self.exchanges.max(other.exchanges),
            loading_ms: self.loading_ms + other.loading_ms,
            is_cut: self.is_cut || other.is_cut,
        }
    }

    /// A line on each thing that keeps tiles of map `number` of `count` out of their pool, all pools having so much memory.
    pub(super) fn warnings(
        &self,
        tile_memory_mib: u32,
        (number, count): (usize, usize),
    ) -> impl Iterator<Item = String> + use<> {
        let TileCounts { missing, is_cut, .. } = *self;
        let cut = is_cut.then(|| {
            format!(
                "`tile-memory` {tile_memory_mib}: the tiles of a map lie in one image, and an image of this device holds fewer of \
                 them; take less memory"
            )
        });
        let way_out = if is_cut { "an image of this device holds no more" } else { "raise `tile-memory`" };
        let lacking = (missing > 0).then(|| {
            format!(
                "{missing} tiles of those that the rays asked for lack room and are drawn from the level above them: {way_out}"
            )
        });
        lacking.into_iter().chain(cut).map(move |line| format!("`map` {number} of {count}: {line}"))
    }
}

/// The most tiles along a pool: it lies in one image.
pub fn pool_side(device: &Device) -> u32 {
    device.physical().limits.max_image_dimension2_d / TILE
}

/// All tiles of a map's levels.
enum Source {
    Memory(HeightField),
    File(Arc<TileFile>),
}

/// A map's levels of which the device holds a pool of tiles.
pub struct Tiles {
    /// The pool.
    pub view: Arc<ImageView>,
    pages: Arc<Buffer>,
    /// A number for each page, 1 where a drawing that marks has read it.
    asked: Arc<Buffer>,
    staging: Arc<Buffer>,
    source: Source,
    table: PageTable,
    loaded: u64,
    exchanges: u32,
    loading_ms: f64,
    /// Exchanges since the last picture that lacked nothing.
    in_a_row: u32,
}

impl Tiles {
    /// Makes a pool of at most `bytes` and no larger than the device's images, or one for the coarsest levels and little more; without
    /// a file builds the levels on the processor.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        device: &Arc<Device>,
        label: &str,
        map: &Arc<HeightMap>,
        (interpolation, bytes): (Interpolation, u64),
        file: Option<&Arc<TileFile>>,
    ) -> Result<Self, Error> {
        let format = match map.samples() {
            Samples::Steps { .. } => vk::Format::R16_UINT,
            Samples::Float(_) => vk::Format::R32_UINT,
        };
        let tile_bytes = tile_bytes(map) as u64;
        let shape = Shape::new(map.width(), map.height());
        let table = PageTable::new(shape, interpolation, (bytes / tile_bytes) as usize, pool_side(device));
        let (columns, rows) = table.pool();
        let desc = ImageDesc::new_2d(format!("{label}/tiles"), format, columns * TILE, rows * TILE);
        let view = Image::new(device, desc.usage(vk::ImageUsageFlags::SAMPLED))?.view()?;
        let pages = table.pages();
        let buffer = |name: &str, numbers: &[u32]| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            upload(device, &format!("{label}/{name}"), usage, bytemuck::cast_slice(numbers))
        };
        let desc = BufferDesc::new(format!("{label}/tile"), tile_bytes).location(Location::Upload);
        let mut tiles = Tiles {
            view,
            pages: buffer("pages", &pages)?,
            asked: buffer("asked", &vec![0; pages.len()])?,
            staging: Buffer::new(device, desc)?,
            source: match file {
                Some(file) => Source::File(file.clone()),
                None => Source::Memory(HeightField::new(map, interpolation, Cover::Nodes)),
            },
            table,
            loaded: 0,
            exchanges: 0,
            loading_ms: 0.0,
            in_a_row: 0,
        };
        tiles.bring(&[])?;
        Ok(tiles)
    }

    /// All that `shaders/terrain/tiles.glsl` reads and writes.
    pub fn resources(&self) -> [(&'static str, Resource); 3] {
        [("pool", (&self.view).into()), ("pages", (&self.pages).into()), ("asked", (&self.asked).into())]
    }

    /// Copies to the pool what a drawing that marks has read and the pool lacks. True where nothing was left to copy, so that it
    /// shows all that the pool has room for.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn exchange(&mut self) -> Result<bool, Error> {
        let start = Instant::now();
        let bytes = read_buffer(self.view.image().device(), &self.asked)?;
        let marks = bytemuck::pod_collect_to_vec::<u8, u32>(&bytes);
        let asked = self.table.marked(&marks);
        update(&self.asked, &vec![0; bytes.len()])?;
        let brought = self.bring(&asked)?;
        if brought > 0 {
            self.exchanges += 1;
            self.in_a_row += 1;
        }
        self.loading_ms += start.elapsed().as_secs_f64() * 1e3;
        let is_settled = brought == 0 || self.in_a_row >= MOST_EXCHANGES;
        if is_settled {
            self.in_a_row = 0;
        }
        Ok(is_settled)
    }

    /// Copies those tiles to the pool that it lacks, as far as it has room, and gives their number.
    fn bring(&mut self, asked: &[usize]) -> Result<usize, Error> {
        let loads = self.table.exchange(asked.iter().copied());
        for load in &loads {
            let texels = match &self.source {
                Source::Memory(field) => field.with(Texels(self.table.tile(load.tile))),
                Source::File(file) => file.read(load.tile).map_err(|reason| {
                    let object = self.view.image().name().to_owned();
                    Error::Filling { object, reason }
                })?,
            };
            self.staging.write(0, &texels)?;
            upload_rectangle(&self.staging, &self.view, self.table.origin(load.place), (TILE, TILE))?;
        }
        if !loads.is_empty() {
            update(&self.pages, bytemuck::cast_slice(&self.table.pages()))?;
        }
        self.loaded += loads.len() as u64;
        Ok(loads.len())
    }

    /// The tiles so far.
    pub fn counts(&self) -> TileCounts {
        TileCounts {
            tiles: self.table.count(),
            held: self.table.held(),
            missing: self.table.missing(),
            loaded: self.loaded,
            exchanges: self.exchanges,
            loading_ms: self.loading_ms,
            is_cut: self.table.is_cut(),
        }
    }
}

/// The texels of a tile as bytes, row by row; those beyond the level are zero.
pub struct Texels(pub Tile);

impl FieldWork for Texels {
    type Output = Vec<u8>;

    fn run<T: Texel>(self, field: Field<'_, T>) -> Vec<u8> {
        let Tile { bound, shift, origin } = self.0;
        let (width, height) = field.shape().level(shift);
        let columns = (width - origin.0).min(TILE) as usize;
        let row_bytes = TILE as usize * size_of::<T>();
        let mut bytes = vec![0; TILE as usize * row_bytes];
        let level = field.level(bound, shift);
        for (row, bytes) in (origin.1..height).zip(bytes.chunks_exact_mut(row_bytes)) {
            let first = row as usize * width as usize + origin.0 as usize;
            let texels: &[u8] = bytemuck::cast_slice(&level[first..first + columns]);
            bytes[..texels.len()].copy_from_slice(texels);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The way out for a map that lacks room is its own: an image that holds no more is another's.
    #[test]
    fn each_map_is_told_of_its_own_pool() {
        let said = |missing: usize, is_cut: bool, number: usize| {
            let counts = TileCounts { missing, is_cut, ..TileCounts::default() };
            counts.warnings(64, (number, 2)).collect::<Vec<String>>()
        };
        let [lacking] = &said(5, false, 1)[..] else { panic!("{:?}", said(5, false, 1)) };
        assert!(lacking.starts_with("`map` 1 of 2: 5 tiles") && lacking.ends_with("raise `tile-memory`"), "{lacking}");
        let [cut] = &said(0, true, 2)[..] else { panic!("{:?}", said(0, true, 2)) };
        assert!(cut.starts_with("`map` 2 of 2: `tile-memory` 64") && cut.ends_with("take less memory"), "{cut}");
        let [lacking, _] = &said(3, true, 2)[..] else { panic!("{:?}", said(3, true, 2)) };
        assert!(lacking.ends_with("an image of this device holds no more"), "{lacking}");
        assert!(said(0, false, 1).is_empty());
    }
}
