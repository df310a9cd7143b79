//! The pass `mesh-lod` (section 4) of the variant of that name: triangles as fine as the picture needs them, the strongest that
//! the method can be compared with. It fills the same target as the pass `depth`. Once for each map.

use ash::vk;

use super::base::BasePass;
use super::geometric_transformation::SceneView;
use super::ground::Ground;
use super::hit::Surface;
use super::mesh::{MeshConstants, block_indices};
use super::parameters::Parameters;
use super::quadtree::PATCH_SIDE;
use super::scene::{DeviceScene, Map};
use super::select::{Select, Selected};
use super::selection::Patch;
use super::stage::Build;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, DepthTest, Error, Frame, Load, Pass};

/// Indices of a patch.
const INDICES: u32 = 6 * PATCH_SIDE * PATCH_SIDE;

/// The pass on each map, behind the choice of its patches.
pub struct MeshLod {
    select: Select,
    passes: Vec<Pass>,
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
        let select = Select::new(build, grounds, scene)?;
        let pass = |(map, Selected { patches, .. }): (&Map, &Selected)| {
            Pass::graphics("mesh-lod", "4", "terrain/mesh-lod.vert", "terrain/mesh.frag")
                .with("terrain", &map.terrain)
                .with("levels", &map.levels.view)
                .instances::<Patch>(patches)
                .indices(&indices)
                .constants::<MeshConstants>()
                .color(&base.target, Load::Keep, Blend::Replace)
                .depth(&base.tested, Load::Keep, DepthTest::GreaterWrite)
                .build(shaders)
        };
        let passes = scene.maps.iter().zip(&select.maps).map(pass).collect::<Result<_, _>>()?;
        Ok(MeshLod { select, passes })
    }

    /// Patches of the last frame, by level from the maps' own cells on.
    pub fn by_level(&self) -> Vec<u64> {
        let mut counts = Vec::new();
        for of_map in self.select.maps.iter().map(|map| map.selection.by_level()) {
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
        self.select.record(frame, grounds, view, parameters)?;
        for ((pass, Selected { selection, .. }), ground) in self.passes.iter().zip(&self.select.maps).zip(grounds) {
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
