//! The methods that intersect the illumination volumes with planes: the level map and the volumetric method, for every
//! light and every receiver (figures 4-15 and 4-17).

use std::sync::Arc;

use super::cast::{Cast, Place, Underwater};
use super::illumination::IlluminationVolumes;
use super::level_map::{LevelMap, Slicing};
use super::method::{Method, Site};
use super::parameters::Parameters;
use super::planes::Axes;
use super::receiver::{LitReceiver, Receiver};
use super::volumetric::Volumetric;
use super::water::Water;
use super::{Target, illumination};
use crate::gpu::{Error, Frame, PassInfo, Sampler, ShaderLibrary};

/// Which of the methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    LevelMap(Slicing),
    Volumetric,
}

impl Kind {
    /// The thesis's name for what the host does first.
    fn planes_pass(self) -> &'static str {
        match self {
            Kind::LevelMap(Slicing::Normal) => "reference-planes",
            // The planes themselves wait for the depth profile.
            Kind::LevelMap(Slicing::Smart) => "bounding-box",
            Kind::Volumetric => "sample-planes",
        }
    }
}

/// A method with everything that it draws.
pub struct Planar {
    place_planes: Arc<PassInfo>,
    planes: u32,
    lights: Vec<LightPasses>,
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

/// What all lights and receivers share.
#[derive(Clone, Copy)]
pub struct Shared<'a> {
    pub shaders: &'a ShaderLibrary,
    pub label: &'a str,
    pub receivers: &'a [Arc<Receiver>],
    /// One for each light.
    pub axes: &'a [Axes],
    pub water: &'a Water,
    pub underwater: &'a Underwater,
    pub nearest: &'a Arc<Sampler>,
    pub parameters: &'a Parameters,
}

impl Planar {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shared: Shared<'_>, kind: Kind) -> Result<Self, Error> {
        let Shared { shaders, label, receivers, axes, water, underwater, nearest, parameters } = shared;
        let mut lights = Vec::new();
        for (light_index, (light, &axes)) in parameters.lights.iter().zip(axes).enumerate() {
            let volumes = IlluminationVolumes::new(shaders, label, water, light, &axes, parameters)?;
            let mut passes = Vec::new();
            for (receiver_index, receiver) in receivers.iter().enumerate() {
                let lit = LitReceiver::new(receiver, axes, light, parameters);
                let site = Site { shaders, label, lit: &lit, water, volumes: &volumes, nearest, parameters };
                let method: Box<dyn Method> = match kind {
                    Kind::LevelMap(slicing) => Box::new(LevelMap::new(site, slicing)?),
                    Kind::Volumetric => Box::new(Volumetric::new(site)?),
                };
                let place = Place { light: light_index, receiver: receiver_index };
                let cast = Cast::new(site, underwater, method.as_ref(), place)?;
                passes.push(ReceiverPasses { lit, method, cast });
            }
            lights.push(LightPasses { volumes, receivers: passes });
        }
        Ok(Planar {
            place_planes: PassInfo::host(kind.planes_pass(), "4.2.1", &["receiver"], &["planes"]),
            planes: parameters.planes,
            lights,
        })
    }

    fn each(&self) -> impl Iterator<Item = &ReceiverPasses> {
        self.lights.iter().flat_map(|light| &light.receivers)
    }

    /// Figures 4-15 and 4-17: the planes, the receivers' maps, the illumination volumes, the caustics maps plane by plane,
    /// their combination; then everything is cast.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&mut self, frame: &mut Frame<'_>, water: &Water, time_s: f64) -> Result<(), Error> {
        let planes = self.planes;
        frame.host(&self.place_planes, || {
            let each = self.lights.iter_mut().flat_map(|light| &mut light.receivers);
            each.for_each(|one| one.lit.slice(planes));
        });
        for one in self.each() {
            one.method.create_maps(frame, &one.lit)?;
        }
        for one in self.lights.iter_mut().flat_map(|light| &mut light.receivers) {
            one.method.refine_planes(frame, &mut one.lit)?;
        }
        water.animate(frame, time_s)?;
        for light in &self.lights {
            light.volumes.refract(frame)?;
            for one in &light.receivers {
                one.method.create_caustics(frame, &one.lit, &light.volumes)?;
            }
            for one in &light.receivers {
                one.method.combine(frame, &one.lit)?;
            }
        }
        for one in self.each() {
            one.cast.draw(frame, &one.lit, one.method.as_ref())?;
        }
        Ok(())
    }

    /// Draws the last frame's caustics maps with an empty fragment stage.
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

    /// The planes of each receiver under each light, as the last frame placed them.
    pub fn plane_counts(&self) -> Vec<usize> {
        self.each().map(|one| one.lit.cells.len()).collect()
    }

    /// Texels in each depth level of the first receiver under the first light.
    pub fn depth_profile(&self) -> Option<&[u32]> {
        self.each().next()?.method.depth_profile()
    }

    pub fn targets(&self) -> Vec<Target> {
        let mut targets = Vec::new();
        for (l, light) in self.lights.iter().enumerate() {
            let name = numbered("illumination-volumes", &[l]);
            targets.push(Target::table(name, &light.volumes.rays, illumination::RAY_FLOATS));
            for (r, one) in light.receivers.iter().enumerate() {
                let named = one.method.targets().into_iter();
                targets.extend(named.map(|(name, view)| Target::image(numbered(name, &[l, r]), view)));
            }
        }
        targets
    }
}

/// A target's name, with the indices of its light and receiver when one of them is not the first.
pub fn numbered(name: &str, indices: &[usize]) -> String {
    if indices.iter().all(|&i| i == 0) {
        return name.to_owned();
    }
    let indices: Vec<String> = indices.iter().map(usize::to_string).collect();
    format!("{name}.{}", indices.join("."))
}
