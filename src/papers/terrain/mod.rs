//! `terrain`: S. I. Vyatkin's terrain from a shape texture, ray-cast without triangles.
//!
//! ```text
//! geometric-transformation (host) ─► depth ─► normal ─► illumination
//! ```

mod blocks;
mod hit;
mod levels;
mod parameters;
mod placement;
mod pyramid;
mod ray_cast;
pub mod reference;
mod scene;

use std::sync::Arc;

pub use self::hit::{Hit, NO_DEPTH, Surface};
pub use self::levels::Levels;
pub use self::parameters::{Base, Interpolation, Lod, Parameters, Sun, Variant, View};
pub use self::placement::{Extent, Ground, Placement, Rays};
pub use self::pyramid::{Bound, Pyramid, Shape, Texel};
use self::ray_cast::{RayCast, Stage};
pub use self::scene::MapInput;
use self::scene::Scene;
use super::{Paper, Target};
use crate::gpu::{Error, Feature, Frame, ImageView, PassInfo, ShaderLibrary};

/// What a device must have for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 0] = [];

/// The paper under one variant.
pub struct Terrain {
    parameters: Parameters,
    scene: Scene,
    transformation: Arc<PassInfo>,
    ray_cast: RayCast,
}

impl Terrain {
    /// Makes every resource and pass, and the maps' pyramids; `label` goes before the names of the resources.
    ///
    /// # Errors
    /// What the Vulkan layer answers. The caller has validated `parameters`, and there is a map.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        maps: &[MapInput],
    ) -> Result<Self, Error> {
        let scene = Scene::new(shaders, label, parameters, maps)?;
        let stage = match variant {
            Variant::GpuFragment => Stage::Fragment,
            _ => Stage::Compute,
        };
        let ray_cast = RayCast::new(shaders, label, stage, parameters, &scene)?;
        let reads = ["camera", "placement"];
        let transformation = PassInfo::host("geometric-transformation", "3, eq. 10", &reads, &["land", "light"]);
        Ok(Terrain { parameters: parameters.clone(), scene, transformation, ray_cast })
    }
}

impl Paper for Terrain {
    fn record(&mut self, frame: &mut Frame<'_>, _number: u32) -> Result<(), Error> {
        frame.host(&self.transformation, || self.scene.transform(&self.parameters))?;
        self.ray_cast.record(frame)
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.ray_cast.picture
    }

    fn targets(&self) -> Vec<Target> {
        let mut targets = self.ray_cast.targets();
        targets.push(Target::image("picture", &self.ray_cast.picture));
        targets
    }
}
