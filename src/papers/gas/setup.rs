//! A user's set-up of the `gas` paper: its scene, its measured runs, its declaration to the command line.

use std::borrow::Cow;
use std::sync::Arc;

use glam::Vec3;
use serde_json::{Map, Value, json};

use super::alternatives::Alternatives;
use super::axes;
use super::capacity::BufferLimit;
use super::experiments::{self, Options};
use super::parameters::gas_number::GasNumber;
use super::parameters::placed_object::PlacedObject;
use super::parameters::volume_file::{Placed, Reading, VolumeFile};
use super::parameters::volumes::{self, Placement};
use super::parameters::{default_volume, validate_object};
use crate::field;
use crate::gpu::{self, Device, Feature, ShaderLibrary};
use crate::measure::bench::Built;
use crate::measure::config::{self, entries};
use crate::measure::estimate::Estimate;
use crate::measure::experiment::Experiment;
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::parameter::{self, Cost, Given, Parameter};
use crate::measure::statistics::median;
use crate::measure::stress::Axis;
use crate::measure::study::{self, Identity, Metrics, Study};
use crate::measure::{Error, Paper, ParameterError, components};
use crate::papers::gas::model::{self, Object};
use crate::papers::gas::scenes::Preset;
use crate::papers::gas::{Gas, NEEDS, Parameters, Variant, WRITTEN};
use crate::scene::loading::CREASE_DEG;
use crate::scene::{Light, promised_triangles};

/// A user's choice of everything.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The numbers.
    pub parameters: Parameters,
    /// The scene whose surfaces there are.
    pub scene: Preset,
    /// Polygon meshes that stand in the scene beside its own surfaces.
    pub objects: Vec<PlacedObject>,
    /// Triangles that all surfaces together are divided into at least; as they are, without.
    pub surface_triangles: Option<u64>,
    /// Layers behind the scene that each fill the picture.
    pub layers: u32,
    /// Of each layer, 0 to 1.
    pub layer_opacity: f32,
    /// Methods of lists, rays and densities, which a bench measures in turn.
    pub alternatives: Alternatives,
    /// Crease angle of meshes without normals, degrees.
    pub crease_deg: f32,
    /// The preset, as the record names it.
    pub preset: Option<String>,
    /// Volumes beside the scene's.
    placements: Vec<Placement>,
    /// Volumes of files, in place of the scene's.
    volume_files: Vec<VolumeFile>,
    /// Rules by which their densities are made of samples.
    reading: Reading,
    /// The scene's own first volume, or the one that stands for it.
    first_volume: model::Volume,
    /// The numbers for all volumes, in the [templates](volumes::templates).
    gases: Vec<model::Volume>,
    /// Numbers of single gases, after those for all.
    gas_numbers: Vec<GasNumber>,
    /// Directions of parallel light and positions of point lights; the scene's where there are neither.
    parallel_lights: Vec<Vec3>,
    point_lights: Vec<Vec3>,
    /// Names of the given numbers that some volume must have.
    given: Given,
}

impl Setup {
    /// A figure's scene with its numbers, held in a frame in which there is gas.
    pub fn of(scene: Preset) -> Self {
        let mut parameters = scene.scene().parameters;
        parameters.first_frame = scene.bench_frame();
        parameters.frame_step = 0;
        Setup {
            parameters,
            scene,
            objects: Vec::new(),
            surface_triangles: None,
            layers: 0,
            layer_opacity: 1.0,
            alternatives: Alternatives::default(),
            crease_deg: CREASE_DEG,
            preset: Some(scene.as_str().to_owned()),
            placements: Vec::new(),
            volume_files: Vec::new(),
            reading: Reading::default(),
            first_volume: default_volume(),
            gases: volumes::templates(),
            gas_numbers: Vec::new(),
            parallel_lights: Vec::new(),
            point_lights: Vec::new(),
            given: Given::default(),
        }
    }

    /// The same values over the numbers of other figures' scenes.
    ///
    /// # Errors
    /// [`Error::Input`] for one that none of the scenes has.
    pub fn in_scenes(&self, scenes: &[Preset]) -> Result<Vec<Setup>, Error> {
        let in_scene = |&scene: &Preset| {
            let mut setup = Setup::of(scene);
            let given = Self::parameters().into_iter().filter(|p| self.given.has(p.name));
            given.for_each(|parameter| parameter.copy(self, &mut setup));
            setup.apply(&self.given)?;
            Ok(setup)
        };
        let setups = scenes.iter().map(in_scene).collect::<Result<Vec<Setup>, Error>>()?;
        volumes::check_used(&self.given, &setups.iter().flat_map(|s| s.parameters.volumes.clone()).collect())?;
        Ok(setups)
    }

    /// The same under the name of its scene.
    pub fn named(&self) -> Self {
        Setup { preset: Some(self.scene.as_str().to_owned()), ..self.clone() }
    }

    /// The same with a constant density in all volumes.
    pub fn with_constant_density(&self) -> Self {
        let mut setup = Setup { given: Given::default(), ..self.clone() };
        for volume in &mut setup.parameters.volumes {
            volume.texture.function = model::DensityFunction::Constant;
        }
        setup
    }

    /// Adds the volumes and sets their numbers and the lights.
    fn apply(&mut self, given: &Given) -> Result<(), Error> {
        self.alternatives.apply(&mut self.parameters);
        let all = &mut self.parameters.volumes;
        let first = all.first().copied().unwrap_or_else(default_volume);
        all.extend(self.placements.iter().map(|&Placement { shape, center, half_extent_m }| model::Volume {
            shape,
            center,
            half_extent_m,
            ..first
        }));
        self.first_volume = first;
        if !self.volume_files.is_empty() {
            let of_file = |index| model::Volume {
                shape: model::Shape::Box,
                falloff: 0.0,
                texture: model::SolidTexture {
                    function: model::DensityFunction::Grid(index),
                    opaque: 1.0,
                    power: 1.0,
                    ..first.texture
                },
                ..first
            };
            *all = (0..self.volume_files.len()).map(of_file).collect();
        }
        volumes::declared().iter().filter(|p| given.has(p.name)).for_each(|p| p.copy(&self.gases, all));
        self.gas_numbers.iter().try_for_each(|number| number.set_in(all))?;
        // As bright at the origin as the scenes' own light, wherever it stands.
        let parallel =
            self.parallel_lights.iter().map(|&direction| Light::Parallel { direction, intensity: Vec3::ONE });
        let points = self.point_lights.iter().map(|&position| {
            let intensity = Vec3::splat(position.length_squared().max(1e-3));
            Light::Point { position, intensity }
        });
        let lights: Vec<Light> = parallel.chain(points).collect();
        if !lights.is_empty() {
            self.parameters.lights = lights;
        }
        Ok(())
    }
}

impl Setup {
    /// The numbers with the volumes of files where they stand.
    pub(super) fn parameters_in(&self, scene: &Scene) -> Cow<'_, Parameters> {
        if scene.files.is_empty() {
            return Cow::Borrowed(&self.parameters);
        }
        let mut parameters = self.parameters.clone();
        for (volume, file) in parameters.volumes.iter_mut().zip(&scene.files) {
            (volume.center, volume.half_extent_m) = (file.center, file.grid.half_extent_m().as_vec3());
        }
        parameters.grids = scene.files.iter().map(|file| Arc::clone(&file.grid)).collect();
        Cow::Owned(parameters)
    }
}

impl Default for Setup {
    fn default() -> Self {
        let mut setup = Setup::of(Preset::Fig8);
        setup.preset = None;
        setup
    }
}

/// Checks that a light is near enough to be as bright at the origin as the scenes' own, which no intensity reaches from farther.
fn check_point_light(position: &Vec3) -> Result<(), ParameterError> {
    let is_near = position.length_squared() <= 1e6;
    ParameterError::check(is_near, "point-light", components(*position), "must be at most 1000 metres from the origin")
}

/// The passes that surfaces take, by every method of their lists.
pub(super) const LIST_PASSES: [&str; 8] =
    ["tiles-empty", "tiles-count", "tiles-sum", "tiles-fill", "tiles-pixels", "fragments", "sort", "resolve"];

/// A setup with its surfaces.
pub struct Scene {
    /// Surfaces of the scene and of the user.
    pub objects: Vec<Object>,
    /// Volumes of the user's files.
    pub files: Vec<Placed>,
}

impl Study for Setup {
    const PAPER: &'static str = "gas";
    const NEEDS: &'static [Feature] = &NEEDS;

    type Variant = Variant;
    type Scene = Scene;
    type Paper = Gas;

    /// Checks the parameters, models the scene's surfaces and loads the user's.
    fn load(&self) -> Result<Scene, Error> {
        volumes::check_used(&self.given, &self.parameters.volumes)?;
        self.alternatives.check_used(&self.given, &self.parameters.volumes)?;
        parameter::check(&Reading::declared(), &self.reading)?;
        if self.given.has("white-temperature") && self.reading.temperature.is_none() {
            let message = "`white-temperature`: no file has temperatures: give `volume-temperature`";
            return Err(Error::Input(message.to_owned()));
        }
        let has_cache = self.alternatives.density_caches.iter().any(|cache| cache.0.is_some());
        if has_cache && self.reading.temperature.is_some() {
            let message = "`density-cache`: a table of densities knows no temperatures: leave out `volume-temperature`";
            return Err(Error::Input(message.to_owned()));
        }
        self.point_lights.iter().try_for_each(check_point_light)?;
        self.parameters.validate()?;
        let mut objects = self.scene.scene().objects;
        for source in &self.objects {
            objects.push(source.load(self.crease_deg)?);
        }
        self.gas_numbers.iter().try_for_each(|number| number.set_on(&mut objects))?;
        self.divide_surfaces(&mut objects);
        objects.extend(self.layers());
        objects.iter().try_for_each(validate_object)?;
        let load = |file: &VolumeFile| file.load(&self.reading, &self.first_volume);
        let files = self.volume_files.iter().map(load).collect::<Result<_, _>>()?;
        let scene = Scene { objects, files };
        volumes::check(&self.parameters_in(&scene).volumes)?;
        Ok(scene)
    }

    fn reconfigure(&self, scene: &Scene, paper: &mut Gas, changed: &Given) -> Result<bool, Error> {
        if !changed.is_within(&WRITTEN) {
            return Ok(false);
        }
        self.parameters.validate()?;
        paper.set_written(&self.parameters_in(scene));
        Ok(true)
    }

    fn make(&self, shaders: &ShaderLibrary, label: &str, scene: &Scene, variant: Variant) -> Result<Gas, gpu::Error> {
        Gas::new(shaders, label, variant, &self.parameters_in(scene), &scene.objects, None)
    }

    fn estimate(&self, device: &Device, scene: &Scene, variant: Variant) -> Estimate {
        let limit = BufferLimit::new(device, &self.parameters);
        self.parameters_in(scene).estimate(variant, &scene.objects, limit)
    }

    fn promised_triangles(&self) -> Result<u64, Error> {
        let of_objects = promised_triangles(self.objects.iter().map(|object| &object.source))?;
        Ok(of_objects.max(self.surface_triangles.unwrap_or(0)))
    }

    fn foresee(&self, triangles: u64, _: Variant) -> Estimate {
        Estimate { bytes: vec![("object", 32.0 * triangles as f64)], ..Estimate::default() }
    }

    fn identity(&self) -> Identity {
        Identity::new(&self.preset, (self.parameters.width, self.parameters.height), self.parameters.seed)
    }

    fn config(&self, scene: &Scene, _: &Gas) -> Map<String, Value> {
        let p = &self.parameters_in(scene);
        let triangles: usize = scene.objects.iter().map(|o| o.mesh.triangle_count()).sum();
        let volumes: Vec<Value> = p.volumes.iter().map(volumes::recorded).collect();
        let mut config = parameter::config(&Self::parameters(), self);
        config.extend(entries([
            ("scene", json!(self.scene.as_str())),
            ("triangles", json!(triangles)),
            ("volumes", json!(volumes)),
            ("lights", json!(p.lights.iter().map(config::light).collect::<Vec<_>>())),
            ("background", json!(p.background.to_array())),
            ("camera", config::camera(&p.camera)),
        ]));
        config.extend(p.alternative_config());
        if self.layers > 0 {
            config.insert("layers".to_owned(), json!(self.layers));
            config.insert("layer_opacity".to_owned(), json!(self.layer_opacity));
        }
        config
    }

    fn summary(&self) -> String {
        let Parameters { first_frame, .. } = &self.parameters;
        format!("{}, frame {first_frame}, {}", self.scene.as_str(), self.parameters.alternative_text())
    }

    fn metrics(
        &self,
        machine: &mut Machine,
        measured: &mut [(Built<Self>, Measurement)],
    ) -> Result<Vec<Metrics>, Error> {
        let mut metrics = Vec::new();
        for (built, measurement) in measured {
            let demand = built.paper.demand(&machine.shaders)?;
            let gpu_ms = |names: &[&str]| {
                let passes = measurement.passes.iter().filter(|p| names.contains(&p.info.name));
                passes.filter_map(|p| median(&p.gpu_ms)).sum::<f64>()
            };
            let surfaces_ms = gpu_ms(&LIST_PASSES);
            let mut results = entries([
                ("fragments", json!(built.paper.kept_fragments(&machine.shaders)?)),
                ("fragment_slots", json!(demand.fragments)),
                ("sections", json!(demand.sections)),
                ("rows", json!(demand.rows)),
                ("samples", json!(built.paper.evaluations(&machine.shaders)?)),
                ("surfaces_ms", json!(Some(surfaces_ms).filter(|&ms| ms > 0.0))),
            ]);
            results.extend(built.paper.lost_pixels().map(|pixels| ("lost_pixels".to_owned(), json!(pixels))));
            metrics.push(Metrics { results, warnings: built.paper.warnings() });
        }
        Ok(metrics)
    }

    const ABOUT: &'static str =
        "Gas: A-buffer surfaces and volume-traced gases in one picture (Ebert, Parent), pass by pass";
    // Tracing shadows from every sample takes many times as long.
    const BENCHED: &'static [Variant] = &[Variant::NoVolume, Variant::None, Variant::Surfaces, Variant::Table];
    const RENDERED: Variant = Variant::Table;
    const EXPERIMENT_FRAMES: (u32, u32) = (1, 5);
    const SHARED: &'static [&'static str] = &["1", "2", "table-size", "steps", "noise"];

    type Options = Options;

    fn parameters() -> Vec<Parameter<Self>> {
        let objects = [
            Parameter::new("object", field!(Setup.objects))
                .help(
                    "Polygon mesh in the scene: teapot, sphere, box, bunny, plane, or an OBJ, PLY, STL, glTF or GLB \
                     file. Without a place it has the file's own coordinates in metres and is grey; \
                     @X,Y,Z[,DEGREES[,SCALE[,R,G,B[,OPACITY]]]]: the middle of its lower side in metres, its turn about the \
                     vertical, the factor of its own size, its colour, linear, and its opacity, each 0 to 1",
                )
                .cost(Cost::Buffers)
                .everyday(),
            parameter::crease_angle(field!(Setup.crease_deg)),
            Parameter::new("volume", field!(Setup.placements))
                .group("Gases")
                .help(
                    "One more volume beside the scene's: box, sphere, cylinder or frustum, its centre and half extents \
                     in metres (0.0001 to 1000000), and of a frustum the radii at the bottom and at the top as \
                     fractions of the half extents, 0 to 1; filled as the scene's first volume, or with turbulence; \
                     up to 8 volumes",
                )
                .cost(Cost::Buffers)
                .unrecorded(),
        ];
        let files = [
            Parameter::new("volume-file", field!(Setup.volume_files))
                .help(
                    "NRRD, MetaImage, NIfTI or NanoVDB file whose samples are densities: a volume in place of the scene's, in the box \
                     of its first one as far as its own proportions let it; @X,Y,Z[,DEGREES[,SIDE]]: the middle of its \
                     box's lower side in metres, its turn about the vertical, its box's longest side in metres; up to 8",
                )
                .cost(Cost::Buffers)
                .everyday()
                .excludes(&["volume", "density", "texture-scale"]),
        ];
        let reading = Reading::declared().into_iter().map(|p| p.inside(|s: &Setup| &s.reading, |s| &mut s.reading));
        let files = files.into_iter().chain(reading).map(|p| p.group("Gases"));
        let lights = [
            Parameter::new("light", field!(Setup.parallel_lights))
                .help("Direction of light from infinity; takes the place of the scene's; up to 4 with those of `point-light`")
                .default_text("the scene's")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("point-light", field!(Setup.point_lights))
                .help(
                    "Position of a point light in metres, at most 1000 from the origin; takes the place of the scene's; up to 4 \
                     with those of `light`",
                )
                .default_text("the scene's")
                .cost(Cost::Buffers)
                .unrecorded(),
        ];
        let of_gases = Parameter::new("gas-number", field!(Setup.gas_numbers))
            .group("Gases")
            .help(
                "One number of one gas alone, after those of all volumes: a volume by its place from 1, the scene's and then \
                 the user's, or surfaces for the surface-defined gases; an option of the gases without its dashes, and its value, \
                 as 2:tau=0.5",
            )
            .cost(Cost::Buffers);
        let gases = volumes::declared().into_iter().map(|p| p.inside(|s: &Setup| &s.gases, |s| &mut s.gases));
        let numbers =
            Parameters::declared().into_iter().map(|p| p.inside(|s: &Setup| &s.parameters, |s| &mut s.parameters));
        let alternatives = Alternatives::declared()
            .into_iter()
            .map(|p| p.inside(|s: &Setup| &s.alternatives, |s| &mut s.alternatives));
        objects
            .into_iter()
            .chain(alternatives)
            .chain(files)
            .chain(gases)
            .chain([of_gases])
            .chain(numbers)
            .chain(lights)
            .collect()
    }

    fn options() -> Vec<Parameter<Options>> {
        experiments::options()
    }

    fn presets() -> Vec<study::Preset<Self>> {
        let preset = |name, help, setup| study::Preset { name, help, variant: None, setup };
        vec![
            preset("fig-3", "Figure 3: a gallery with a gaseous sculpture", || Setup::of(Preset::Fig3)),
            preset("fig-4", "Figure 4: surface-defined fog over a chess board", || Setup::of(Preset::Fig4)),
            preset("fig-5", "Figure 5: the gallery, for the shadow table", || Setup::of(Preset::Fig5)),
            preset("fig-6", "Figure 6: steam from a glass, glasses in front of, around and behind it", || {
                Setup::of(Preset::Fig6)
            }),
            preset("fig-7", "Figure 7: volume fog that rolls over a chess board", || Setup::of(Preset::Fig7)),
            preset("fig-8", "Figure 8: steam and one glass, the default", || Setup::of(Preset::Fig8)),
            preset("solid", "A solid (hypertexture) volume", || Setup::of(Preset::Solid)),
            preset("clouds", "A layer of clouds and clouds on ellipsoids, by surfaces", || Setup::of(Preset::Clouds)),
        ]
    }

    fn axes() -> Vec<Axis<Self>> {
        axes::all()
    }

    fn experiments() -> Vec<Experiment<Self>> {
        experiments::all()
    }

    /// Figure 8 at half its size.
    fn quick() -> Self {
        let mut setup = Setup::default();
        (setup.parameters.width, setup.parameters.height) = (180, 125);
        setup
    }

    fn preset_mut(&mut self) -> &mut Option<String> {
        &mut self.preset
    }

    fn resolve(&mut self, given: &Given) -> Result<(), Error> {
        self.alternatives.check_distinct()?;
        self.given = given.clone();
        self.apply(given)
    }

    fn alternatives(&self) -> Vec<Self> {
        let of = |alternatives: Alternatives| {
            let mut alone = Setup { alternatives, ..self.clone() };
            alone.alternatives.apply(&mut alone.parameters);
            alone
        };
        self.alternatives.alone().into_iter().map(of).collect()
    }

    /// The figure's; of those without volumes, as figure 4, `table` where the user adds some.
    fn rendered(&self, _: Option<Variant>) -> Variant {
        match self.scene.variant() {
            Variant::NoVolume if !(self.placements.is_empty() && self.volume_files.is_empty()) => Variant::Table,
            variant => variant,
        }
    }
}
