//! The variant `culled` (section 6.1): of the pairs of water triangle and plane those that may light a texel of the
//! plane's own cell, found on the device and drawn in one indirect draw, in the level map's order.

mod cull;
mod cull_compact;
mod cull_count;
mod cull_sum;

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use self::cull::cull;
use self::cull_compact::cull_compact;
use self::cull_count::cull_count;
use self::cull_sum::cull_sum;
use super::intersections::{OptionConstants, Options, Scope};
use super::planes::{self, Cell};
use super::position_pyramid::PositionPyramid;
use super::receiver::LitReceiver;
use super::resources::{BLACK, Context};
use super::smart_planes::SmartPlanes;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Blend, Buffer, BufferDesc, Error, Frame, ImageView, Pass};
use crate::host_block;
use crate::measure::parameter::Choice;

/// Numbers of a [`CellBlock`].
pub const CELL_FLOATS: u32 = 4;
/// Planes of a word.
const WORD: u32 = 32;
/// Triangles of a block.
const BLOCK: u32 = 256;
/// Planes of an invocation.
const GROUP: u32 = 128;

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
        top: f32,
        cells_per_m: f32,
        inset: f32,
        map_size: u32,
        levels: u32,
        triangles: u32,
        words: u32,
        planes: u32,
        blocks: u32,
        vertices: u32,
        depth_levels: u32,
        depth_levels_per_m: f32,
    }
}

host_block! {
    /// 1 for each step that is taken.
    pub struct StepsBlock {
        groups: u32,
        planes: u32,
        texels: u32,
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

/// Steps by which `culled` drops pairs of water triangle and plane (section 6.1). They change its time alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CullSteps {
    /// Groups of planes are tested before their planes.
    pub groups: bool,
    /// Planes are tested by the rectangle around the triangle.
    pub planes: bool,
    /// Planes are tested down to texels.
    pub texels: bool,
}

impl CullSteps {
    pub const EVERY: CullSteps = CullSteps { groups: true, planes: true, texels: true };

    const fn of(groups: bool, planes: bool, texels: bool) -> Self {
        CullSteps { groups, planes, texels }
    }
}

impl Choice for CullSteps {
    const ALL: &'static [Self] = &[
        CullSteps::EVERY,
        CullSteps::of(false, false, false),
        CullSteps::of(true, false, false),
        CullSteps::of(false, true, false),
        CullSteps::of(false, false, true),
        CullSteps::of(true, true, false),
        CullSteps::of(true, false, true),
        CullSteps::of(false, true, true),
    ];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("every", "Groups of planes, then planes, then texels"),
        ("none", "Every pair of a triangle that light enters by and of a plane under it is drawn"),
        ("groups", "Groups of planes alone"),
        ("planes", "Planes alone, by the rectangle around the triangle"),
        ("texels", "Texels alone, or nearly so"),
        ("groups-planes", "Groups of planes, then planes"),
        ("groups-texels", "Groups of planes, then texels"),
        ("planes-texels", "Planes, then texels"),
    ];
}

/// A [`CellBlock`] for each uniform plane; the box's centre is at `middle_m` from the rays' reference point.
fn uniform_cells(context: Context<'_>, lit: &LitReceiver, middle_m: f64) -> Result<Arc<Buffer>, Error> {
    let mut cells = Vec::new();
    planes::slice(lit.aligned.extent.y, lit.planes, &mut cells);
    let block =
        |cell: &Cell| CellBlock { height: cell.height(middle_m), lower: cell.lower, upper: cell.upper, _pad: 0.0 };
    let blocks: Vec<CellBlock> = cells.iter().map(block).collect();
    context.upload("plane-cells", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::cast_slice(&blocks))
}

/// Begins a pass over the pairs of water triangle and plane.
fn over_pairs(name: &'static str, shader: &str) -> PassBuilder {
    Pass::compute(name, "6.1", shader).constants::<CullConstants>()
}

/// Passes of one receiver under one light.
pub struct CulledMap {
    /// Planes by the position map; uniform ones without.
    smart_planes: Option<SmartPlanes>,
    position_pyramid: PositionPyramid,
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
        let smart = |epsilon_m| SmartPlanes::new(context, lit, epsilon_m, offset.y, position_map);
        let smart_planes = context.parameters.smart_on_device().map(smart).transpose()?;
        let (cells, planes) = match &smart_planes {
            Some(smart) => (smart.cells.clone(), smart.most()),
            None => (uniform_cells(context, lit, offset.y)?, lit.planes),
        };

        let position_pyramid = PositionPyramid::new(context, position_map)?;
        let triangles = water.grid.triangle_count();
        let words = planes.div_ceil(WORD);
        let all_words = u64::from(words) * u64::from(triangles);
        let blocks = triangles.div_ceil(BLOCK);
        let indices = 3 * u64::from(triangles) * u64::from(planes);
        // An index names a vertex and a plane.
        let names = u64::from(water.grid.vertex_count()) * u64::from(planes);
        let set_by = if smart_planes.is_some() { "levels` or `planes" } else { "planes" };
        let (limit, wanted) = (u64::from(context.device().physical().largest_index()), names.max(indices));
        if wanted > limit {
            let object = context.name("culled-pairs");
            return Err(Error::Limit { object, what: "index of a vertex on a plane", wanted, limit }.set_by(set_by));
        }
        let buffer = |name: &str, bytes: u64, usage| {
            let usage = usage | vk::BufferUsageFlags::STORAGE_BUFFER;
            Buffer::new(context.device(), BufferDesc::new(context.name(name), bytes).usage(usage))
                .map_err(|error| error.set_by(set_by))
        };
        let none = vk::BufferUsageFlags::empty();
        let taken = context.parameters.cull;
        let steps = StepsBlock {
            groups: u32::from(taken.groups),
            planes: u32::from(taken.planes),
            texels: u32::from(taken.texels),
        };
        let steps =
            context.upload("culling-steps", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&steps))?;
        let kept = buffer("culled-kept", 4 * all_words, none)?;
        let before = buffer("culled-before", 4 * u64::from(triangles), none)?;
        let block_sums = buffer("culled-blocks", 4 * u64::from(blocks), none)?;
        let arguments = buffer("culled-arguments", 20, vk::BufferUsageFlags::INDIRECT_BUFFER)?;
        let pairs = buffer("culled-pairs", 4 * indices, vk::BufferUsageFlags::INDEX_BUFFER)?;

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
            cull: cull(scope, &steps, &cells, &position_pyramid, smart_planes.as_ref(), &kept)?,
            cull_count: cull_count(shaders, &kept, [&before, &block_sums])?,
            cull_sum: cull_sum(shaders, &block_sums, &arguments)?,
            cull_compact: cull_compact(scope, &kept, [&before, &block_sums], &pairs)?,
            caustics_map: caustics_map.build(shaders)?,
            constants: CullConstants {
                center,
                texels_per_m: [(texels / extent.x) as f32, (texels / extent.z) as f32],
                top: (lit.aligned.extent.y / 2.0) as f32,
                cells_per_m: (f64::from(lit.planes) / lit.aligned.extent.y) as f32,
                inset: 0.5 / context.parameters.coverage as f32,
                map_size: context.parameters.map_size,
                levels: position_pyramid.level_count(),
                triangles,
                words,
                planes,
                blocks,
                vertices,
                depth_levels: context.parameters.smart.levels,
                depth_levels_per_m: (f64::from(context.parameters.smart.levels) / lit.aligned.extent.y) as f32,
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
            smart_planes,
        })
    }

    /// The planes of the last frame as smart slicing placed them.
    pub fn smart_planes(&self) -> Option<&SmartPlanes> {
        self.smart_planes.as_ref()
    }

    /// Finds the pairs, and draws them after clearing the map; the light has passed water of that absorption.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, absorption_per_m: f32) -> Result<(), Error> {
        self.position_pyramid.record(frame)?;
        self.smart_planes.as_ref().map_or(Ok(()), |smart| smart.record(frame))?;
        let CullConstants { triangles, planes, .. } = self.constants;
        let steps = [
            (&self.cull, triangles, planes.div_ceil(GROUP)),
            (&self.cull_count, triangles, 1),
            (&self.cull_sum, 1, 1),
            (&self.cull_compact, triangles, 1),
        ];
        for (pass, elements, layers) in steps {
            frame.compute(pass, |dispatch| dispatch.constants(&self.constants).layers_of_elements(elements, layers))?;
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
