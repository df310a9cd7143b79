//! `caustics`: N. Tipprasert's refractive water caustics with level maps, chapters 3 to 5.
//!
//! ```text
//! reference-planes ─► position-diffuse-map ──────────┐          (volumetric: slice-images;
//!                                                    │           smart: read-positions, depth-profile)
//! water-surface ─► illumination-volumes ─► caustics-map ─► combine ─► cast (─► view)
//!
//! receivers ───────────────────────────────────────┐            (stencil)
//! water-surface ─► illumination-volumes ─► stencil-volumes (─► view)
//! ```

mod cast;
pub mod experiments;
mod illumination;
#[cfg(test)]
mod layouts;
mod level_map;
mod maps;
mod method;
pub mod parameters;
mod planar;
mod planes;
mod receiver;
pub mod reference;
pub mod setup;
mod stencil;
mod view;
mod volumetric;
pub mod water;
mod water_map;

use std::sync::Arc;

use ash::vk;
use glam::{DVec2, DVec3};

use self::cast::Underwater;
use self::level_map::Slicing;
use self::planar::{Kind, Planar, Shared};
use self::planes::{Axes, ReceiverBox};
use self::receiver::Receiver;
use self::stencil::{DEPTH_STENCIL, Stencil};
use self::view::View;
use self::water::{Grid, Water};
use crate::gpu::{Error, Feature, Frame, ImageView, Sampler, ShaderLibrary};
use crate::measure::{Paper, Target};

pub use self::parameters::{Parameters, SmartParameters, SmartPlacement, Variant, WaveParameters};
pub use self::receiver::ReceiverInput;
pub use self::water_map::WaterMap;

/// What a device must have for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 3] = [Feature::BlendR32Float, Feature::BlendRgba16Float, Feature::DepthStencil32];

/// The paper under one variant.
pub struct Caustics {
    parameters: Parameters,
    water: Water,
    technique: Technique,
    underwater: Underwater,
    view: View,
}

enum Technique {
    Planar(Planar),
    Stencil(Stencil),
}

impl Caustics {
    /// Makes every resource and pass; `label` goes before the names of the resources.
    ///
    /// # Errors
    /// What the Vulkan layer answers. The caller has validated `parameters`, and every receiver has a vertex.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        inputs: &[ReceiverInput],
    ) -> Result<Self, Error> {
        let nearest = Sampler::new(shaders.device(), "nearest", vk::Filter::NEAREST)?;
        let receivers = inputs
            .iter()
            .map(|input| Receiver::new(shaders, label, input).map(Arc::new))
            .collect::<Result<Vec<_>, _>>()?;
        let center = world_center(&receivers);
        let index = f64::from(parameters.refraction_index);
        let axes: Vec<Axes> = parameters.lights.iter().map(|light| Axes::aligned_with(light, center, index)).collect();
        let boxes: Vec<_> = parameters
            .lights
            .iter()
            .zip(&axes)
            .flat_map(|(&light, &axes)| receivers.iter().map(move |r| (ReceiverBox::around(axes, &r.positions), light)))
            .collect();
        let middle = DVec2::new(center.x, center.z);
        let water = Water::new(shaders, label, Grid::over(&boxes, parameters), middle, parameters)?;
        let depth_format = if variant == Variant::Stencil { DEPTH_STENCIL } else { maps::DEPTH };
        let underwater = Underwater::new(shaders, label, depth_format, parameters)?;
        let view = View::new(shaders, label, &underwater, &water, &nearest, parameters)?;
        let shared = Shared {
            shaders,
            label,
            receivers: &receivers,
            axes: &axes,
            water: &water,
            underwater: &underwater,
            nearest: &nearest,
            parameters,
        };
        let planar = |kind| Planar::new(shared, kind).map(Technique::Planar);
        let technique = match variant {
            Variant::LevelMap => planar(Kind::LevelMap(Slicing::Normal))?,
            Variant::LevelMapSmart => planar(Kind::LevelMap(Slicing::Smart))?,
            Variant::Volumetric => planar(Kind::Volumetric)?,
            Variant::Stencil => Technique::Stencil(Stencil::new(shared)?),
        };
        Ok(Caustics { parameters: parameters.clone(), water, technique, underwater, view })
    }

    /// The mesh of the water as it was made, which may differ from the number of triangles asked for.
    pub fn grid(&self) -> Grid {
        self.water.grid
    }

    /// Draws the last frame's caustics maps with an empty fragment stage, as pass `caustics-map-floor`: what their
    /// vertices and rasterisation cost alone. It spoils the maps. The stencil method has none.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record_floor(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        match &self.technique {
            Technique::Planar(planar) => planar.record_floor(frame),
            Technique::Stencil(_) => Ok(()),
        }
    }

    /// Texels in each depth level of the first receiver under the first light, after a frame of smart slicing.
    pub fn depth_profile(&self) -> Option<&[u32]> {
        match &self.technique {
            Technique::Planar(planar) => planar.depth_profile(),
            Technique::Stencil(_) => None,
        }
    }

    /// The planes of each receiver under each light, as the last recorded frame placed them; none for the stencil method.
    pub fn plane_counts(&self) -> Vec<usize> {
        match &self.technique {
            Technique::Planar(planar) => planar.plane_counts(),
            Technique::Stencil(_) => Vec::new(),
        }
    }

    fn time_s(&self, number: u32) -> f64 {
        f64::from(number) * f64::from(self.parameters.time_step_s)
    }
}

fn world_center(receivers: &[Arc<Receiver>]) -> DVec3 {
    let points = receivers.iter().flat_map(|r| r.positions.iter().copied());
    crate::scene::Bounds::of_points(points).center().as_dvec3()
}

impl Paper for Caustics {
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        let time_s = self.time_s(number);
        match &mut self.technique {
            Technique::Planar(planar) => planar.record(frame, &self.water, time_s),
            Technique::Stencil(stencil) => stencil.record(frame, &self.water, time_s),
        }
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)?;
        self.view.draw(frame, self.time_s(number))
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.view.picture
    }

    fn targets(&self) -> Vec<Target> {
        let mut targets = vec![Target::table("water", &self.water.vertices, water::VERTEX_FLOATS)];
        targets.extend(match &self.technique {
            Technique::Planar(planar) => planar.targets(),
            Technique::Stencil(stencil) => stencil.targets(),
        });
        targets.push(Target::image("underwater-color", &self.underwater.color));
        targets.push(Target::image("underwater-depth", &self.underwater.fetched_depth));
        targets.push(Target::image("picture", &self.view.picture));
        targets
    }
}
