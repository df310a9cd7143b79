//! What a user would do without the method: the map as an indexed triangle grid, rasterised. It fills the same target as the
//! rays do.

use std::sync::Arc;

use ash::vk;

use super::ground::Ground;
use super::hit::{NO_DEPTH, Surface};
use super::parameters::Parameters;
use super::pyramid::Shape;
use super::scene::{DeviceScene, Seen};
use super::stage::Stage;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;

/// The most samples a side that are drawn as triangles.
pub const MESH_SIDE: u32 = 4096;
/// Indices of one draw, about: the grid is drawn in blocks of rows that share them.
const BLOCK_INDICES: u32 = 1 << 20;

host_block! {
    struct MeshConstants {
        to_clip: [f32; 16],
        first_row: i32,
        surface: i32,
    }
}

/// The grids of all maps.
pub struct Mesh {
    base: Pass,
    grids: Vec<Grid>,
    /// What the grids and the base cover.
    pub depth: Arc<ImageView>,
}

struct Grid {
    shape: Shape,
    block_rows: u32,
    pass: Pass,
}

impl Mesh {
    /// # Errors
    /// [`Error::Limit`] for a map of more than [`MESH_SIDE`] samples a side, what Vulkan answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        grounds: &[Ground],
        scene: &DeviceScene,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let size = (parameters.width, parameters.height);
        let format = vk::Format::R32G32B32A32_SFLOAT;
        let depth = Stage::Fragment.image(device, format!("{label}/depth"), format, size)?;
        let desc = ImageDesc::new_2d(format!("{label}/tested"), vk::Format::D32_SFLOAT, size.0, size.1);
        let tested = Image::new(device, desc.usage(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT))?.view()?;
        let Some(first) = scene.maps.first() else {
            return Err(Error::Pass { pass: "mesh".into(), problem: "there is no map".into() });
        };
        let fragment = format!("terrain/mesh-base-{}.frag", parameters.base.kind());
        let base = Pass::graphics("base", "2", "common/fullscreen.vert", &fragment)
            .with("terrain", &first.terrain)
            .with("levels", &first.levels.view)
            .color(&depth, Load::Clear([NO_DEPTH, 0.0, 0.0, 0.0]), Blend::Replace)
            .depth(&tested, Load::Clear([1.0, 0.0, 0.0, 0.0]), DepthTest::LessWrite)
            .build(shaders)?;
        let mut grids = Vec::new();
        for (index, (ground, map)) in grounds.iter().zip(&scene.maps).enumerate() {
            let shape = ground.shape;
            let side = shape.width.max(shape.height);
            if side > MESH_SIDE {
                return Err(Error::Limit {
                    object: format!("{label}/map-{index}/mesh"),
                    what: "number of samples a side",
                    wanted: side.into(),
                    limit: MESH_SIDE.into(),
                });
            }
            let block_rows = (BLOCK_INDICES / (6 * (shape.width - 1))).clamp(1, shape.height - 1);
            let name = format!("{label}/mesh-indices");
            let bytes = block_indices(shape.width, block_rows);
            let indices = upload(device, &name, vk::BufferUsageFlags::INDEX_BUFFER, bytemuck::cast_slice(&bytes))?;
            let pass = Pass::graphics("mesh", "4", "terrain/mesh.vert", "terrain/mesh.frag")
                .with("terrain", &map.terrain)
                .with("levels", &map.levels.view)
                .indices(&indices)
                .constants::<MeshConstants>()
                .color(&depth, Load::Keep, Blend::Replace)
                .depth(&tested, Load::Keep, DepthTest::LessWrite)
                .build(shaders)?;
            grids.push(Grid { shape, block_rows, pass });
        }
        Ok(Mesh { base, grids, depth })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, grounds: &[Ground], seen: &Seen) -> Result<(), Error> {
        frame.graphics(&self.base, |draw| {
            draw.vertices(3);
        })?;
        for (grid, ground) in self.grids.iter().zip(grounds) {
            let to_clip = (seen.to_clip * ground.to_frame.inverse()).as_mat4().to_cols_array();
            let constants = |surface: Surface, first_row: u32| MeshConstants {
                to_clip,
                first_row: first_row as i32,
                surface: surface as i32,
            };
            let Shape { width, height, .. } = grid.shape;
            frame.graphics(&grid.pass, |draw| {
                for first_row in (0..height - 1).step_by(grid.block_rows as usize) {
                    let rows = grid.block_rows.min(height - 1 - first_row);
                    draw.constants(&constants(Surface::Terrain, first_row)).indices(6 * (width - 1) * rows);
                }
                for side in [Surface::WallWest, Surface::WallEast] {
                    draw.constants(&constants(side, 0)).vertices(6 * (height - 1));
                }
                for side in [Surface::WallNorth, Surface::WallSouth] {
                    draw.constants(&constants(side, 0)).vertices(6 * (width - 1));
                }
            })?;
        }
        Ok(())
    }
}

/// Two triangles a cell, row by row; vertices are numbered from the block's first row.
fn block_indices(width: u32, rows: u32) -> Vec<u32> {
    let cell = |row: u32, column: u32| {
        let a = row * width + column;
        let (b, c, d) = (a + 1, a + width, a + width + 1);
        [a, c, b, b, c, d]
    };
    (0..rows).flat_map(|row| (0..width - 1).flat_map(move |column| cell(row, column))).collect()
}
