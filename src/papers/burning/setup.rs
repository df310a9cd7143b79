//! The set-up of the `burning` paper: its numbers with a mesh and a texture, its record and its declarations.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Mat4, Vec3};
use serde_json::{Map, Value, json};

use super::axes;
use super::beside::{Beside, together};
use super::experiments::{self, Options, presets};
use super::materials::{self, Materials};
use super::model::{Model, with_triangles};
use super::{BlockCounts, Burning, Material, NEEDS, Parameters, Texture, Variant, texture};
use crate::field;
use crate::gpu::transfer::read_buffer;
use crate::gpu::{self, Device, Feature, ShaderLibrary};
use crate::measure::bench::Built;
use crate::measure::config::{self, entries};
use crate::measure::estimate::Estimate;
use crate::measure::experiment::Experiment;
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::parameter::{self, Choice, Cost, Given, Parameter, Range};
use crate::measure::statistics::median;
use crate::measure::stress::Axis;
use crate::measure::study::{Identity, Metrics, Preset, Study};
use crate::measure::{Error, Paper as _, ParameterError};
use crate::scene::loading::CREASE_DEG;
use crate::scene::{Mesh, MeshOptions, MeshSource, promised_triangles};

/// A user's choice of everything.
#[derive(Debug, Clone)]
pub struct Setup {
    /// Every number.
    pub parameters: Parameters,
    /// The object that burns.
    pub mesh: MeshSource,
    /// Objects that burn beside it.
    pub objects: Vec<Beside>,
    /// Crease angle of meshes without normals, degrees.
    pub crease_deg: f32,
    /// Factors of the mesh along x, y and z.
    pub stretch: Vec3,
    /// Triangles that the mesh is simplified or subdivided to; as it is, without.
    pub triangles: Option<u32>,
    /// A PNG that covers the mesh by its texture coordinates, in place of the material.
    pub texture: Option<PathBuf>,
    /// The materials of parts of the mesh, a TOML file.
    pub materials: Option<PathBuf>,
    /// The preset that it was made of.
    pub preset: Option<String>,
}

impl Default for Setup {
    /// The scanned bunny.
    fn default() -> Self {
        Setup {
            parameters: Parameters::default(),
            mesh: MeshSource::Bunny,
            objects: Vec::new(),
            crease_deg: CREASE_DEG,
            stretch: Vec3::ONE,
            triangles: None,
            texture: None,
            materials: None,
            preset: None,
        }
    }
}

/// Parameters that change what is drawn alone: a change of them takes effect with the next frame.
pub const DRAWN: [&str; 4] = ["camera", "exposure", "fire-light", "tone"];

/// Bytes on the device of a triangle of a mesh whose vertices are shared, at least.
pub(super) const LEAST_BYTES: f64 = 178.0;

/// A setup with its mesh loaded and brought to its count.
pub struct Scene {
    /// Stretched, with the triangles that were asked for.
    pub mesh: Mesh,
    /// With its levels.
    pub texture: Option<Arc<Texture>>,
    /// Of the mesh's vertices.
    pub materials: Option<Arc<Materials>>,
}

impl Setup {
    /// Checks what needs no mesh.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        parameter::check(&Self::own_parameters(), self)?;
        if let Some(path) = &self.materials {
            let is_whole = self.triangles.is_none() && self.texture.is_none();
            let range = "goes without `triangles` and `texture`, which know no parts of a mesh";
            ParameterError::check(is_whole, "materials", path.display(), range)?;
        }
        Ok(self.parameters.validate()?)
    }

    /// The numbers with what was loaded.
    fn parameters_of(&self, scene: &Scene) -> Parameters {
        let (texture, materials) = (scene.texture.clone(), scene.materials.clone());
        Parameters { texture, materials, ..self.parameters.clone() }
    }

    /// The parameters beside the numbers.
    fn own_parameters() -> [Parameter<Self>; 7] {
        [
            Parameter::new("mesh", field!(Setup.mesh))
                .help(
                    "Object that burns: teapot, sphere, box, bunny, plane, or an OBJ, PLY, STL, glTF or GLB file, with :N \
                     divided into N triangles or more; scaled to a diagonal of 1, its base centred at the origin",
                )
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("object", field!(Setup.objects))
                .help(
                    "Another object that burns beside the first: a shape or file with its place, @X,Y,Z[,DEGREES[,SCALE]]: \
                     the middle of its lower side in diagonals of the first, its turn about the vertical, and its diagonal",
                )
                .cost(Cost::Buffers),
            parameter::crease_angle(field!(Setup.crease_deg)),
            Parameter::new("stretch", field!(Setup.stretch))
                .range(Range::above(0.0).to(1000.0))
                .help("Stretch the mesh along x, y and z")
                .cost(Cost::Buffers),
            Parameter::new("triangles", field!(Setup.triangles))
                .range(Range::from(4.0).to(4e6))
                .help("Simplify or subdivide the mesh to about so many triangles")
                .default_text("as it is")
                .cost(Cost::Buffers)
                .everyday(),
            Parameter::new("texture", field!(Setup.texture))
                .placeholder("FILE.png")
                .help(
                    "PNG that covers the mesh by its texture coordinates, in place of a material; at most 8192 \
                     pixels a side",
                )
                .excludes(&["material"])
                .cost(Cost::Pipelines),
            Parameter::new("materials", field!(Setup.materials))
                .placeholder("FILE.toml")
                .help(
                    "Constants of table 3.1 for parts of the mesh: groups and materials of OBJ and glTF files, colours of \
                     vertices",
                )
                .section("table 3.1")
                .excludes(&["texture", "triangles"])
                .cost(Cost::Buffers),
        ]
    }
}

impl Study for Setup {
    const PAPER: &'static str = "burning";
    const NEEDS: &'static [Feature] = &NEEDS;

    type Variant = Variant;
    type Scene = Scene;
    type Paper = Burning;

    fn load(&self) -> Result<Scene, Error> {
        self.check()?;
        // Where a fire begins, its flames and its base points follow the order of triangles and vertices, so that shapes keep
        // the one that they were made in.
        let is_optimised = self.mesh.path().is_some();
        let keeps_tags = self.materials.is_some();
        let options = MeshOptions { crease_deg: self.crease_deg, is_optimised, keeps_tags };
        let mut mesh = self.mesh.load_with(&options)?;
        if self.stretch != Vec3::ONE {
            mesh = mesh.placed(&Mat4::from_scale(self.stretch));
        }
        if !self.objects.is_empty() {
            mesh = together(mesh, &self.objects, &options)?;
        }
        let mesh = match self.triangles {
            Some(count) => with_triangles(&mesh, count as usize),
            None => mesh,
        };
        let texture = match &self.texture {
            None => None,
            Some(path) if mesh.texture_coordinates.is_empty() => {
                return Err(Error::Input(format!(
                    "`texture` {}: the mesh {} has no texture coordinates; give one that has, or leave the texture out",
                    path.display(),
                    self.mesh
                )));
            }
            Some(path) => Some(Arc::new(texture::load(path)?)),
        };
        let materials = self.materials.as_deref().map(|path| materials::load(path, &mesh)).transpose()?;
        Ok(Scene { mesh, texture, materials: materials.map(Arc::new) })
    }

    fn reconfigure(&self, _: &Scene, paper: &mut Burning, changed: &Given) -> Result<bool, Error> {
        if !changed.is_within(&DRAWN) {
            return Ok(false);
        }
        self.check()?;
        Ok(paper.set_seen(&self.parameters)?)
    }

    fn make(
        &self,
        shaders: &ShaderLibrary,
        label: &str,
        scene: &Scene,
        variant: Variant,
    ) -> Result<Burning, gpu::Error> {
        let parameters = self.parameters_of(scene);
        let made = Burning::new(shaders, label, variant, &parameters, &scene.mesh);
        made.map_err(|error| match (&error, &self.texture) {
            (gpu::Error::Limit { object, .. }, Some(_)) if *object == format!("{label}/texture") => {
                error.set_by("texture")
            }
            _ => error,
        })
    }

    fn estimate(&self, device: &Device, scene: &Scene, variant: Variant) -> Estimate {
        // What is far too large is not even counted.
        let foreseen = self.foresee(scene.mesh.triangle_count() as u64, variant);
        if foreseen.check(device, "").is_err() {
            return foreseen;
        }
        self.parameters_of(scene).estimate(variant, &scene.mesh)
    }

    fn promised_triangles(&self) -> Result<u64, Error> {
        let sources = self.objects.iter().map(|object| &object.source).chain([&self.mesh]);
        let promised = promised_triangles(sources)?;
        // Those that are asked for are made of any number.
        Ok(if self.triangles.is_some() { 0 } else { promised })
    }

    fn foresee(&self, triangles: u64, variant: Variant) -> Estimate {
        let levels = self.parameters.levels.or(variant.own_levels()).unwrap_or(0);
        let parameter = if levels > 0 { "levels" } else { "triangles" };
        let finest = triangles as f64 * 4_f64.powi(levels as i32);
        Estimate {
            bytes: vec![(parameter, LEAST_BYTES * finest)],
            buffers: vec![(parameter, 12.0 * finest)],
            ..Estimate::default()
        }
    }

    fn identity(&self) -> Identity {
        Identity::new(&self.preset, (self.parameters.width, self.parameters.height), self.parameters.seed)
    }

    fn config(&self, scene: &Scene, paper: &Burning) -> Map<String, Value> {
        let model = paper.model();
        let (variant, parameters) = paper.made_of();
        let sources: Vec<_> = model.sources.iter().map(|s| s.to_array()).collect();
        let mut config = parameter::config(&Self::parameters(), self);
        config.extend(entries([
            ("triangles", json!(scene.mesh.triangle_count())),
            ("levels", json!(model.levels)),
            ("source", json!(sources)),
            ("floor", json!(model.floor)),
            ("material", json!(parameters.material(variant).map(Material::name))),
            ("heat", json!(parameters.heat().name())),
            ("albedo", json!(parameters.albedo(variant).to_array())),
            ("substances", substances(variant, parameters, model)),
            ("materials_sha256", json!(parameters.materials.as_ref().map(|materials| &materials.sha256))),
            ("camera", config::camera(paper.camera())),
        ]));
        config
    }

    fn summary(&self) -> String {
        format!("{}, frame {}", self.mesh, self.parameters.first_frame)
    }

    fn metrics(
        &self,
        machine: &mut Machine,
        measured: &mut [(Built<Self>, Measurement)],
    ) -> Result<Vec<Metrics>, Error> {
        let metrics = measured.iter().map(|(built, measurement)| {
            let warnings = built.paper.warnings();
            Ok(Metrics { results: results(machine, &built.paper, measurement)?, warnings })
        });
        metrics.collect()
    }

    const ABOUT: &'static str =
        "Burning: heat, deformation, consumption and melting of meshes (Amarasinghe), pass by pass";
    const BENCHED: &'static [Variant] = &[Variant::Shell];
    const RENDERED: Variant = Variant::Shell;
    const SHARED: &'static [&'static str] = &["blocks", "scaling"];

    type Options = Options;

    fn parameters() -> Vec<Parameter<Self>> {
        let numbers = Parameters::declared().into_iter();
        let numbers = numbers.map(|p| p.inside(|s: &Setup| &s.parameters, |s| &mut s.parameters));
        Self::own_parameters().into_iter().chain(numbers).collect()
    }

    fn options() -> Vec<Parameter<Options>> {
        experiments::options()
    }

    fn presets() -> Vec<Preset<Self>> {
        presets::all()
    }

    fn axes() -> Vec<Axis<Self>> {
        axes::all()
    }

    fn experiments() -> Vec<Experiment<Self>> {
        experiments::all()
    }

    /// The bunny, well alight.
    fn quick() -> Self {
        let mut setup = Setup::default();
        setup.parameters.first_frame = 420;
        setup
    }

    fn preset_mut(&mut self) -> &mut Option<String> {
        &mut self.preset
    }

    fn resolve(&mut self, _given: &Given) -> Result<(), Error> {
        self.check()
    }
}

/// The constants of each material of an object of several, and its vertices.
fn substances(variant: Variant, parameters: &Parameters, model: &Model) -> Value {
    let Some(materials) = &parameters.materials else { return Value::Null };
    let all = (0..).zip(materials.all(variant, parameters));
    let with_count = all.map(|(number, substance)| {
        let mut constants = substance.json();
        constants["vertices"] = json!(model.substances.iter().filter(|of| **of == number).count());
        constants
    });
    with_count.collect()
}

/// The counts of the device by the last frame that was recorded, and the frame rate.
fn results(machine: &Machine, paper: &Burning, measurement: &Measurement) -> Result<Map<String, Value>, Error> {
    let model = paper.model();
    let snapshot = experiments::snapshot(machine, paper)?;
    let counts = snapshot.counts;
    let blocks: Vec<BlockCounts> =
        bytemuck::pod_collect_to_vec(&read_buffer(&machine.device, &paper.buffers().blocks)?);
    let occupied = blocks.iter().filter(|block| block.live > 0).count();
    Ok(entries([
        ("frames_per_s", json!(median(&measurement.frame_ms).map(|ms| 1e3 / ms))),
        ("ticks", json!(counts.tick)),
        ("radius", json!(counts.radius)),
        ("vertices", json!(model.rest.len())),
        ("finest_triangles", json!(model.triangles.len())),
        ("coarse_triangles", json!(snapshot.coarse)),
        ("refined_coarse_triangles", json!(snapshot.refined)),
        ("occupied_blocks", json!(occupied)),
        ("active_vertices", json!(counts.active_vertices)),
        ("active_triangles", json!(counts.active_triangles)),
        ("live_vertices", json!(counts.live_vertices)),
        ("ready_vertices", json!(counts.ready_vertices)),
        ("removed_triangles", json!(counts.removed_triangles)),
        ("drawn_triangles", json!(counts.drawn_triangles)),
        ("fire_particles", json!(counts.fire_particles)),
        ("smoke_particles", json!(counts.smoke_particles)),
    ]))
}
