//! The passes `select` and `mesh-lod` (section 4) of the variant `mesh-lod`: triangles as fine as the picture needs them, the
//! strongest that the method can be compared with. They fill the same target as the pass `depth`. Once for each map.

use std::sync::Arc;

use ash::vk;

use super::base::BasePass;
use super::geometric_transformation::SceneView;
use super::ground::Ground;
use super::hit::Surface;
use super::mesh::{MeshConstants, block_indices};
use super::parameters::Parameters;
use super::quadtree::{PATCH_SIDE, Quadtree};
use super::scene::{DeviceScene, Map};
use super::selection::{Patch, Selection, Viewer};
use super::stage::Build;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, BufferDesc, DepthTest, Error, Frame, Load, Location, Pass, PassInfo};

/// Indices of a patch.
const INDICES: u32 = 6 * PATCH_SIDE * PATCH_SIDE;

/// The patches of all maps.
pub struct MeshLod {
    select: Arc<PassInfo>,
    grids: Vec<Grid>,
}

struct Grid {
    selection: Selection,
    /// A [`Patch`] each.
    patches: Arc<Buffer>,
    pass: Pass,
}

impl MeshLod {
    /// Draws into the targets of `base`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, grounds: &[Ground], scene: &DeviceScene, base: &BasePass) -> Result<Self, Error> {
        let Build { shaders, label, .. } = *build;
        let indices = upload(
            shaders.device(),
            &format!("{label}/patch-indices"),
            vk::BufferUsageFlags::INDEX_BUFFER,
            bytemuck::cast_slice(&block_indices(PATCH_SIDE + 1, PATCH_SIDE)),
        )?;
        let grid = |(index, (ground, map)): (usize, (&Ground, &Map))| {
            let name = format!("{label}/map-{index}");
            let tree = Quadtree::new(shaders, &name, &map.levels, ground.base)?;
            let bytes = (tree.most() * size_of::<Patch>()) as u64;
            let desc = BufferDesc::new(format!("{name}/patches"), bytes).usage(vk::BufferUsageFlags::VERTEX_BUFFER);
            let patches = Buffer::new(shaders.device(), desc.location(Location::Upload))?;
            // A frame writes those that it draws alone; the rest is bound as well.
            patches.write(0, &vec![0; bytes as usize])?;
            let pass = Pass::graphics("mesh-lod", "4", "terrain/mesh-lod.vert", "terrain/mesh.frag")
                .with("terrain", &map.terrain)
                .with("levels", &map.levels.view)
                .instances::<Patch>(&patches)
                .indices(&indices)
                .constants::<MeshConstants>()
                .color(&base.target, Load::Keep, Blend::Replace)
                .depth(&base.tested, Load::Keep, DepthTest::GreaterWrite)
                .build(shaders)?;
            Ok(Grid { selection: Selection::new(tree), patches, pass })
        };
        let grids = grounds.iter().zip(&scene.maps).enumerate().map(grid).collect::<Result<_, Error>>()?;
        Ok(MeshLod { select: PassInfo::host("select", "4", &["camera", "bounds"], &["patches"]), grids })
    }

    /// Patches of the last frame, by level from the maps' own cells on.
    pub fn by_level(&self) -> Vec<u64> {
        let mut counts = Vec::new();
        for of_map in self.grids.iter().map(|grid| grid.selection.by_level()) {
            counts.resize(counts.len().max(of_map.len()), 0);
            counts.iter_mut().zip(of_map).for_each(|(sum, patches)| *sum += patches);
        }
        counts
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(
        &mut self,
        frame: &mut Frame<'_>,
        grounds: &[Ground],
        view: &SceneView,
        parameters: &Parameters,
    ) -> Result<(), Error> {
        let MeshLod { select, grids } = self;
        frame.host(select, || {
            grids.iter_mut().zip(grounds).try_for_each(|(Grid { selection, patches, .. }, ground)| {
                let viewer = Viewer::new(ground, &view.rays, (parameters.width, parameters.height));
                selection.choose(&viewer, parameters.mesh_error_px.into());
                patches.write(0, bytemuck::cast_slice(&selection.patches))
            })
        })?;
        for (Grid { selection, pass, .. }, ground) in grids.iter().zip(grounds) {
            let constants = |surface| MeshConstants::new(view, ground, (surface, 0));
            frame.graphics(pass, |draw| {
                draw.constants(&constants(Surface::Terrain));
                if !selection.patches.is_empty() {
                    draw.indexed_instances(INDICES, selection.patches.len() as u32);
                }
                if selection.at_border > 0 {
                    for side in [Surface::WallWest, Surface::WallEast, Surface::WallNorth, Surface::WallSouth] {
                        draw.constants(&constants(side)).instances(6 * PATCH_SIDE, selection.at_border as u32);
                    }
                }
            })?;
        }
        Ok(())
    }
}
