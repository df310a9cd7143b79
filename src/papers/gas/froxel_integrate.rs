//! `froxel-integrate`: light and transparency of the gas before each froxel's far border (ours; B. Wronski, 2014).

use std::sync::Arc;

use super::context::Context;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Error, Frame, ImageView, Pass};

/// The pass `froxel-integrate`.
pub struct FroxelIntegrate {
    /// Light of all gas before a froxel's far border, linear RGB, and its transparency.
    pub sums: Arc<ImageView>,
    pass: Pass,
    size: [u32; 3],
}

impl FroxelIntegrate {
    /// Of the light of each froxel.
    ///
    /// # Errors
    /// [`Error::Limit`] for froxels beyond what the device holds.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, light: &Arc<ImageView>) -> Result<Self, Error> {
        let sums = context.froxels("froxel-sums")?;
        let pass = Pass::compute("froxel-integrate", "Volume rendering", "gas/froxel-integrate.comp")
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("froxel_light", light)
            .with("froxel_sums", &sums)
            .build(context.shaders)?;
        Ok(FroxelIntegrate { sums, pass, size: context.parameters.froxels })
    }

    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let [columns, rows, _] = self.size;
        frame.compute(&self.pass, |dispatch| dispatch.threads(columns, rows, 1))
    }
}
