//! The experiments of the `lava` paper: what a user set up, what a run says of itself, the figures.

use std::borrow::Cow;
use std::path::PathBuf;

use serde_json::{Map, Value, json};

use crate::gpu::{self, Feature, ShaderLibrary};
use crate::image::read_png;
use crate::measure::Error;
use crate::measure::Paper;
use crate::measure::bench::Built;
use crate::measure::config::{self, entries};
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::statistics::median;
use crate::measure::study::{Identity, Metrics, Study};
use crate::papers::lava::{Lava, NEEDS, Parameters, Particles, Rock, Shading, Variant};
use crate::scene::{Mesh, MeshSource};

/// What a user set up.
#[derive(Debug, Clone)]
pub struct Setup {
    pub parameters: Parameters,
    /// PNG of the rock texture; the built-in one without.
    pub rock: Option<PathBuf>,
    /// Polygon meshes in the simulation space, at their own size and place.
    pub objects: Vec<MeshSource>,
    pub preset: Option<String>,
}

impl Setup {
    /// Checks the parameters, and that what is drawn can be drawn together.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Input`].
    pub fn check(&self) -> Result<(), Error> {
        self.parameters.validate()?;
        match (self.objects.first(), self.parameters.shading) {
            (Some(object), Shading::Particles) => {
                let problem = "particles are points, without a surface that could hide it; choose another --shading";
                Err(Error::Input(format!("--object {object}: {problem}")))
            }
            _ => Ok(()),
        }
    }
}

/// A setup with its particles placed, its rock decoded and its objects loaded.
pub struct Scene {
    pub particles: Particles,
    pub rock: Cow<'static, Rock>,
    pub objects: Vec<Mesh>,
}

impl Study for Setup {
    const PAPER: &'static str = "lava";
    const NEEDS: &'static [Feature] = &NEEDS;

    type Variant = Variant;
    type Scene = Scene;
    type Paper = Lava;

    /// Checks the parameters, decodes the rock, places the particles and loads the objects. A rock that is no PNG is an
    /// [`Error::Image`].
    fn load(&self) -> Result<Scene, Error> {
        self.check()?;
        let rock = match &self.rock {
            None => Cow::Borrowed(Rock::built_in()),
            Some(path) => {
                let picture = read_png(path)?;
                let texels = picture.pixels().as_chunks().0.to_vec();
                let rock = Rock { width: picture.width(), height: picture.height(), texels };
                rock.validate().map_err(|e| Error::Input(format!("reading the rock {}: {e}", path.display())))?;
                Cow::Owned(rock)
            }
        };
        let objects = self.objects.iter().map(MeshSource::load).collect::<Result<_, _>>()?;
        Ok(Scene { particles: Particles::seeded(&self.parameters), rock, objects })
    }

    fn make(&self, shaders: &ShaderLibrary, label: &str, scene: &Scene, _: Variant) -> Result<Lava, gpu::Error> {
        Lava::new(shaders, label, &self.parameters, &scene.particles, &scene.rock, &scene.objects)
    }

    fn identity(&self) -> Identity {
        Identity {
            preset: self.preset.clone(),
            width: self.parameters.width,
            height: self.parameters.height,
            seed: self.parameters.seed,
        }
    }

    fn config(&self, _: &Scene, _: &Lava) -> Map<String, Value> {
        let p = &self.parameters;
        entries([
            ("space", json!(p.space_m.to_array())),
            ("particles", json!(p.particles)),
            ("radius", json!(p.radius_m)),
            ("density", json!(p.density)),
            ("rho", json!(p.rho())),
            ("splats", json!(p.splats)),
            ("splat_radius", json!(p.splat_radius_m)),
            ("epsilon", json!(p.epsilon_m)),
            ("border", json!(p.border_m)),
            ("speed", json!(p.speed_m_s)),
            ("color", json!(p.color.to_array())),
            ("rock", json!(self.rock.as_ref().map(|path| path.display().to_string()))),
            ("rock_tile", json!(p.rock_tile_m)),
            ("object", json!(self.objects.iter().map(ToString::to_string).collect::<Vec<_>>())),
            ("shading", json!(p.shading.as_str())),
            ("geometry_stage", json!(p.geometry_stage)),
            ("camera", config::camera(&p.camera)),
            ("time_step", json!(p.time_step_s)),
        ])
    }

    fn summary(&self) -> String {
        let p = &self.parameters;
        format!("{} particles, {} x {} splats", p.particles, p.splats[0], p.splats[1])
    }

    fn metrics(
        &self,
        machine: &mut Machine,
        measured: &mut [(Built<Self>, Measurement)],
    ) -> Result<Vec<Metrics>, Error> {
        let mut metrics = Vec::with_capacity(measured.len());
        for (built, measurement) in measured {
            let mut results = results(&self.parameters, &built.paper, measurement);
            results.extend(entries(super::experiments::floors::measure(machine, &built.paper)?));
            metrics.push(Metrics { results, warnings: built.paper.warnings() });
        }
        Ok(metrics)
    }
}

/// Work per second of the passes that do it: GPU time, and host time where the thesis leaves the work to the host.
fn results(parameters: &Parameters, paper: &Lava, measurement: &Measurement) -> Map<String, Value> {
    let time_s = |names: &[&str]| {
        let of = |name: &&str| {
            let pass = measurement.passes.iter().find(|p| p.info.name == *name)?;
            median(&pass.gpu_ms).or_else(|| median(&pass.host_ms))
        };
        let times: Vec<f64> = names.iter().map(of).collect::<Option<_>>()?;
        Some(times.iter().sum::<f64>() / 1e3).filter(|&s| s > 0.0)
    };
    let rate = |count: f64, names: &[&str]| json!(time_s(names).map(|s| count / s));
    let particles = f64::from(parameters.particles);
    let grid_points = parameters.density.iter().map(|&n| f64::from(n)).product::<f64>();
    let splats = parameters.splats.iter().map(|&n| f64::from(n)).product::<f64>();
    let frame_ms = median(&measurement.frame_ms);
    entries([
        ("frames_per_s", json!(frame_ms.map(|ms| 1e3 / ms))),
        ("accepted_grid_points", json!(paper.isosurface().accepted().len())),
        ("density_range", json!(paper.isosurface().density_range())),
        ("particles_per_s", rate(particles, &["animate", "cluster", "density"])),
        ("grid_points_per_s", rate(grid_points, &["density", "extract"])),
        ("splats_per_s", rate(splats, &["visibility", "blending"])),
    ])
}
