//! `caustics`: N. Tipprasert's refractive water caustics with level maps, chapters 4 and 5.
//!
//! ```text
//! reference-planes ─► position-diffuse-map ─────────┐            (volumetric: slice-images;
//!                                                    │             smart: read-positions, depth-profile)
//! water-surface ─► illumination-volumes ─► caustics-map ─► combine ─► cast (─► view)
//! ```

mod cast;
mod illumination;
mod level_map;
mod maps;
mod method;
pub mod parameters;
mod planes;
mod receiver;
pub mod reference;
mod view;
mod volumetric;
pub mod water;

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use self::cast::{Cast, Place, Underwater};
use self::illumination::IlluminationVolumes;
use self::level_map::{LevelMap, Slicing};
use self::method::Method;
use self::planes::{Axes, ReceiverBox};
use self::receiver::{LitReceiver, Receiver};
use self::view::View;
use self::volumetric::Volumetric;
use self::water::{Grid, Water};
use super::{Paper, Target};
use crate::gpu::{Error, Feature, Frame, ImageView, PassInfo, Sampler, ShaderLibrary};

pub use self::parameters::{ParameterError, Parameters, SmartParameters, SmartPlacement, Variant, WaveParameters};
pub use self::receiver::ReceiverInput;

/// What a device must have for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 2] = [Feature::BlendR32Float, Feature::BlendRgba16Float];

/// The paper under one variant.
pub struct Caustics {
    parameters: Parameters,
    place_planes: Arc<PassInfo>,
    water: Water,
    lights: Vec<LightPasses>,
    underwater: Underwater,
    view: View,
}

/// What belongs to one light.
struct LightPasses {
    volumes: IlluminationVolumes,
    receivers: Vec<ReceiverPasses>,
}

/// What belongs to one receiver under one light.
struct ReceiverPasses {
    lit: LitReceiver,
    method: Box<dyn Method>,
    cast: Cast,
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
        let underwater = Underwater::new(shaders, label, parameters)?;
        let center = world_center(&receivers);
        let index = f64::from(parameters.refraction_index);
        let all_axes: Vec<Axes> =
            parameters.lights.iter().map(|light| Axes::aligned_with(light, center, index)).collect();
        let boxes: Vec<_> = parameters
            .lights
            .iter()
            .zip(&all_axes)
            .flat_map(|(&light, &axes)| receivers.iter().map(move |r| (ReceiverBox::around(axes, &r.positions), light)))
            .collect();
        let water = Water::new(shaders, label, Grid::over(&boxes, parameters), parameters)?;

        let mut lights = Vec::new();
        for (light_index, (light, &axes)) in parameters.lights.iter().zip(&all_axes).enumerate() {
            let volumes = IlluminationVolumes::new(shaders, label, &water, light, &axes, parameters)?;
            let mut passes = Vec::new();
            for (receiver_index, receiver) in receivers.iter().enumerate() {
                let lit = LitReceiver::new(receiver, axes, light, parameters);
                let method: Box<dyn Method> = match variant {
                    Variant::LevelMap | Variant::LevelMapSmart => {
                        let slicing = if variant == Variant::LevelMap { Slicing::Normal } else { Slicing::Smart };
                        let map = LevelMap::new(shaders, label, &lit, &water, &volumes, &nearest, slicing, parameters)?;
                        Box::new(map)
                    }
                    Variant::Volumetric => {
                        Box::new(Volumetric::new(shaders, label, &lit, &water, &volumes, &nearest, parameters)?)
                    }
                };
                let place = Place { light: light_index, receiver: receiver_index };
                let cast = Cast::new(shaders, &underwater, &lit, method.as_ref(), &nearest, place, parameters)?;
                passes.push(ReceiverPasses { lit, method, cast });
            }
            lights.push(LightPasses { volumes, receivers: passes });
        }
        let planes_pass = match variant {
            Variant::LevelMap => "reference-planes",
            // The planes themselves wait for the depth profile.
            Variant::LevelMapSmart => "bounding-box",
            Variant::Volumetric => "sample-planes",
        };
        Ok(Caustics {
            parameters: parameters.clone(),
            place_planes: PassInfo::host(planes_pass, "4.2.1", &["receiver"], &["planes"]),
            view: View::new(shaders, label, &underwater, &water, &nearest, parameters)?,
            underwater,
            water,
            lights,
        })
    }

    /// The mesh of the water as it was made, which may differ from the number of triangles asked for.
    pub fn grid(&self) -> Grid {
        self.water.grid
    }

    /// Draws the last frame's caustics maps with an empty fragment stage, as pass `caustics-map-floor`: what their
    /// vertices and rasterisation cost alone. It spoils the maps.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record_floor(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        for light in &self.lights {
            for one in &light.receivers {
                one.method.draw_floor(frame, &one.lit, &light.volumes)?;
            }
        }
        Ok(())
    }

    /// Texels in each depth level of the first receiver under the first light, after a frame of smart slicing.
    pub fn depth_profile(&self) -> Option<&[u32]> {
        self.lights.first()?.receivers.first()?.method.depth_profile()
    }

    fn time_s(&self, number: u32) -> f64 {
        f64::from(number) * f64::from(self.parameters.time_step_s)
    }

    /// The planes of each receiver under each light, as the last recorded frame placed them.
    pub fn plane_counts(&self) -> Vec<usize> {
        self.lights.iter().flat_map(|light| &light.receivers).map(|one| one.lit.cells.len()).collect()
    }
}

fn world_center(receivers: &[Arc<Receiver>]) -> DVec3 {
    let points = receivers.iter().flat_map(|r| r.positions.iter().copied());
    crate::scene::Bounds::of_points(points).center().as_dvec3()
}

impl Paper for Caustics {
    /// Figures 4-15 and 4-17: for each light, the planes, the receivers' maps, the illumination volumes, the caustics
    /// maps plane by plane, their combination; then everything is cast.
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        let time_s = self.time_s(number);
        let planes = self.parameters.planes;
        frame.host(&self.place_planes, || {
            let lit = self.lights.iter_mut().flat_map(|light| &mut light.receivers);
            lit.for_each(|one| one.lit.slice(planes));
        });
        for one in self.lights.iter().flat_map(|light| &light.receivers) {
            one.method.create_maps(frame, &one.lit)?;
        }
        for one in self.lights.iter_mut().flat_map(|light| &mut light.receivers) {
            one.method.refine_planes(frame, &mut one.lit)?;
        }
        self.water.animate(frame, time_s)?;
        for light in &self.lights {
            light.volumes.refract(frame)?;
            for one in &light.receivers {
                one.method.create_caustics(frame, &one.lit, &light.volumes)?;
            }
            for one in &light.receivers {
                one.method.combine(frame, &one.lit)?;
            }
        }
        for one in self.lights.iter().flat_map(|light| &light.receivers) {
            one.cast.draw(frame, &one.lit, one.method.as_ref())?;
        }
        Ok(())
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
        for (l, light) in self.lights.iter().enumerate() {
            let name = numbered("illumination-volumes", &[l]);
            targets.push(Target::table(name, &light.volumes.rays, illumination::RAY_FLOATS));
            for (r, one) in light.receivers.iter().enumerate() {
                let named = one.method.targets().into_iter();
                targets.extend(named.map(|(name, view)| Target::image(numbered(name, &[l, r]), view)));
            }
        }
        targets.push(Target::image("underwater-color", &self.underwater.color));
        targets.push(Target::image("underwater-depth", &self.underwater.depth));
        targets.push(Target::image("picture", &self.view.picture));
        targets
    }
}

/// A target's name, with the indices of its light and receiver when one of them is not the first.
fn numbered(name: &str, indices: &[usize]) -> String {
    if indices.iter().all(|&i| i == 0) {
        return name.to_owned();
    }
    let indices: Vec<String> = indices.iter().map(usize::to_string).collect();
    format!("{name}.{}", indices.join("."))
}
