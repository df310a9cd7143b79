//! The pass `mesh` (section 4) of the variant `mesh`, what a user would do first without the method: the map as an indexed
//! triangle grid, rasterised. It fills the same target as the pass `depth`. Once for each map.

use ash::vk;

use super::base::BasePass;
use super::geometric_transformation::SceneView;
use super::ground::Ground;
use super::hit::Surface;
use super::pyramid::Shape;
use super::scene::DeviceScene;
use super::stage::Build;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, DepthTest, Error, Frame, Load, Pass};
use crate::host_block;

/// The most samples a side that are drawn as triangles.
pub const MESH_SIDE: u32 = 4096;
/// Indices of one draw, about: the grid is drawn in blocks of rows that share them.
pub const BLOCK_INDICES: u32 = 1 << 20;

host_block! {
    pub(super) struct MeshConstants {
        /// From u, v and h; w is the depth along the view's axis in metres.
        to_clip: [f32; 16],
        /// Of the block of rows that is drawn.
        first_row: i32,
        /// A [`Surface`].
        surface: i32,
    }
}

impl MeshConstants {
    /// Of a map on the screen.
    pub(super) fn new(view: &SceneView, ground: &Ground, (surface, first_row): (Surface, u32)) -> Self {
        let to_clip = (view.to_clip * ground.to_frame.inverse()).as_mat4().to_cols_array();
        MeshConstants { to_clip, first_row: first_row as i32, surface: surface as i32 }
    }
}

/// The grids of all maps.
pub struct Mesh {
    grids: Vec<Grid>,
}

struct Grid {
    shape: Shape,
    block_rows: u32,
    pass: Pass,
}

impl Mesh {
    /// Draws into the targets of `base`.
    ///
    /// # Errors
    /// [`Error::Limit`] for a map of more than [`MESH_SIDE`] samples a side, errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, grounds: &[Ground], scene: &DeviceScene, base: &BasePass) -> Result<Self, Error> {
        let Build { shaders, label, .. } = *build;
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
            let indices =
                upload(shaders.device(), &name, vk::BufferUsageFlags::INDEX_BUFFER, bytemuck::cast_slice(&bytes))?;
            let pass = Pass::graphics("mesh", "4", "terrain/mesh.vert", "terrain/mesh.frag")
                .with("terrain", &map.terrain)
                .with("levels", &map.levels.view)
                .indices(&indices)
                .constants::<MeshConstants>()
                .color(&base.target, Load::Keep, Blend::Replace)
                .depth(&base.tested, Load::Keep, DepthTest::GreaterWrite)
                .build(shaders)?;
            grids.push(Grid { shape, block_rows, pass });
        }
        Ok(Mesh { grids })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, grounds: &[Ground], view: &SceneView) -> Result<(), Error> {
        for (grid, ground) in self.grids.iter().zip(grounds) {
            let constants = |surface, first_row| MeshConstants::new(view, ground, (surface, first_row));
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
pub(super) fn block_indices(width: u32, rows: u32) -> Vec<u32> {
    let cell = |row: u32, column: u32| {
        let a = row * width + column;
        let (b, c, d) = (a + 1, a + width, a + width + 1);
        [a, c, b, b, c, d]
    };
    (0..rows).flat_map(|row| (0..width - 1).flat_map(move |column| cell(row, column))).collect()
}
