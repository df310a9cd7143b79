//! The patches of the variant `mesh-lod`: a quadtree over a map, with a bound of how far the triangles of each patch are from
//! the map. The device finds the bounds when the map is loaded.

use std::sync::Arc;

use ash::vk;

use super::levels::Levels;
use super::scene::texels;
use crate::gpu::transfer::read_image;
use crate::gpu::{Blend, Error, Image, ImageDesc, ImageView, Load, Mode, Pass, Recorder, ShaderLibrary};
use crate::host_block;

/// Cells a side of a patch.
pub const PATCH_SIDE: u32 = 16;
/// Allowance for rounding in single precision: a factor of an error, and a fraction of the heights in each level.
const ROUNDING: [f64; 2] = [1.0 + 1e-5, 1.0 / (1 << 22) as f64];

host_block! {
    struct CellConstants {
        last: [i32; 2],
        last_cell: [i32; 2],
        step: i32,
        is_float: i32,
        is_first: i32,
    }
}

/// A patch of [`PATCH_SIDE`] x [`PATCH_SIDE`] cells of 2^level nodes, heights in the map's own numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The most by which its triangles differ from the bilinear surface.
    pub error: f64,
    /// Of all nodes below it; on the map's border the base where that is lower, which its walls reach.
    pub low: f64,
    /// Of all nodes below it.
    pub high: f64,
}

/// The patches of one size.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchLevel {
    /// Patches along a row.
    pub columns: u32,
    /// Rows of patches.
    pub rows: u32,
    /// Row by row.
    pub patches: Vec<Bounds>,
}

/// All patches of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadtree {
    /// Nodes of the map along its rows and columns.
    pub size: [u32; 2],
    /// Those of the map's own cells first, one that covers the map last.
    pub levels: Vec<PatchLevel>,
}

/// Cells of 2^level nodes that cover the cells between so many nodes.
fn cells(nodes: u32, level: u32) -> u32 {
    (nodes - 1).div_ceil(1 << level)
}

impl Quadtree {
    /// Of a map on the device; `base` is the base's height in the map's own numbers.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(shaders: &ShaderLibrary, label: &str, map: &Levels, base: f64) -> Result<Self, Error> {
        let (width, height) = (map.shape.width, map.shape.height);
        let mut builder = Builder { shaders, label, map, recorder: Recorder::new(shaders.device())? };
        let name = format!("{label}/no-errors");
        let mut errors = texels(shaders.device(), &name, vk::Format::R32_SFLOAT, (1, 1), |_, bytes| bytes.fill(0))?;
        let mut levels: Vec<PatchLevel> = Vec::new();
        for level in 0.. {
            if level > 0 {
                errors = builder.errors(level, &errors)?;
            }
            let mut patches = builder.bounds(level, &errors)?;
            let (columns, rows) = (cells(width, level).div_ceil(PATCH_SIDE), cells(height, level).div_ceil(PATCH_SIDE));
            for (index, patch) in patches.iter_mut().enumerate() {
                let (x, y) = (index as u32 % columns, index as u32 / columns);
                match levels.last() {
                    None if x == 0 || y == 0 || x + 1 == columns || y + 1 == rows => patch.low = patch.low.min(base),
                    None => {}
                    Some(finer) => {
                        for child in finer.children(x, y) {
                            (patch.low, patch.high) = (patch.low.min(child.low), patch.high.max(child.high));
                        }
                    }
                }
            }
            levels.push(PatchLevel { columns, rows, patches });
            if columns == 1 && rows == 1 {
                break;
            }
        }
        Ok(Quadtree { size: [width, height], levels })
    }

    /// The most patches that are drawn at once.
    pub fn most(&self) -> usize {
        self.levels.first().map_or(0, |level| level.patches.len())
    }
}

impl PatchLevel {
    /// Those of the next coarser level's patch at column `x` and row `y`.
    fn children(&self, x: u32, y: u32) -> impl Iterator<Item = &Bounds> {
        let rows = 2 * y..(2 * y + 2).min(self.rows);
        let columns = 2 * x..(2 * x + 2).min(self.columns);
        rows.flat_map(move |row| columns.clone().map(move |column| (row * self.columns + column) as usize))
            .filter_map(|index| self.patches.get(index))
    }
}

struct Builder<'a> {
    shaders: &'a ShaderLibrary,
    label: &'a str,
    map: &'a Levels,
    recorder: Recorder,
}

impl Builder<'_> {
    /// The error of each cell of a level above the map's own, from those of the level below.
    fn errors(&mut self, level: u32, finer: &Arc<ImageView>) -> Result<Arc<ImageView>, Error> {
        let (width, height) = (self.map.shape.width, self.map.shape.height);
        let size = (cells(width, level), cells(height, level));
        let finer_last = [cells(width, level - 1) as i32 - 1, cells(height, level - 1) as i32 - 1];
        let format = vk::Format::R32_SFLOAT;
        self.draw("patch-error", ("finer", finer), (size, format), (level - 1, finer_last, level == 1))
    }

    /// Error, lowest and highest of each patch, of its own vertices alone.
    fn bounds(&mut self, level: u32, errors: &Arc<ImageView>) -> Result<Vec<Bounds>, Error> {
        let [columns, rows] = [self.map.shape.width, self.map.shape.height].map(|nodes| cells(nodes, level));
        let size = (columns.div_ceil(PATCH_SIDE), rows.div_ceil(PATCH_SIDE));
        let last = [columns as i32 - 1, rows as i32 - 1];
        let format = vk::Format::R32G32B32A32_SFLOAT;
        let view = self.draw("patch-bounds", ("errors", errors), (size, format), (level, last, level == 0))?;
        let texels = bytemuck::pod_collect_to_vec::<u8, f32>(&read_image(self.shaders.device(), &view)?);
        let bounds = |[error, low, high, _]: &[f32; 4]| Bounds {
            error: f64::from(*error) * ROUNDING[0]
                + f64::from(level + 1) * f64::from(low.abs().max(high.abs())) * ROUNDING[1],
            low: (*low).into(),
            high: (*high).into(),
        };
        Ok(texels.as_chunks().0.iter().map(bounds).collect())
    }

    fn draw(
        &mut self,
        name: &'static str,
        (bound, errors): (&'static str, &Arc<ImageView>),
        ((width, height), format): ((u32, u32), vk::Format),
        (step, last_cell, is_first): (u32, [i32; 2], bool),
    ) -> Result<Arc<ImageView>, Error> {
        let Builder { shaders, label, map, recorder } = self;
        let desc = ImageDesc::new_2d(format!("{label}/{name}"), format, width, height);
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let view = Image::new(shaders.device(), desc.usage(usage))?.view()?;
        let pass = Pass::graphics(name, "4", "common/fullscreen.vert", &format!("terrain/{name}.frag"))
            .with("levels", &map.view)
            .with(bound, errors)
            .constants::<CellConstants>()
            .color(&view, Load::Discard, Blend::Replace)
            .build(shaders)?;
        let constants = CellConstants {
            last: [map.shape.width as i32 - 1, map.shape.height as i32 - 1],
            last_cell,
            step: 1 << step,
            is_float: map.is_float.into(),
            is_first: is_first.into(),
        };
        recorder.run(Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.constants(&constants).vertices(3)))?;
        Ok(view)
    }
}
