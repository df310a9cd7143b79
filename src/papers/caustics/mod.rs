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

mod axes;
mod bounding_box;
mod cast;
mod caustics_map;
mod ceilings;
mod combine;
mod combine_slices;
mod coverage;
mod culled_map;
mod depth_profile;
mod diffuse_map;
mod estimate;
pub mod experiments;
mod hidden_surfaces;
mod hit_map;
mod illumination_volumes;
mod intersections;
mod landing;
#[cfg(test)]
mod layouts;
mod level_map;
mod lit_picture;
mod multiply;
mod named_mesh;
pub mod parameters;
mod planes;
mod position_diffuse_map;
mod position_map;
mod position_pyramid;
mod read_positions;
mod receiver;
mod receivers;
pub mod reference;
mod reference_planes;
mod resources;
mod results;
mod sample_planes;
pub mod setup;
mod shadow_map;
mod slice_images;
mod smart_planes;
mod stencil_volumes;
mod underwater;
mod view;
mod volumetric;
mod warnings;
pub mod water;
mod water_map;
mod water_surface;

use std::slice;
use std::sync::Arc;

use ash::vk;
use glam::DVec2;

use self::bounding_box::Axes;
use self::culled_map::CELL_FLOATS;
use self::hidden_surfaces::HiddenSurfaces;
use self::hit_map::LANDING_FLOATS;
use self::illumination_volumes::{IlluminationVolumes, RAY_FLOATS};
use self::intersections::Intersections;
use self::level_map::{LevelMap, ReceiverMaps, ReceiverPasses, Slicing, SmartSlicing};
use self::receiver::{LitReceiver, Receiver};
use self::receivers::Receivers;
use self::resources::{Context, DEPTH, DEPTH_STENCIL};
use self::shadow_map::ShadowMap;
use self::stencil_volumes::StencilVolumes;
use self::underwater::Underwater;
use self::view::View;
use self::volumetric::Volumetric;
use self::water::Grid;
use self::water_surface::{VERTEX_FLOATS, WaterSurface};
use crate::gpu::{Device, Error, Feature, Frame, ImageView, Sampler, ShaderLibrary};
use crate::measure::parameter::Given;
use crate::measure::{Paper, Target};
use crate::scene::{Bounds, Camera};

pub use self::parameters::{
    CullSteps, IntensityRule, Parameters, SmartParameters, SmartPlacement, Variant, WaveParameters,
};
pub use self::receiver::ReceiverInput;
pub use self::water_map::WaterMap;

/// Features that a device must have for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 3] = [Feature::BlendR32Float, Feature::BlendRgba16Float, Feature::DepthStencil32];

/// Parameters of the viewer and the clock alone, as constants.
pub const DRAWN: [&str; 5] = ["absorption", "camera", "fresnel", "samples", "time-step"];

/// The paper under one variant.
pub struct Caustics {
    parameters: Parameters,
    variant: Variant,
    /// Names of the parameters that a user gave.
    given: Given,
    water_surface: WaterSurface,
    /// One for each light.
    illumination_volumes: Vec<IlluminationVolumes>,
    /// Each receiver under each light, light by light; none for the stencil method.
    lit_receivers: Vec<LitReceiver>,
    /// One for each light where receivers cast shadows on one another, else none.
    shadow_maps: Vec<ShadowMap>,
    technique: Technique,
    underwater: Underwater,
    view: View,
    /// `view` was recorded since the last look at it.
    is_viewed: bool,
}

/// Passes that the variants do not share.
enum Technique {
    LevelMap(LevelMap),
    Volumetric(Volumetric),
    Stencil {
        receivers: Receivers,
        /// One for each light.
        stencil_volumes: Vec<StencilVolumes>,
    },
}

impl Caustics {
    /// Makes every resource and pass; `label` goes before the names of the resources.
    ///
    /// # Errors
    /// Errors of the Vulkan layer. The caller has validated `parameters`, and every receiver has a vertex.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        inputs: &[ReceiverInput],
    ) -> Result<Self, Error> {
        let nearest = Sampler::new(shaders.device(), "nearest", vk::Filter::NEAREST)?;
        let context = Context { shaders, label, parameters, nearest: &nearest };
        let receivers =
            inputs.iter().map(|input| Receiver::new(context, input).map(Arc::new)).collect::<Result<Vec<_>, _>>()?;
        let bounds = world_bounds(&receivers);
        let center = bounds.center().as_dvec3();
        let index = f64::from(parameters.refraction_index);
        let axes: Vec<Axes> = parameters.lights.iter().map(|light| Axes::aligned_with(light, center, index)).collect();
        let mut lit_receivers: Vec<LitReceiver> = (0..axes.len())
            .flat_map(|light| receivers.iter().enumerate().map(move |(index, receiver)| (light, index, receiver)))
            .map(|(light, index, receiver)| LitReceiver::new(receiver, index, light, axes[light], parameters))
            .collect();
        if variant == Variant::Culled && parameters.culled_smart {
            // Smart slicing takes no fewer for what is far away.
            lit_receivers.iter_mut().for_each(|lit| lit.planes = parameters.planes);
        }
        let boxes: Vec<_> = lit_receivers.iter().map(|lit| (lit.aligned, parameters.lights[lit.light])).collect();
        let middle = DVec2::new(center.x, center.z);
        let mut grid = Grid::over(&boxes, parameters);
        if variant == Variant::Hit {
            grid = grid.refined(&boxes, parameters);
        }
        let water_surface = WaterSurface::new(context, grid, middle)?;
        let lights = parameters.lights.iter().zip(axes);
        let illumination_volumes = lights
            .map(|(light, axes)| IlluminationVolumes::new(context, &water_surface, light, axes))
            .collect::<Result<Vec<_>, _>>()?;
        let depth_format = if variant == Variant::Stencil { DEPTH_STENCIL } else { DEPTH };
        let underwater = Underwater::new(context, depth_format, bounds)?;
        let view = View::new(context, &underwater, &water_surface, inputs)?;
        let (water, volumes) = (&water_surface, &illumination_volumes);
        // The stencil method knows no occlusion.
        let shadowed = if parameters.shadows && variant != Variant::Stencil { parameters.lights.len() } else { 0 };
        let shadow_maps = (0..shadowed).filter_map(|light| ShadowMap::new(context, &lit_receivers, light).transpose());
        let shadow_maps = shadow_maps.collect::<Result<Vec<_>, _>>()?;
        let technique = match variant {
            Variant::LevelMap | Variant::LevelMapSmart | Variant::Culled | Variant::Hit => Technique::LevelMap(
                LevelMap::new(context, variant, &lit_receivers, water, volumes, &shadow_maps, &underwater)?,
            ),
            Variant::Volumetric => Technique::Volumetric(Volumetric::new(
                context,
                &lit_receivers,
                water,
                volumes,
                &shadow_maps,
                &underwater,
            )?),
            Variant::Stencil => {
                lit_receivers.clear();
                let receivers = Receivers::new(context, &receivers, &underwater)?;
                let each = volumes.iter().map(|v| StencilVolumes::new(context, water, v, &receivers, &underwater));
                let stencil_volumes = each.collect::<Result<_, _>>()?;
                Technique::Stencil { receivers, stencil_volumes }
            }
        };
        let parameters = parameters.clone();
        Ok(Caustics {
            parameters,
            variant,
            given: Given::default(),
            water_surface,
            illumination_volumes,
            lit_receivers,
            shadow_maps,
            technique,
            underwater,
            view,
            is_viewed: false,
        })
    }

    /// The same, of parameters of which a user gave those: what the variant does not heed of them is warned of.
    pub fn given(mut self, given: Given) -> Self {
        self.given = given;
        self
    }

    /// Sets the numbers of [`DRAWN`] of the next frames; all others are those that it was made with. False where the camera
    /// passes through the water's surface, which other shaders show, or moves while planes go by its distance. The caller has validated them.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set_drawn(&mut self, parameters: &Parameters) -> Result<bool, Error> {
        if parameters.is_seen_from_above() != self.parameters.is_seen_from_above() {
            return Ok(false);
        }
        // Another distance from the camera may ask for other planes, for which there are other buffers.
        if parameters.planes_within_m.is_some() && parameters.camera != self.parameters.camera {
            return Ok(false);
        }
        self.underwater.set_camera(parameters)?;
        self.view.set_drawn(parameters, &self.underwater)?;
        if let Technique::Stencil { stencil_volumes, .. } = &mut self.technique {
            stencil_volumes.iter_mut().try_for_each(|volumes| volumes.set_drawn(parameters, &self.underwater))?;
        }
        self.illumination_volumes.iter_mut().for_each(|volumes| volumes.set_fresnel(parameters.fresnel));
        self.lit_receivers.iter_mut().for_each(|lit| lit.absorption_per_m = parameters.absorption_per_m);
        self.parameters = parameters.clone();
        Ok(true)
    }

    /// The mesh of the water as it was made, which may differ from the number of triangles asked for.
    pub fn grid(&self) -> Grid {
        self.water_surface.grid
    }

    /// Draws the last frame's caustics maps with an empty fragment stage, as pass `caustics-map-floor`: what their
    /// vertices and rasterisation cost alone. It spoils the maps. The stencil method, culling and `hit` have none.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record_floor(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let floors: Vec<Option<&Intersections>> = match &self.technique {
            Technique::LevelMap(variant) => variant.receivers.iter().map(|r| r.caustics_map.floor()).collect(),
            Technique::Volumetric(variant) => variant.receivers.iter().map(|r| r.caustics_map.floor()).collect(),
            Technique::Stencil { .. } => Vec::new(),
        };
        let mut each = floors.iter().zip(&self.lit_receivers);
        each.try_for_each(|(floor, lit)| match floor {
            Some(floor) => floor.record(frame, lit, &lit.cells, &self.illumination_volumes[lit.light]),
            None => Ok(()),
        })
    }

    /// Texels in each depth level of the first receiver under the first light, after a frame of smart slicing.
    pub fn depth_profile(&self) -> Option<&[u32]> {
        let Technique::LevelMap(level_map) = &self.technique else { return None };
        let smart = level_map.receivers.first()?.smart.as_ref()?;
        Some(smart.depth_profile.histogram())
    }

    /// The planes of each receiver under each light, as the last recorded frame placed them; none for the stencil
    /// method, for `hit`, and where the device alone knows them.
    pub fn plane_counts(&self) -> Vec<usize> {
        self.lit_receivers.iter().map(|lit| lit.cells.len()).collect()
    }

    /// Planes of all receivers under all lights in the last frame, those that the device placed read back.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn planes_drawn(&self, device: &Arc<Device>) -> Result<u64, Error> {
        let by_host = self.plane_counts().iter().sum::<usize>() as u64;
        let Technique::LevelMap(LevelMap { receivers, .. }) = &self.technique else { return Ok(by_host) };
        let mut placed = receivers.iter().filter_map(|passes| passes.caustics_map.smart_planes());
        placed.try_fold(by_host, |sum, smart| Ok(sum + u64::from(smart.drawn(device)?)))
    }

    fn time_s(&self, number: u32) -> f64 {
        f64::from(number) * f64::from(self.parameters.time_step_s)
    }

    /// Landing points of the rays of light `light` on each receiver and the maps of what it hides, in the variant `hit`; the
    /// cells that the device placed on each, by the variant `culled` with smart slicing.
    fn landings_and_cells(&self, light: usize) -> Vec<Target> {
        let Technique::LevelMap(LevelMap { receivers, .. }) = &self.technique else { return Vec::new() };
        let of_light = self.lit_receivers.iter().zip(receivers).filter(|(lit, _)| lit.light == light);
        let named = |(lit, passes): (&LitReceiver, &ReceiverPasses)| {
            let (name, table, columns) = match passes.caustics_map.landings() {
                Some(landings) => ("landings", landings, LANDING_FLOATS),
                None => ("plane-cells", &passes.caustics_map.smart_planes()?.cells, CELL_FLOATS),
            };
            Some(Target::table(numbered(name, &[lit.light, lit.index]), table, columns))
        };
        let hidden = |(lit, passes): (&LitReceiver, &ReceiverPasses)| {
            let maps: Vec<_> = passes.hidden.iter().flat_map(HiddenSurfaces::targets).collect();
            let target = |(name, view)| Target::image(numbered(name, &[lit.light, lit.index]), view).of(holds(name));
            maps.into_iter().map(target).collect::<Vec<_>>()
        };
        of_light.flat_map(|each| named(each).into_iter().chain(hidden(each))).collect()
    }

    /// The maps of each receiver under light `light` that can be dumped.
    fn map_targets(&self, light: usize) -> Vec<Target> {
        let maps: Vec<_> = match &self.technique {
            Technique::LevelMap(variant) => variant.receivers.iter().map(|r| r.targets()).collect(),
            Technique::Volumetric(variant) => variant.receivers.iter().map(|r| r.targets()).collect(),
            Technique::Stencil { .. } => Vec::new(),
        };
        let tables = self.landings_and_cells(light);
        let of_light = self.lit_receivers.iter().zip(maps).filter(|(lit, _)| lit.light == light);
        let named = |(lit, maps): (&LitReceiver, [(&str, &Arc<ImageView>); 4])| {
            maps.map(|(name, view)| Target::image(numbered(name, &[lit.light, lit.index]), view).of(holds(name)))
        };
        of_light.flat_map(named).chain(tables).collect()
    }
}

fn world_bounds(receivers: &[Arc<Receiver>]) -> Bounds {
    Bounds::of_points(receivers.iter().flat_map(|r| r.positions.iter().copied()))
}

/// A target's name, with the indices of its light and receiver when one of them is not the first.
fn numbered(name: &str, indices: &[usize]) -> String {
    if indices.iter().all(|&i| i == 0) {
        return name.to_owned();
    }
    let indices: Vec<String> = indices.iter().map(usize::to_string).collect();
    format!("{name}.{}", indices.join("."))
}

impl Paper for Caustics {
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        let time_s = self.time_s(number);
        let Caustics { water_surface, illumination_volumes, lit_receivers, shadow_maps, technique, .. } = self;

        // The receivers: their planes and maps (figure 4-15, step 1), or what is seen of them.
        match technique {
            Technique::LevelMap(LevelMap { slicing, receivers }) => {
                match slicing {
                    Slicing::Uniform(reference_planes) => reference_planes.record(frame, lit_receivers),
                    Slicing::Boxes(bounding_box) => bounding_box.record(frame, lit_receivers),
                }
                for (lit, passes) in lit_receivers.iter().zip(receivers.iter()) {
                    match &passes.maps {
                        ReceiverMaps::OnePass(position_diffuse_map) => position_diffuse_map.record(frame, lit)?,
                        ReceiverMaps::TwoPasses(position_map, diffuse_map) => {
                            position_map.record(frame, lit)?;
                            diffuse_map.record(frame, lit)?;
                        }
                    }
                    passes.hidden.as_ref().map_or(Ok(()), |hidden| hidden.record(frame, lit))?;
                }
                for (lit, passes) in lit_receivers.iter_mut().zip(receivers) {
                    if let Some(SmartSlicing { read_positions, depth_profile }) = &mut passes.smart {
                        let heights = read_positions.record(frame)?;
                        depth_profile.record(frame, heights, lit)?;
                    }
                }
            }
            Technique::Volumetric(Volumetric { sample_planes, receivers }) => {
                sample_planes.record(frame, lit_receivers);
                for (lit, passes) in lit_receivers.iter().zip(receivers) {
                    passes.slice_images.record(frame, lit)?;
                }
            }
            Technique::Stencil { receivers, .. } => receivers.record(frame)?,
        }

        shadow_maps.iter().try_for_each(|shadow_map| shadow_map.record(frame))?;

        // The light, refracted by the water.
        water_surface.record(frame, time_s)?;
        for volumes in illumination_volumes.iter() {
            volumes.record(frame)?;
        }

        // The caustics: where the light meets the receivers (figure 4-15, steps 2 and 3), and the cast.
        match technique {
            Technique::LevelMap(LevelMap { receivers, .. }) => {
                for (lit, passes) in lit_receivers.iter().zip(receivers.iter()) {
                    passes.caustics_map.record(frame, lit, &lit.cells, &illumination_volumes[lit.light])?;
                }
                for passes in receivers.iter() {
                    passes.combine.record(frame)?;
                    passes.combine_hidden.iter().try_for_each(|combine| combine.record(frame))?;
                }
                for (lit, passes) in lit_receivers.iter().zip(receivers) {
                    passes.cast.record(frame, lit, 0.0)?;
                }
            }
            Technique::Volumetric(Volumetric { receivers, .. }) => {
                for (lit, passes) in lit_receivers.iter().zip(receivers.iter()) {
                    for (plane, cell) in lit.cells.iter().enumerate() {
                        let cell = slice::from_ref(cell);
                        passes.caustics_map.record(frame, lit, cell, &illumination_volumes[lit.light])?;
                        passes.multiply.record(frame, plane)?;
                    }
                }
                for (lit, passes) in lit_receivers.iter().zip(receivers.iter()) {
                    passes.combine_slices.record(frame, lit)?;
                }
                for (lit, passes) in lit_receivers.iter().zip(receivers) {
                    // A slice knows its surface to half a cell.
                    passes.cast.record(frame, lit, lit.half_cell_m())?;
                }
            }
            Technique::Stencil { stencil_volumes, .. } => {
                for (stencil_volumes, volumes) in stencil_volumes.iter().zip(illumination_volumes) {
                    stencil_volumes.record(frame, volumes)?;
                }
            }
        }
        Ok(())
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)?;
        self.is_viewed = true;
        self.view.record(frame)
    }

    fn warnings(&self) -> Vec<String> {
        self.doubts()
    }

    fn camera(&self) -> Option<Camera> {
        Some(self.parameters.camera)
    }

    /// Fails where light of a map is missing, or a ray of the picture did not end.
    fn settle(&mut self, shaders: &ShaderLibrary) -> Result<bool, Error> {
        if let Technique::LevelMap(LevelMap { receivers, .. }) = &self.technique {
            receivers.iter().try_for_each(|passes| passes.caustics_map.check(shaders.device()))?;
        }
        if std::mem::take(&mut self.is_viewed) {
            self.view.check(shaders.device())?;
        }
        Ok(true)
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.view.picture
    }

    fn targets(&self) -> Vec<Target> {
        let mut targets = vec![
            Target::table("water", &self.water_surface.vertices, VERTEX_FLOATS)
                .of("position x, y, z in metres and a filler, normal x, y, z and a filler"),
        ];
        for (light, volumes) in self.illumination_volumes.iter().enumerate() {
            targets.push(Target::table(numbered("illumination-volumes", &[light]), &volumes.rays, RAY_FLOATS).of(
                "a vertex's ray: origin in metres along the light's axes, light that enters, slope, secant, direction",
            ));
            targets.extend(self.map_targets(light));
        }
        if let Technique::Stencil { receivers, .. } = &self.technique {
            targets.push(Target::image("surface-position", &receivers.position).of("x, y, z in metres"));
            targets.push(Target::image("surface-normal", &receivers.normal).of("x, y, z of the unit normal"));
            targets
                .push(Target::image("surface-albedo", &receivers.albedo).of("reflectance in red, green, blue, 0 to 1"));
        }
        targets.push(Target::image("underwater-color", &self.underwater.color).of("light in red, green, blue, linear"));
        targets.push(
            Target::image("underwater-depth", &self.underwater.fetched_depth)
                .of("depth, 0 at the near plane to 1 at the far one")
                .between(self.underwater.planes_m[0], self.underwater.planes_m[1]),
        );
        targets.push(
            Target::image("picture", &self.view.picture).of("red, green, blue, alpha as sRGB encodes them, 0 to 255"),
        );
        targets
    }
}

/// Contents of a texel of a receiver's map, with units.
fn holds(map: &str) -> &'static str {
    match map.trim_start_matches("hidden-") {
        "position-map" => "height in metres along the light",
        "diffuse-map" => "diffuse light in red, green, blue, linear, without the light's intensity",
        "caustics-map" => "I_c of eq. 4-18 for light of unit intensity",
        _ => "light in red, green, blue, linear; alpha 1 where there is a receiver",
    }
}
