//! The variant `culled` (section 6.1): of the pairs of water triangle and plane those that may light a texel of the
//! plane's own cell, found on the device and drawn in one indirect draw, in the level map's order.

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use super::intersections::{OptionConstants, Options, Scope};
use super::planes;
use super::position_pyramid::PositionPyramid;
use super::receiver::LitReceiver;
use super::resources::BLACK;
use crate::gpu::{Blend, Buffer, BufferDesc, Error, Frame, ImageView, Pass};
use crate::host_block;

/// Triangles of a word.
const WORD: u32 = 32;
/// Words of a block.
const BLOCK: u32 = 256;

host_block! {
    /// A plane's height from the rays' reference point, and the heights of its cell from the box's centre, metres.
    pub struct CellBlock {
        height: f32,
        lower: f32,
        upper: f32,
        _pad: f32,
    }
}

host_block! {
    struct CullConstants {
        center: [f32; 2],
        texels_per_m: [f32; 2],
        first_height: f32,
        last_height: f32,
        map_size: u32,
        levels: u32,
        triangles: u32,
        words: u32,
        planes: u32,
        blocks: u32,
        vertices: u32,
    }
}

host_block! {
    struct DrawConstants {
        center: [f32; 2],
        to_clip: [f32; 2],
        up: [f32; 3],
        absorption_per_m: f32,
        texel_area_m2: f32,
        vertices: u32,
    }
}

/// Passes of one receiver under one light.
pub struct CulledMap {
    position_pyramid: PositionPyramid,
    cull_bounds: Pass,
    cull: Pass,
    cull_count: Pass,
    cull_sum: Pass,
    cull_compact: Pass,
    caustics_map: Pass,
    constants: CullConstants,
    draw: DrawConstants,
    /// In their place beside the thesis's reading.
    options: Option<OptionConstants>,
}

impl CulledMap {
    /// Draws to `drawn`, by the heights of `position_map`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for more pairs than a buffer can list.
    pub fn new(
        scope: Scope<'_>,
        lit: &LitReceiver,
        position_map: &Arc<ImageView>,
        drawn: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let Scope { context, volumes, water, shadows, .. } = scope;
        let shaders = context.shaders;
        let offset = lit.aligned.center - volumes.reference;
        let mut uniform = Vec::new();
        planes::slice(lit.aligned.extent.y, context.parameters.planes, &mut uniform);
        let height = |cell: &planes::Cell| (offset.y + f64::from(cell.plane)) as f32;
        let cells: Vec<CellBlock> = uniform
            .iter()
            .map(|cell| CellBlock { height: height(cell), lower: cell.lower, upper: cell.upper, _pad: 0.0 })
            .collect();
        let cells =
            context.upload("plane-cells", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::cast_slice(&cells))?;

        let position_pyramid = PositionPyramid::new(context, position_map)?;
        let triangles = water.grid.triangle_count();
        let words = triangles.div_ceil(WORD);
        let all_words = u64::from(words) * uniform.len() as u64;
        let blocks = all_words.div_ceil(u64::from(BLOCK));
        let indices = 3 * u64::from(triangles) * uniform.len() as u64;
        // An index names a vertex and a plane.
        let names = u64::from(water.grid.vertex_count()) * uniform.len() as u64;
        let (limit, wanted) = (u64::from(context.device().physical().largest_index()), names.max(indices));
        if wanted > limit {
            let object = context.name("culled-pairs");
            return Err(Error::Limit { object, what: "index of a vertex on a plane", wanted, limit }.set_by("planes"));
        }
        let buffer = |name: &str, bytes: u64, usage| {
            let usage = usage | vk::BufferUsageFlags::STORAGE_BUFFER;
            Buffer::new(context.device(), BufferDesc::new(context.name(name), bytes).usage(usage))
                .map_err(|error| error.set_by("planes"))
        };
        let none = vk::BufferUsageFlags::empty();
        let bounds = buffer("culled-bounds", 32 * u64::from(words), none)?;
        let kept = buffer("culled-kept", 4 * all_words, none)?;
        let before = buffer("culled-before", 4 * all_words, none)?;
        let block_sums = buffer("culled-blocks", 4 * blocks, none)?;
        let arguments = buffer("culled-arguments", 20, vk::BufferUsageFlags::INDIRECT_BUFFER)?;
        let pairs = buffer("culled-pairs", 4 * indices, vk::BufferUsageFlags::INDEX_BUFFER)?;

        let kernel = |name, shader: &str| Pass::compute(name, "6.1", shader).constants::<CullConstants>();
        let extent = lit.aligned.extent;
        let center = [offset.x as f32, offset.z as f32];
        let texels = f64::from(context.parameters.map_size);
        let vertices = water.grid.vertex_count();
        let options = Options::of(scope);
        let (vertex, fragment) = match (&options, shadows) {
            (None, _) => ("caustics/culled.vert", "caustics/culled.frag"),
            (Some(_), None) => {
                ("caustics/caustics-map-options-kept.vert", "caustics/caustics-map-options-kept-off.frag")
            }
            (Some(_), Some(_)) => {
                ("caustics/caustics-map-options-kept.vert", "caustics/caustics-map-options-kept-on.frag")
            }
        };
        let mut caustics_map = Pass::graphics("caustics-map", "6.1", vertex, fragment)
            .indices(&pairs)
            .indirect(&arguments)
            .with("position_map", position_map)
            .with("nearest", context.nearest)
            .with("cells", &cells)
            .with("rays", &volumes.rays)
            .color(drawn, BLACK, Blend::Add);
        caustics_map = match options {
            None => caustics_map.constants::<DrawConstants>(),
            Some(_) => caustics_map.constants::<OptionConstants>(),
        };
        if let Some(shadows) = shadows {
            caustics_map = caustics_map.with("shadow_map", &shadows.map);
        }
        Ok(CulledMap {
            cull_bounds: kernel("cull-bounds", "caustics/cull-bounds.comp")
                .with("rays", &volumes.rays)
                .with("indices", &water.indices)
                .with("bounds", &bounds)
                .build(shaders)?,
            cull: kernel("cull", "caustics/cull.comp")
                .with("rays", &volumes.rays)
                .with("indices", &water.indices)
                .with("bounds", &bounds)
                .with("pyramid", &position_pyramid.heights)
                .with("cells", &cells)
                .with("kept", &kept)
                .build(shaders)?,
            cull_count: kernel("cull-count", "caustics/cull-count.comp")
                .with("kept", &kept)
                .with("before", &before)
                .with("blocks", &block_sums)
                .build(shaders)?,
            cull_sum: kernel("cull-sum", "caustics/cull-sum.comp")
                .with("blocks", &block_sums)
                .with("arguments", &arguments)
                .build(shaders)?,
            cull_compact: kernel("cull-compact", "caustics/cull-compact.comp")
                .with("indices", &water.indices)
                .with("kept", &kept)
                .with("before", &before)
                .with("blocks", &block_sums)
                .with("pairs", &pairs)
                .build(shaders)?,
            caustics_map: caustics_map.build(shaders)?,
            constants: CullConstants {
                center,
                texels_per_m: [(texels / extent.x) as f32, (texels / extent.z) as f32],
                first_height: uniform.first().map_or(0.0, height),
                last_height: uniform.last().map_or(0.0, height),
                map_size: context.parameters.map_size,
                levels: position_pyramid.level_count(),
                triangles,
                words,
                planes: uniform.len() as u32,
                blocks: blocks as u32,
                vertices,
            },
            draw: DrawConstants {
                center,
                to_clip: [(2.0 / extent.x) as f32, (2.0 / extent.z) as f32],
                up: volumes.axes.along(DVec3::Y).as_vec3().to_array(),
                absorption_per_m: lit.absorption_per_m,
                texel_area_m2: (extent.x * extent.z / texels.powi(2)) as f32,
                vertices,
            },
            options: options.map(|options| options.of_receiver(lit, volumes)),
            position_pyramid,
        })
    }

    /// Finds the pairs, and draws them after clearing the map; the light has passed water of that absorption.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, absorption_per_m: f32) -> Result<(), Error> {
        self.position_pyramid.record(frame)?;
        let CullConstants { words, planes, blocks, .. } = self.constants;
        let steps = [
            (&self.cull_bounds, [words, 1]),
            (&self.cull, [words, planes]),
            (&self.cull_count, [blocks * BLOCK, 1]),
            (&self.cull_sum, [1, 1]),
            (&self.cull_compact, [words, planes]),
        ];
        for (pass, [x, y]) in steps {
            frame.compute(pass, |dispatch| {
                dispatch.constants(&self.constants).threads(x, y, 1);
            })?;
        }
        frame.graphics(&self.caustics_map, |draw| {
            match self.options {
                None => draw.constants(&DrawConstants { absorption_per_m, ..self.draw }),
                Some(options) => draw.constants(&options.absorbing(absorption_per_m)),
            }
            .indices_indirect();
        })
    }
}
