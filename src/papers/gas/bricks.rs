//! `bricks`: the greatest density of each brick of the boxes around the volumes, so that rays skip what is empty.

use std::sync::Arc;

use super::context::Context;
use super::density_cache::DensityCache;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Buffer, Error, Frame, Pass};
use crate::host_block;

host_block! {
    struct BrickConstants {
        /// Index of the volume.
        volume: u32,
        /// The optical depth that a ray through the volume may lose in bricks that are skipped.
        lost_depth: f32,
    }
}

/// The pass `bricks`.
pub struct Bricks {
    /// Bounds of the density, 0 where it is skipped: a table a volume, x fastest.
    pub bounds: Arc<Buffer>,
    /// Bricks along each axis.
    pub size: u32,
    pass: Pass,
    lost_depth: f32,
    volume_count: u32,
}

impl Bricks {
    /// Of the densities in `cache`, or where there is none of the functions or files themselves.
    ///
    /// # Errors
    /// [`Error::Limit`] for bricks beyond what the device binds.
    pub fn new(
        context: &Context<'_>,
        scene: &SceneBuffers,
        cache: Option<&DensityCache>,
        lost_depth: f32,
    ) -> Result<Self, Error> {
        let (size, volume_count) = (context.parameters.bricks, context.parameters.volumes.len() as u32);
        let count = u64::from(size).pow(3) * u64::from(volume_count);
        let bounds = context.storage::<f32>("bricks", count).map_err(|error| error.set_by("bricks"))?;
        let shader = format!("gas/bricks-{}.comp", context.parameters.density_shader());
        let pass = Pass::compute("bricks", "Volume rendering", &shader)
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("Volumes", &scene.volumes)
            .with("Bricks", &bounds)
            .constants::<BrickConstants>();
        let pass = match cache {
            Some(cache) => pass.with("DensityCache", &cache.densities),
            None => scene.samples(pass),
        };
        Ok(Bricks { bounds, size, pass: pass.build(context.shaders)?, lost_depth, volume_count })
    }

    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.pass, |dispatch| {
            for volume in 0..self.volume_count {
                let constants = BrickConstants { volume, lost_depth: self.lost_depth };
                dispatch.constants(&constants).threads(self.size, self.size, self.size);
            }
        })
    }
}
