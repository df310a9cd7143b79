//! The experiments of the `gas` paper: what a user set up, what a run says of itself, the tables and the figures.

use glam::Vec3;
use serde_json::{Map, Value, json};

use crate::gpu::{self, Feature, ShaderLibrary};
use crate::measure::Error;
use crate::measure::Paper;
use crate::measure::bench::Built;
use crate::measure::config::{self, entries};
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::statistics::median;
use crate::measure::study::{Identity, Metrics, Study};
use crate::papers::gas::model::Object;
use crate::papers::gas::parameters::validate_object;
use crate::papers::gas::scenes::Preset;
use crate::papers::gas::{Gas, NEEDS, Parameters, Variant};
use crate::scene::MeshSource;

/// What a user set up.
#[derive(Debug, Clone)]
pub struct Setup {
    pub parameters: Parameters,
    /// Whose surfaces there are.
    pub scene: Preset,
    /// Polygon meshes that stand in the scene beside its own surfaces, at their own size.
    pub objects: Vec<MeshSource>,
    pub preset: Option<String>,
}

impl Setup {
    /// A figure's scene with its numbers, held in a frame in which there is gas.
    pub fn of(scene: Preset) -> Self {
        let mut parameters = scene.scene().parameters;
        parameters.first_frame = scene.bench_frame();
        parameters.frame_step = 0;
        Setup { parameters, scene, objects: Vec::new(), preset: Some(scene.as_str().to_owned()) }
    }
}

/// A setup with its surfaces.
pub struct Scene {
    pub objects: Vec<Object>,
}

impl Study for Setup {
    const PAPER: &'static str = "gas";
    const NEEDS: &'static [Feature] = &NEEDS;

    type Variant = Variant;
    type Scene = Scene;
    type Paper = Gas;

    /// Checks the parameters, models the scene's surfaces and loads the user's.
    fn load(&self) -> Result<Scene, Error> {
        self.parameters.validate()?;
        let mut objects = self.scene.scene().objects;
        for source in &self.objects {
            objects.push(Object::new(source.load()?, Vec3::splat(0.6)));
        }
        objects.iter().try_for_each(validate_object)?;
        Ok(Scene { objects })
    }

    fn make(&self, shaders: &ShaderLibrary, label: &str, scene: &Scene, variant: Variant) -> Result<Gas, gpu::Error> {
        Gas::new(shaders, label, variant, &self.parameters, &scene.objects, None)
    }

    fn identity(&self) -> Identity {
        Identity {
            preset: self.preset.clone(),
            width: self.parameters.width,
            height: self.parameters.height,
            seed: self.parameters.seed,
        }
    }

    fn config(&self, scene: &Scene, _: &Gas) -> Map<String, Value> {
        let p = &self.parameters;
        let triangles: usize = scene.objects.iter().map(|o| o.mesh.triangle_count()).sum();
        let volumes: Vec<Value> = p
            .volumes
            .iter()
            .map(|v| {
                json!({
                    "shape": format!("{:?}", v.shape), "center": v.center.to_array(),
                    "half_extent": v.half_extent_m.to_array(), "falloff": v.falloff, "solid": v.is_solid,
                    "density": format!("{:?}", v.texture.function), "opaque": v.texture.opaque,
                    "power": v.texture.power, "texture_scale": v.texture.scale_per_m,
                    "tau": v.tau_per_m, "albedo": v.albedo.to_array(), "phase": v.phase.map(|f| [f.weight, f.g]),
                })
            })
            .collect();
        let objects: Vec<String> = self.objects.iter().map(ToString::to_string).collect();
        entries([
            ("scene", json!(self.scene.as_str())),
            ("object", json!(objects)),
            ("triangles", json!(triangles)),
            ("volumes", json!(volumes)),
            ("lights", json!(p.lights.iter().map(config::light).collect::<Vec<_>>())),
            ("ambient", json!(p.ambient.to_array())),
            ("background", json!(p.background.to_array())),
            ("steps", json!(p.steps)),
            ("table", json!(p.table_size)),
            ("pixel_size", json!(p.pixel_size)),
            ("shadow_threshold", json!(p.shadow_threshold)),
            ("early_end", json!(p.early_end)),
            ("first_frame", json!(p.first_frame)),
            ("frame_step", json!(p.frame_step)),
            ("camera", config::camera(&p.camera)),
        ])
    }

    fn summary(&self) -> String {
        format!("{}, frame {}", self.scene.as_str(), self.parameters.first_frame)
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
            let surfaces_ms = gpu_ms(&["fragments", "sort", "resolve"]);
            let results = entries([
                ("fragments", json!(demand.fragments)),
                ("sections", json!(demand.sections)),
                ("rows", json!(demand.rows)),
                ("surfaces_ms", json!(Some(surfaces_ms).filter(|&ms| ms > 0.0))),
            ]);
            metrics.push(Metrics { results, warnings: built.paper.warnings() });
        }
        Ok(metrics)
    }
}
