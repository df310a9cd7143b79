//! Sources of the densities of the volumes: functions or files, or the table of their values; and the places at which they
//! are asked for: all, or those where there are some.

use super::bricks::Bricks;
use super::context::Context;
use super::density_cache::DensityCache;
use super::parameters::Variant;
use super::scene_buffers::SceneBuffers;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Error, Frame};

/// The passes that come before the first density is asked for.
pub struct Densities {
    /// The table of values.
    pub cache: Option<DensityCache>,
    /// The bounds of the density.
    pub bricks: Option<Bricks>,
}

impl Densities {
    /// # Errors
    /// [`Error::Limit`] for tables beyond what the device binds.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, variant: Variant) -> Result<Self, Error> {
        let cached = context.parameters.density_cache;
        let cache = cached.map(|size| DensityCache::new(context, scene, size)).transpose()?;
        let lost = context.parameters.brick_depth(variant);
        let bricks = lost.map(|depth| Bricks::new(context, scene, cache.as_ref(), depth)).transpose()?;
        Ok(Densities { cache, bricks })
    }

    /// A pass with what its shader takes densities from.
    pub fn values(&self, scene: &SceneBuffers, pass: PassBuilder) -> PassBuilder {
        match &self.cache {
            Some(cache) => pass.with("DensityCache", &cache.densities),
            None => scene.densities(pass),
        }
    }

    /// The same for rays, which may skip bricks.
    pub fn of_rays(&self, scene: &SceneBuffers, pass: PassBuilder) -> PassBuilder {
        let pass = self.values(scene, pass);
        match &self.bricks {
            Some(bricks) => pass.with("Bricks", &bricks.bounds),
            None => pass,
        }
    }

    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.cache.iter().try_for_each(|cache| cache.record(frame))?;
        self.bricks.iter().try_for_each(|bricks| bricks.record(frame))
    }
}
