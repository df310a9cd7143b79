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
//! Polygon objects, if there are any, and a fluid's ground are drawn by `objects` into the picture after the thesis's last pass. The variant
//! `gpu-driven` takes another way from `animate` to `normal-height`, its own page.

mod accumulate_depths;
mod animate;
mod axes;
pub mod blackbody;
mod blending;
mod cameras;
mod cluster;
mod color;
mod culling;
mod deferred;
mod density;
mod estimate;
pub mod experiments;
mod extract;
mod gpu_driven;
mod highest;
mod highest_rows;
pub mod kinds;
pub mod lava_light;
#[cfg(test)]
mod layouts;
mod march;
mod method;
mod normal_height;
mod normalisation;
mod objects;
pub mod parameters;
mod particles;
mod pattern;
mod placement;
mod rays;
mod read_back;
mod read_density;
mod read_positions;
pub mod reference;
pub mod relief;
mod rock;
mod rock_source;
mod scene;
pub mod setup;
pub mod sph;
mod splats;
mod splatting;
mod start;
mod targets;
mod visibility;
mod warnings;

use std::sync::Arc;

use self::lava_light::LavaLight;
use self::normal_height::NormalHeight;
use self::objects::Objects;
use self::particles::ParticlePoints;
use self::relief::Relief;
use self::sph::surface_temperature::SurfaceTemperature;
use self::targets::Context;
use crate::gpu::transfer::read_image;
use crate::gpu::{Error, Feature, Frame, ImageView, ShaderLibrary};
use crate::measure::parameter::Given;
use crate::measure::{Paper, Target};
use crate::scene::{Camera, Mesh};

pub use self::animate::{Animate, State};
pub use self::cameras::CAMERAS;
pub use self::cluster::{Clusters, Point};
pub use self::culling::{Kept, SplatCulling};
pub use self::deferred::SplatShading;
pub use self::extract::Accepted;
pub use self::gpu_driven::{Cells, GpuDriven};
pub use self::method::Method;
pub use self::parameters::{Parameters, Shading, SurfaceDraw, SurfaceKind, Tone, Variant};
pub use self::placement::{Object, Place};
pub use self::read_back::ReadBack;
pub use self::rock::Rock;
pub use self::rock_source::RockSource;
pub use self::scene::{FluidSheet, Sheet, depth_range_m};
pub use self::sph::Sph;
pub use self::sph::bed::Bed;
pub use self::sph::crust::Crust;
pub use self::sph::heat::{Heat, Rheology};
pub use self::sph::parameters::{Flow, Sides, Simulation};
pub use self::sph::vent::{Inflow, Vent};
pub use self::splats::SplatShape;
pub use self::splatting::Splatting;
pub use self::start::Particles;

/// Features that a device must have for this paper, beyond the baseline of the Vulkan layer. Without a geometry stage
/// the splats are instanced quads, and [`Paper::warnings`] says so.
pub const NEEDS: [Feature; 2] = [Feature::BlendRgba32Float, Feature::LargePoints];

/// Each pass that draws points or splats, with the pass of the same vertices and primitives that has an empty fragment
/// stage: what it costs at least. The splats of stage three are the same twice.
pub const FLOORS: [(&str, &str); 4] = [
    ("density", "density-floor"),
    ("accumulate-depths", "accumulate-depths-floor"),
    ("visibility", "splats-floor"),
    ("blending", "splats-floor"),
];

/// Parameters that only the passes from the surface to the picture take, as constants.
pub const DRAWN: [&str; 11] = [
    "camera",
    "color",
    "daylight",
    "epsilon",
    "exposure",
    "gloss",
    "rock-tile",
    "splat-radius",
    "splat-shape",
    "temperatures",
    "tone",
];

/// The paper with its resources.
pub struct Lava {
    parameters: Parameters,
    /// Parameters that a user gave, of which those that do nothing are warned of.
    given: Given,
    variant: Variant,
    /// The particles' textures.
    pub animate: Animate,
    /// From the particles to the sums of eq. 6.3.
    pub method: Method,
    /// The surface.
    pub normal_height: NormalHeight,
    /// Its temperatures; `None` of particles that have none.
    pub surface_temperature: Option<SurfaceTemperature>,
    /// `None` without ropes, pieces and toes.
    pub relief: Option<Relief>,
    /// Stage three.
    pub splatting: Splatting,
    /// `None` of free particles.
    pub lava_light: Option<LavaLight>,
    /// `None` without polygon objects and ground.
    objects: Option<Objects>,
    /// On lava and objects that the camera cannot show.
    view_warnings: Vec<String>,
    /// The objects' meshes, to be held against the surface once it is drawn.
    meshes: Vec<Mesh>,
    /// Grid points that the last frame accepted, as far as the host knows.
    accepted: Option<Accepted>,
    /// On the surface of the last frame: objects under it, holes in it.
    of_surface: Vec<String>,
    /// `None` but for a picture of particles instead of the surface.
    points: Option<ParticlePoints>,
    lacks_geometry_stage: bool,
    /// The next frame draws the particles of the last one.
    repeats: bool,
}

impl Paper for Lava {
    fn restart(&mut self) -> Result<(), Error> {
        self.repeats = false;
        self.animate.restart();
        Ok(())
    }

    /// Frame `number` shows the particles after `number` + 1 steps. Steps that were not recorded are caught up, so that
    /// the picture depends on the number alone.
    ///
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Pass`] for a frame before the last without a restart between them.
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        let steps = self.animate.steps();
        let is_repeated = std::mem::take(&mut self.repeats) && number + 1 == steps;
        if number < steps && !is_repeated {
            let problem = format!("frame {number} comes before frame {steps}, the next; restart the paper first");
            return Err(Error::Pass { pass: "animate".into(), problem });
        }
        if !is_repeated {
            while self.animate.steps() <= number {
                self.animate.record(frame)?;
            }
            self.method.cluster(frame, self.animate.current(), self.animate.out())?;
        }
        self.method.accumulate(frame)?;
        self.normal_height.record(frame)?;
        if let (Some(sph), Some(surface_temperature)) = (self.animate.sph(), &self.surface_temperature) {
            surface_temperature.record(frame, sph, self.animate.steps())?;
        }
        if let Some(relief) = &self.relief {
            relief.record(frame)?;
        }
        self.splatting.record(frame, self.drift_m(number))?;
        if let Some(lava_light) = &self.lava_light {
            lava_light.record(frame)?;
        }
        self.objects.as_ref().map_or(Ok(()), |objects| objects.record(frame))
    }

    /// Stage one is left out: its clusters are there.
    fn repeat(&mut self) -> bool {
        self.repeats = true;
        true
    }

    fn advance(&mut self, frame: &mut Frame<'_>, number: u32, most: u32) -> Result<u32, Error> {
        let animate = &mut self.animate;
        for _ in 0..number.saturating_sub(animate.steps()).min(animate.frames_within(most)) {
            animate.record(frame)?;
        }
        Ok(number.saturating_sub(animate.steps()).saturating_mul(animate.substeps()))
    }

    /// The thesis's last pass is the picture, but where it shows particles.
    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)?;
        match &self.points {
            Some(points) => points.record(frame, self.animate.current(), self.animate.out()),
            None => Ok(()),
        }
    }

    /// Looks at what was accepted, and at the surface: for objects under it, and slopes that its splats leave holes in.
    fn settle(&mut self, shaders: &ShaderLibrary) -> Result<bool, Error> {
        self.animate.sph().map_or(Ok(()), |sph| sph.check(shaders.device()))?;
        self.accepted = Some(self.method.accepted(shaders.device())?);
        let surface = &self.normal_height.surface;
        let bytes = read_image(shaders.device(), surface)?;
        let texels = bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&bytes);
        let (columns, rows) = (surface.width(), surface.height());
        self.of_surface = placement::buried(&self.meshes, &texels, columns, rows, self.parameters.space_m);
        self.of_surface.extend(warnings::gaping(&self.parameters, &self.given, self.variant, &texels));
        Ok(true)
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = [&self.view_warnings[..], &self.of_surface].concat();
        warnings.extend(warnings::unheeded(&self.parameters, &self.given, self.variant));
        if self.lacks_geometry_stage {
            warnings.push(
                "the device has no geometry stage: the splats are instanced quads, so times of `accumulate-depths`, \
                 `visibility` and `blending` are not the thesis's method's"
                    .to_owned(),
            );
        }
        if let Some(Accepted { count: 0, density_range: [lowest, highest] }) = self.accepted() {
            warnings.push(format!(
                "no grid point was accepted, so the surface is flat: `rho` is {} and the densities are {lowest} to \
                 {highest}",
                self.parameters.rho()
            ));
        }
        warnings
    }

    fn camera(&self) -> Option<Camera> {
        Some(self.parameters.camera)
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.splatting.normalisation.picture
    }

    fn targets(&self) -> Vec<Target> {
        let State { positions, velocities } = self.animate.state();
        let motion = match self.surface_temperature {
            None => "x, y, z in metres per second",
            Some(_) => "x, y, z in metres per second, temperature in kelvin",
        };
        let of_a_fluid = self.surface_temperature.iter().flat_map(|pass| {
            let carried = "x and z in metres that the rock of each of two layings has been carried";
            [
                Target::image("surface-temperatures", &pass.temperatures)
                    .of("temperature in kelvin, 1 where any lava is near, share of the rock's first laying"),
                Target::image("surface-carried", &pass.carried).of(carried),
            ]
        });
        let of_relief = self.relief.iter().flat_map(|relief| {
            [
                Target::image("surface-motion", &relief.motion)
                    .of("speed along x and z in metres per second, mean temperature of the lava in kelvin, its depth in metres"),
                Target::image("crust-normals", &relief.normal_height)
                    .of("x, y, z of the crust's unit normal, its height in metres"),
                Target::image("crust-temperatures", &relief.temperatures)
                    .of("temperature in kelvin, 1 where any lava is near, share of the rock's first laying"),
            ]
        });
        let of_deferred = self.splatting.deferred().into_iter().flat_map(|deferred| {
            [
                Target::image("blended-normals", &deferred.normals)
                    .of("sum of weighted unit normals along x, y, z, sum of weights in alpha"),
                Target::image("blended-depths", &deferred.depths).of("sum of weighted depths in red, metres"),
            ]
        });
        let targets = vec![
            Target::image("positions", positions).of("x, y, z in metres"),
            Target::image("velocities", velocities).of(motion),
            Target::image("density", self.method.density()).of("densities at four grid planes above each other"),
            Target::image("accumulated-depths", self.method.sums())
                .of("sum of weighted heights in metres in red, sum of weights in alpha"),
            Target::image("normal-height", &self.normal_height.surface)
                .of("x, y, z of the unit normal, height in metres"),
            Target::image("visibility", &self.splatting.depth)
                .of("distance from the eye and epsilon, as a share of the depth range"),
            Target::image("accumulated-colors", &self.splatting.sums)
                .of("sum of weighted light in red, green, blue, linear, sum of weights in alpha"),
            Target::image("picture", &self.splatting.normalisation.picture)
                .of("red, green, blue, alpha as sRGB encodes them, 0 to 255"),
        ];
        targets.into_iter().chain(of_a_fluid).chain(of_relief).chain(of_deferred).collect()
    }
}

impl Lava {
    /// Makes every resource and pass; `label` goes before the names of the resources. `objects` are valid meshes in the
    /// simulation space, metres.
    ///
    /// # Errors
    /// Errors of the Vulkan layer. The caller has validated `parameters` and `rock`; there is at least one particle.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        particles: &Particles,
        rock: &Rock,
        objects: &[Mesh],
    ) -> Result<Self, Error> {
        let parameters = &reaching(parameters, objects);
        let context = Context { shaders, label, parameters };
        let has_geometry_stage = shaders.device().physical().has(Feature::GeometryShader);
        let instanced = !(parameters.geometry_stage && has_geometry_stage);
        let count = particles.positions.len() as u32;
        let animate = Animate::new(shaders, label, parameters, particles)?;
        let method = Method::new(context, variant, &animate, count, instanced)?;
        let normal_height = NormalHeight::new(context, method.sums(), animate.sph().map(|sph| &sph.bed))?;
        let draw = parameters.surface_draw(variant);
        let surface = &normal_height.surface;
        let surface_temperature =
            animate.sph().map(|sph| SurfaceTemperature::new(context, sph, surface)).transpose()?;
        let fluid = animate.sph().zip(surface_temperature.as_ref());
        let relief = fluid.map(|(sph, pass)| Relief::new(context, sph, surface, pass)).transpose()?.flatten();
        let fluid = fluid.map(|(sph, pass)| {
            let of_pass = (&pass.temperatures, &pass.carried);
            let (temperatures, carried) =
                relief.as_ref().map_or(of_pass, |relief| (&relief.temperatures, &relief.carried));
            FluidSheet { temperatures: temperatures.clone(), carried: carried.clone(), bed: sph.bed.clone() }
        });
        let drawn = relief.as_ref().map_or(surface, |relief| &relief.normal_height);
        let sheet = Sheet { normal_height: drawn, fluid: fluid.as_ref() };
        let splatting = Splatting::new(shaders, label, parameters, sheet, rock, instanced, draw)?;
        let Splatting { scene, depth, normalisation, .. } = &splatting;
        let view_warnings = view_warnings(parameters, objects);
        let meshes = objects.to_vec();
        let ground = animate.sph().map(|_| particles.bed.mesh(parameters.space_m));
        let lava_light = fluid.map(|fluid| LavaLight::new(context, scene, &fluid)).transpose()?;
        let lamps = lava_light.as_ref().map(|pass| &pass.lamps);
        let objects = Objects::new(context, objects, ground.as_ref(), scene, depth, normalisation, lamps)?;
        let points = (parameters.shading == Shading::Particles)
            .then(|| ParticlePoints::new(context, &animate, scene, normalisation))
            .transpose()?;
        let is_splatted = variant == Variant::Paper || draw == SurfaceDraw::Splats;
        let lacks_geometry_stage = is_splatted && parameters.geometry_stage && !has_geometry_stage;
        let parameters = parameters.clone();
        Ok(Lava {
            parameters,
            given: Given::default(),
            variant,
            animate,
            method,
            normal_height,
            surface_temperature,
            relief,
            splatting,
            lava_light,
            objects,
            view_warnings,
            meshes,
            accepted: None,
            of_surface: Vec::new(),
            points,
            lacks_geometry_stage,
            repeats: false,
        })
    }

    /// The same, of parameters of which a user gave those: what the variant does not heed of them is warned of.
    pub fn given(mut self, given: Given) -> Self {
        self.given = given;
        self
    }

    /// Sets the numbers of [`DRAWN`] of the next frames; `rock` and `objects` are those that it was made with, and so are
    /// all other numbers. The caller has validated them.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set_drawn(&mut self, parameters: &Parameters, rock: &Rock, objects: &[Mesh]) -> Result<(), Error> {
        let parameters = &reaching(parameters, objects);
        self.parameters = parameters.clone();
        self.splatting.set_drawn(parameters, rock)?;
        if let Some(drawn) = &mut self.objects {
            drawn.set_constants(parameters);
        }
        self.view_warnings = view_warnings(parameters, objects);
        Ok(())
    }

    /// Draws the points and splats of the last frame with an empty fragment stage, as the passes of [`FLOORS`]: what
    /// their vertices and primitives cost alone. It changes no texture.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record_floors(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        if let Method::Paper(read_back) = &self.method {
            read_back.record_floors(frame)?;
        }
        self.splatting.record_floor(frame)
    }

    /// The variant.
    pub fn variant(&self) -> Variant {
        self.variant
    }

    /// Grid points that the last frame accepted: unknown before any, and of `gpu-driven` before it has settled.
    pub fn accepted(&self) -> Option<Accepted> {
        match &self.method {
            Method::Paper(read_back) => (self.animate.steps() > 0).then(|| read_back.accepted()),
            Method::GpuDriven(_) => self.accepted,
        }
    }

    /// Distance that the rock has drifted in frame `number`, metres: as far as the mean particle. A fluid carries its own.
    fn drift_m(&self, number: u32) -> f32 {
        if self.animate.sph().is_some() {
            return 0.0;
        }
        let time_s = f64::from(number) * f64::from(self.parameters.time_step_s);
        let drift_m = time_s * f64::from(self.parameters.speed_m_s);
        // Whole tiles change nothing and would cost precision.
        (drift_m % f64::from(self.parameters.rock_tile_m)) as f32
    }
}

/// The numbers with a camera that reaches space and objects.
fn reaching(parameters: &Parameters, objects: &[Mesh]) -> Parameters {
    let camera = placement::reaching(&parameters.camera, parameters.space_m, objects, parameters.aspect());
    Parameters { camera, ..parameters.clone() }
}

/// Lines on lava and objects that the camera cannot show.
fn view_warnings(parameters: &Parameters, objects: &[Mesh]) -> Vec<String> {
    let Parameters { camera, space_m, width, height, .. } = parameters;
    let of_space = placement::space_warning(camera, *space_m, (*width, *height));
    of_space.into_iter().chain(placement::warnings(objects, camera, parameters.aspect())).collect()
}
