//! `lava`: E. O. Unnthorsson's lava surfaces from particles, chapters 4 to 8.
//!
//! ```text
//! animate ─► read-positions ─► cluster ─┐                                         (stage one, chapter 5)
//!   ┌───────────────────────────────────┘
//!   └─► for each cluster: density ─► read-density ─► extract ─┐                   (stage two, chapter 6)
//!         ┌───────────────────────────────────────────────────┘
//!         └─► accumulate-depths ─► normal-height ─┐
//!   ┌─────────────────────────────────────────────┘
//!   └─► visibility ─► blending ─► normalisation                                   (stage three, chapter 7)
//! ```
//!
//! Where there are polygon objects, `objects` draws them into the picture after the thesis's last pass.

mod animation;
mod clusters;
pub mod experiments;
mod floors;
mod isosurface;
#[cfg(test)]
mod layouts;
mod objects;
pub mod parameters;
mod particles;
mod pattern;
mod points;
pub mod reference;
mod rock;
pub mod setup;
mod splatting;
mod targets;

use std::sync::Arc;

use self::objects::Objects;
use self::points::Points;
use crate::gpu::{Error, Feature, Frame, ImageView, ShaderLibrary};
use crate::measure::{Paper, Target};
use crate::scene::Mesh;

pub use self::animation::Animation;
pub use self::clusters::{Clusters, Point};
pub use self::floors::FLOORS;
pub use self::isosurface::Isosurface;
pub use self::parameters::{CAMERAS, Parameters, Preset, Shading, Variant};
pub use self::particles::Particles;
pub use self::rock::Rock;
pub use self::splatting::{Splatting, depth_range_m};

/// What a device must have for this paper, beyond the baseline of the Vulkan layer. Without a geometry stage the splats
/// are instanced quads, and [`Paper::warnings`] says so.
pub const NEEDS: [Feature; 2] = [Feature::BlendRgba32Float, Feature::LargePoints];

/// The paper with its resources.
pub struct Lava {
    parameters: Parameters,
    animation: Animation,
    isosurface: Isosurface,
    splatting: Splatting,
    objects: Option<Objects>,
    /// Where the picture shows particles instead of the surface.
    points: Option<Points>,
    lacks_geometry_stage: bool,
}

impl Lava {
    /// Makes every resource and pass; `label` goes before the names of the resources. `objects` are valid meshes in the
    /// simulation space, metres.
    ///
    /// # Errors
    /// What the Vulkan layer answers. The caller has validated `parameters` and `rock`; there is at least one particle.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        particles: &Particles,
        rock: &Rock,
        objects: &[Mesh],
    ) -> Result<Self, Error> {
        let has_geometry_stage = shaders.device().physical().has(Feature::GeometryShader);
        let instanced = !(parameters.geometry_stage && has_geometry_stage);
        let animation = Animation::new(shaders, label, parameters, particles)?;
        let isosurface = Isosurface::new(shaders, label, parameters, animation.vertices(), instanced)?;
        let splatting = Splatting::new(shaders, label, parameters, isosurface.normal_height(), rock, instanced)?;
        let objects = match objects {
            [] => None,
            meshes => Some(Objects::new(shaders, label, parameters, meshes, &splatting)?),
        };
        let points = (parameters.shading == Shading::Particles)
            .then(|| Points::new(shaders, &animation, &splatting))
            .transpose()?;
        let lacks_geometry_stage = parameters.geometry_stage && !has_geometry_stage;
        Ok(Lava {
            parameters: parameters.clone(),
            animation,
            isosurface,
            splatting,
            objects,
            points,
            lacks_geometry_stage,
        })
    }

    /// Draws the points and splats of the last frame with an empty fragment stage, as the passes of [`FLOORS`]: what their
    /// vertices and primitives cost alone. It changes no texture.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record_floors(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.isosurface.record_floors(frame, self.animation.clusters())?;
        self.splatting.record_floor(frame)
    }

    /// Stage one.
    pub fn animation(&self) -> &Animation {
        &self.animation
    }

    /// Stage two.
    pub fn isosurface(&self) -> &Isosurface {
        &self.isosurface
    }

    /// Stage three.
    pub fn splatting(&self) -> &Splatting {
        &self.splatting
    }

    /// How far the rock has drifted in frame `number`: as far as the mean particle.
    fn drift_m(&self, number: u32) -> f32 {
        let time_s = f64::from(number) * f64::from(self.parameters.time_step_s);
        let drift_m = time_s * f64::from(self.parameters.speed_m_s);
        // Whole tiles change nothing and would cost precision.
        (drift_m % f64::from(self.parameters.rock_tile_m)) as f32
    }
}

impl Paper for Lava {
    fn restart(&mut self) -> Result<(), Error> {
        self.animation.restart();
        Ok(())
    }

    /// Frame `number` shows the particles after `number` + 1 steps. Steps that were not recorded are caught up, so that
    /// the picture depends on the number alone.
    ///
    /// # Errors
    /// What the Vulkan layer answers; [`Error::Pass`] for a frame before the last without a restart between them.
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        let steps = self.animation.steps();
        if number < steps {
            let problem = format!("frame {number} comes before frame {steps}, the next; restart the paper first");
            return Err(Error::Pass { pass: "animate".into(), problem });
        }
        for _ in steps..number {
            self.animation.animate(frame)?;
        }
        self.animation.record(frame)?;
        self.isosurface.record(frame, self.animation.clusters())?;
        self.splatting.record(frame, self.drift_m(number))?;
        self.objects.as_ref().map_or(Ok(()), |objects| objects.record(frame))
    }

    /// The thesis's last pass is the picture, but where it shows particles.
    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)?;
        match &self.points {
            Some(points) => points.record(frame, &self.animation),
            None => Ok(()),
        }
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.lacks_geometry_stage {
            warnings.push(
                "the device has no geometry stage: the splats are instanced quads, so times of `accumulate-depths`, \
                 `visibility` and `blending` are not the thesis's method's"
                    .to_owned(),
            );
        }
        if self.animation.steps() > 0 && self.isosurface.accepted().is_empty() {
            let [lowest, highest] = self.isosurface.density_range();
            warnings.push(format!(
                "no grid point was accepted, so the surface is flat: --rho is {} and the densities are {lowest} to \
                 {highest}",
                self.parameters.rho()
            ));
        }
        warnings
    }

    fn picture(&self) -> &Arc<ImageView> {
        self.splatting.picture()
    }

    fn targets(&self) -> Vec<Target> {
        let (positions, velocities) = self.animation.state();
        vec![
            Target::image("positions", positions),
            Target::image("velocities", velocities),
            Target::image("density", self.isosurface.density()),
            Target::image("accumulated-depths", self.isosurface.accumulated_depths()),
            Target::image("normal-height", self.isosurface.normal_height()),
            Target::image("visibility", self.splatting.visibility()),
            Target::image("accumulated-colors", self.splatting.accumulated_colors()),
            Target::image("picture", self.splatting.picture()),
        ]
    }
}
