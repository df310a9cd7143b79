//! `froxel-inject`: extinction and light of the gas in each cell of the view frustum, a froxel (ours; B. Wronski, 2014).

use std::sync::Arc;

use super::a_buffer::ABuffer;
use super::context::Context;
use super::densities::Densities;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Buffer, Error, Frame, ImageView, Pass};

/// The pass `froxel-inject`.
pub struct FroxelInject {
    /// Light that an element sends to the eye times its extinction, linear RGB, and the extinction, both per metre.
    pub light: Arc<ImageView>,
    pass: Pass,
    size: [u32; 3],
}

impl FroxelInject {
    /// With the shadows of a table.
    ///
    /// # Errors
    /// [`Error::Limit`] for froxels beyond what the device holds.
    pub fn new(
        context: &Context<'_>,
        scene: &SceneBuffers,
        lists: &ABuffer,
        densities: &Densities,
        shadow_sums: &Arc<Buffer>,
    ) -> Result<Self, Error> {
        let light = context.froxels("froxel-light")?;
        let shader = format!("gas/froxel-inject-{}.comp", context.parameters.density_shader());
        let pass = Pass::compute("froxel-inject", "Illumination", &shader)
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("Volumes", &scene.volumes)
            .with("Lights", &scene.lights)
            .with("ShadowTables", shadow_sums)
            .with("Unfinished", &lists.progress.unfinished)
            .with("froxel_light", &light);
        let pass = scene.glow(context.parameters, densities.values(scene, pass)).build(context.shaders)?;
        Ok(FroxelInject { light, pass, size: context.parameters.froxels })
    }

    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let [columns, rows, slices] = self.size;
        frame.compute(&self.pass, |dispatch| dispatch.threads(columns, rows, slices))
    }
}
