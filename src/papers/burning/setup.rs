//! The experiments of the `burning` paper: what a user set up, what a run says of itself, the tables and the picture strips.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Mat4, Vec3};
use serde_json::{Map, Value, json};

use crate::gpu::transfer::read_buffer;
use crate::gpu::{self, Feature, ShaderLibrary};
use crate::measure::Error;
use crate::measure::Paper;
use crate::measure::ParameterError;
use crate::measure::bench::Built;
use crate::measure::config::{self, entries};
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::statistics::median;
use crate::measure::study::{Identity, Metrics, Study};
use crate::papers::burning::model::with_triangles;
use crate::papers::burning::{BlockCounts, Burning, NEEDS, Parameters, Texture, Variant};
use crate::scene::{Mesh, MeshSource};

/// What a user set up.
#[derive(Debug, Clone)]
pub struct Setup {
    pub parameters: Parameters,
    /// What burns.
    pub mesh: MeshSource,
    /// Factors of the mesh along x, y and z, each above 0 and at most 1000.
    pub stretch: Vec3,
    /// Triangles that the mesh is simplified or subdivided to, 4 to 4,000,000; as it is, without.
    pub triangles: Option<u32>,
    /// A PNG that covers the mesh by its texture coordinates, in place of the material.
    pub texture: Option<PathBuf>,
    pub preset: Option<String>,
}

impl Default for Setup {
    /// The scanned bunny.
    fn default() -> Self {
        let parameters = Parameters::default();
        Setup { parameters, mesh: MeshSource::Bunny, stretch: Vec3::ONE, triangles: None, texture: None, preset: None }
    }
}

/// A setup with its mesh loaded and brought to its count.
pub struct Scene {
    pub mesh: Mesh,
    pub texture: Option<Arc<Texture>>,
}

impl Setup {
    /// Checks what needs no mesh.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        self.parameters.validate()?;
        let stretch = self.stretch.to_array();
        let is_good = stretch.iter().all(|&factor| factor > 0.0 && factor <= 1000.0);
        let text = stretch.map(|factor| factor.to_string()).join(",");
        ParameterError::check(is_good, "--stretch", text, "each of x, y and z must be above 0 and at most 1000")?;
        let count = self.triangles.unwrap_or(4);
        ParameterError::check((4..=4_000_000).contains(&count), "--triangles", count, "must be 4 to 4000000")?;
        Ok(())
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
        let mut mesh = self.mesh.load()?;
        if self.stretch != Vec3::ONE {
            mesh = mesh.transformed(&Mat4::from_scale(self.stretch));
        }
        let mesh = match self.triangles {
            Some(count) => with_triangles(&mesh, count as usize),
            None => mesh,
        };
        let texture = match &self.texture {
            None => None,
            Some(path) if mesh.texture_coordinates.is_empty() => {
                return Err(Error::Input(format!(
                    "--texture {}: the mesh {} has no texture coordinates; give one that has, or leave the texture out",
                    path.display(),
                    self.mesh
                )));
            }
            Some(path) => Some(Arc::new(super::experiments::texture::load(path)?)),
        };
        Ok(Scene { mesh, texture })
    }

    fn make(
        &self,
        shaders: &ShaderLibrary,
        label: &str,
        scene: &Scene,
        variant: Variant,
    ) -> Result<Burning, gpu::Error> {
        let parameters = Parameters { texture: scene.texture.clone(), ..self.parameters.clone() };
        let made = Burning::new(shaders, label, variant, &parameters, &scene.mesh);
        made.map_err(|error| match (&error, &self.texture) {
            (gpu::Error::Limit { object, .. }, Some(path)) if *object == format!("{label}/texture") => {
                error.set_by(&format!("--texture {}", path.display()))
            }
            _ => error,
        })
    }

    fn identity(&self) -> Identity {
        Identity {
            preset: self.preset.clone(),
            width: self.parameters.width,
            height: self.parameters.height,
            seed: self.parameters.seed,
        }
    }

    fn config(&self, scene: &Scene, paper: &Burning) -> Map<String, Value> {
        let p = &self.parameters;
        let model = paper.model();
        let sources: Vec<_> = model.sources.iter().map(|s| s.to_array()).collect();
        entries([
            ("mesh", json!(self.mesh.to_string())),
            ("stretch", json!(self.stretch.to_array())),
            ("triangles", json!(scene.mesh.triangle_count())),
            ("levels", json!(model.levels)),
            ("edge", json!(p.edge)),
            ("source", json!(sources)),
            ("psi", json!(p.psi)),
            ("speed", json!(p.speed_per_s)),
            ("area_width", json!(p.width_of_areas)),
            ("flammability", json!(p.flammability)),
            ("epsilon", json!(p.epsilon)),
            ("beta", json!(p.beta)),
            ("rho", json!(p.rho)),
            ("phi", json!(p.phi)),
            ("gamma", json!(p.gamma)),
            ("spread", json!(p.spread)),
            ("omega", json!(p.omega)),
            ("chi", json!(p.chi)),
            ("upsilon", json!(p.upsilon)),
            ("floor", json!(model.floor)),
            ("retire_at", json!(p.retire_at)),
            ("blocks", json!(p.blocks)),
            ("active_limit", json!(p.active_limit)),
            ("time_division", json!(p.time_division)),
            ("preload", json!(p.preload)),
            ("keep_connected", json!(p.keep_connected)),
            ("fire", json!(p.fire)),
            ("smoke", json!(p.smoke)),
            ("particle_radius", json!(p.particle_radius)),
            ("lod", json!(p.level_of_detail)),
            ("material", json!(scene.texture.is_none().then(|| p.material.as_str()))),
            ("texture", json!(self.texture.as_ref().map(|path| path.display().to_string()))),
            ("albedo", json!(p.albedo.to_array())),
            ("shading", json!(p.shading.as_str())),
            ("camera", config::camera(paper.camera())),
            ("time_step", json!(p.time_step_s)),
            ("first_frame", json!(p.first_frame)),
        ])
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
}

/// What the device has counted by the last frame that was recorded, and the frame rate.
fn results(machine: &Machine, paper: &Burning, measurement: &Measurement) -> Result<Map<String, Value>, Error> {
    let model = paper.model();
    let look = super::experiments::course::look(machine, paper)?;
    let counts = look.counts;
    let blocks: Vec<BlockCounts> =
        bytemuck::pod_collect_to_vec(&read_buffer(&machine.device, &paper.buffers().blocks)?);
    let occupied = blocks.iter().filter(|block| block.live > 0).count();
    Ok(entries([
        ("frames_per_s", json!(median(&measurement.frame_ms).map(|ms| 1e3 / ms))),
        ("ticks", json!(counts.tick)),
        ("radius", json!(counts.radius)),
        ("vertices", json!(model.rest.len())),
        ("finest_triangles", json!(model.triangles.len())),
        ("coarse_triangles", json!(look.coarse)),
        ("refined_coarse_triangles", json!(look.refined)),
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
