//! The maps of a configuration in their places, and what the device's passes share of them.

use std::borrow::Cow;
use std::sync::Arc;

use ash::vk;

use super::blocks::{LightBlock, TerrainBlock};
use super::drape::{Drape, Draping};
use super::geometric_transformation::SceneView;
use super::ground::{Ground, Origin};
use super::hit::NO_DEPTH;
use super::levels::Levels;
use super::parameters::{Interpolation, Parameters, Variant};
use super::placement::{Extent, Placement, Rays};
use super::pyramid::Bound;
use super::stage::{Build, Traversal};
use super::tile_file::TileFile;
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Buffer, BufferDesc, Device, Error, Image, ImageDesc, ImageView, Location};
use crate::measure::Variant as _;
use crate::scene::{HeightMap, Mesh, Samples};

/// A height map and its place.
#[derive(Debug, Clone)]
pub struct MapInput {
    /// The samples.
    pub map: Arc<HeightMap>,
    /// The map's place on the base.
    pub placement: Placement,
}

/// The contents of a scene.
#[derive(Debug, Clone, Copy, Default)]
pub struct Inputs<'a> {
    /// At least one, at most [`Inputs::MAPS`].
    pub maps: &'a [MapInput],
    /// Polygon objects in the world, metres: x east, y up from the base, z south.
    pub objects: &'a [Mesh],
    /// A picture over the first map, or what is drawn of the terrain itself.
    pub drape: Option<&'a Drape>,
    /// Of each map, in their order, where the maps have no samples of their own; else none. For [`Variant::TiledCompute`] alone.
    pub tiles: &'a [Arc<TileFile>],
}

impl Inputs<'_> {
    /// The most maps that a hit can tell apart.
    pub const MAPS: usize = 16;
}

/// The maps' places over the base, and the box around all.
pub struct Scene {
    /// The maps over the base.
    pub grounds: Vec<Ground>,
    /// The maps as passes read them: those of a whole turn are closed.
    pub maps: Vec<Arc<HeightMap>>,
    /// The box around all maps.
    pub extent: Extent,
    /// Lowest and highest above the base, metres.
    pub range_m: (f64, f64),
    /// The maps' height at which the base lies, metres.
    pub base_level_m: f64,
    /// The drape over the terrain, if there is one.
    pub draping: Option<Draping>,
    /// Of each map where none is held.
    pub tiles: Vec<Arc<TileFile>>,
}

impl Scene {
    /// Of at least one map.
    pub fn new(parameters: &Parameters, inputs: &Inputs<'_>) -> Self {
        let placed = inputs.maps;
        let maps = || placed.iter().map(|input| &*input.map);
        let lowest_m = maps().map(|map| map.range_m().0).fold(f32::INFINITY, f32::min);
        let highest_m = maps().map(|map| map.range_m().1).fold(f32::NEG_INFINITY, f32::max);
        let base_level_m = f64::from(parameters.base_level_m.unwrap_or(lowest_m));
        let origin = Origin::of(maps());
        let ground = |input: &MapInput| Ground::new(&input.map, input.placement, parameters.base, origin, base_level_m);
        let grounds: Vec<Ground> = placed.iter().map(ground).collect();
        let start = Extent::of(std::iter::empty());
        let closed = |(input, ground): (&MapInput, &Ground)| {
            if ground.closes && inputs.tiles.is_empty() { Arc::new(input.map.closed()) } else { input.map.clone() }
        };
        Scene {
            extent: grounds.iter().map(Ground::extent).fold(start, Extent::union),
            range_m: (f64::from(lowest_m) - base_level_m, f64::from(highest_m) - base_level_m),
            base_level_m,
            draping: inputs.drape.map(Drape::draping),
            tiles: inputs.tiles.to_vec(),
            maps: placed.iter().zip(&grounds).map(closed).collect(),
            grounds,
        }
    }

    /// Refuses what needs the samples of maps that are not held.
    ///
    /// # Errors
    /// [`Error::Filling`].
    pub fn check_tiles(&self, label: &str, variant: Variant) -> Result<(), Error> {
        let reason = if self.tiles.is_empty() {
            return Ok(());
        } else if variant != Variant::TiledCompute {
            format!("variant {} holds whole maps: take tiled-compute, or leave `stream` out", variant.as_str())
        } else if self.grounds.iter().any(|ground| ground.closes) {
            "a map that goes once round the base is held whole: leave `stream` out".to_owned()
        } else {
            return Ok(());
        };
        Err(Error::Filling { object: format!("{label}/maps"), reason })
    }

    /// The maps as passes read them.
    pub fn height_maps(&self) -> impl ExactSizeIterator<Item = &HeightMap> + Clone {
        self.maps.iter().map(|map| &**map)
    }

    /// Every map as `rays` see it.
    pub fn terrain_blocks<'a>(
        &'a self,
        parameters: &'a Parameters,
        rays: &'a Rays,
        near_m: f32,
    ) -> impl Iterator<Item = TerrainBlock> + 'a {
        let maps = self.grounds.iter().zip(&self.maps).zip(0..);
        maps.map(move |((ground, map), index)| {
            let is_float = matches!(map.samples(), Samples::Float(_));
            TerrainBlock::new(ground, parameters, is_float, index, rays, near_m)
        })
    }
}

/// A map on the device.
pub struct Map {
    /// The samples and the levels above them.
    pub levels: Levels,
    /// A [`TerrainBlock`].
    pub terrain: Arc<Buffer>,
}

/// The maps on the device, and the blocks that the host writes anew for every frame.
pub struct DeviceScene {
    /// The maps in their order.
    pub maps: Vec<Map>,
    /// A [`LightBlock`].
    pub light: Arc<Buffer>,
    /// The draped picture; a white texel without one.
    pub drape: Arc<ImageView>,
    /// The drape over the terrain, if there is one.
    pub draping: Option<Draping>,
    /// A single texel, of the sky: what is found before the first map.
    pub no_hits: Arc<ImageView>,
    /// The next frame marks the tiles that it reads.
    pub marks_tiles: bool,
}

impl DeviceScene {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        &Build { shaders, label, parameters, traversal, is_packed, .. }: &Build<'_>,
        Scene { maps, tiles, .. }: &Scene,
        drape: Option<&Drape>,
    ) -> Result<Self, Error> {
        let cover = traversal.cover(parameters.interpolation);
        let bounds: &[Bound] = match parameters.interpolation {
            Interpolation::Bilinear => &[Bound::Highest],
            Interpolation::Bicubic => &[Bound::Highest, Bound::Lowest],
        };
        let device = shaders.device();
        let pool = (parameters.interpolation, parameters.tile_bytes() / maps.len().max(1) as u64);
        let map = |(index, map): (usize, &Arc<HeightMap>)| {
            let name = format!("{label}/map-{index}");
            Ok(Map {
                levels: match traversal {
                    Traversal::Tiles => Levels::in_tiles(device, &name, map, pool, tiles.get(index))?,
                    Traversal::Halving | Traversal::Cells => {
                        let levels = Levels::new(shaders, &name, map, bounds, cover)?;
                        if is_packed { levels.pack(shaders, &name)? } else { levels }
                    }
                },
                terrain: block_buffer::<TerrainBlock>(device, &format!("{name}/land"))?,
            })
        };
        let maps = maps.iter().enumerate().map(map).collect::<Result<_, Error>>()?;
        let draping = drape.map(Drape::draping);
        let drape = drape.map_or_else(|| Cow::Owned(Drape::white()), Cow::Borrowed);
        let srgb = vk::Format::R8G8B8A8_SRGB;
        let drape = texels(device, &format!("{label}/drape"), srgb, drape.size(), |first_row, bytes| {
            bytes.copy_from_slice(drape.rows_from(first_row, bytes.len()));
        })?;
        let texel = [NO_DEPTH, 0.0, 0.0, 0.0];
        let vector = vk::Format::R32G32B32A32_SFLOAT;
        let no_hits = texels(device, &format!("{label}/nothing"), vector, (1, 1), |_, bytes| {
            bytes.copy_from_slice(bytemuck::bytes_of(&texel));
        })?;
        let light = block_buffer::<LightBlock>(device, &format!("{label}/light"))?;
        Ok(DeviceScene { maps, light, drape, draping, no_hits, marks_tiles: false })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn write(&self, view: &SceneView) -> Result<(), Error> {
        for (map, terrain) in self.maps.iter().zip(&view.terrains) {
            let terrain = TerrainBlock { marks_tiles: self.marks_tiles.into(), ..*terrain };
            map.terrain.write(0, bytemuck::bytes_of(&terrain))?;
        }
        self.light.write(0, bytemuck::bytes_of(&view.light))
    }
}

/// An image of texels that passes fetch; `fill` writes a strip from a row on.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn texels(
    device: &Arc<Device>,
    name: &str,
    format: vk::Format,
    size: (u32, u32),
    fill: impl FnMut(u32, &mut [u8]),
) -> Result<Arc<ImageView>, Error> {
    let desc = ImageDesc::new_2d(name, format, size.0, size.1).usage(vk::ImageUsageFlags::SAMPLED);
    let view = Image::new(device, desc)?.view()?;
    upload_rows(device, &view, size, fill)?;
    Ok(view)
}

/// A uniform block that the host writes.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn block_buffer<T>(device: &Arc<Device>, name: &str) -> Result<Arc<Buffer>, Error> {
    let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
    let desc = BufferDesc::new(name, size_of::<T>() as u64).usage(usage).location(Location::Upload);
    Buffer::new(device, desc)
}
