//! The experiments of the `terrain` paper: what a user set up, what a run says of itself, the table and the figures.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec2;
use serde_json::{Map, Value, json};

use crate::gpu::{self, Feature, ShaderLibrary};
use crate::image::read_png;
use crate::measure::Error;
use crate::measure::bench::Built;
use crate::measure::config::{self, entries};
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::statistics::median;
use crate::measure::study::{Identity, Metrics, Study};
use crate::measure::{Paper, ParameterError};
use crate::papers::terrain::{Base, Drape, Inputs, MapInput, NEEDS, Parameters, Placement, Terrain, Variant, View};
use crate::scene::{HeightMap, HeightMapSource, Mesh, MeshSource, volcano};

/// A user's configuration.
#[derive(Debug, Clone)]
pub struct Setup {
    pub parameters: Parameters,
    /// At least one.
    pub maps: Vec<PlacedMap>,
    /// Polygon objects in the maps' frame, metres: x east, y up from the base, z south.
    pub objects: Vec<MeshSource>,
    /// PNG over the first map, in place of the colour ramp.
    pub drape: Option<PathBuf>,
    /// Samples a side of the synthetic volcano.
    pub resolution: u32,
    /// Metres between samples, in place of what a map says of itself.
    pub spacing_m: Option<f64>,
    /// Factor of the heights.
    pub exaggeration: f32,
    /// Of the synthetic volcano.
    pub seed: u64,
    pub preset: Option<String>,
}

/// A map and where it lies.
#[derive(Debug, Clone)]
pub struct PlacedMap {
    pub source: HeightMapSource,
    pub placement: Placement,
}

impl Default for Setup {
    /// The synthetic volcano at 1024 x 1024 samples.
    fn default() -> Self {
        Setup {
            parameters: Parameters::default(),
            maps: vec![PlacedMap { source: HeightMapSource::Volcano, placement: Placement::default() }],
            objects: Vec::new(),
            drape: None,
            resolution: HeightMapSource::VOLCANO_SIDE,
            spacing_m: None,
            exaggeration: 1.0,
            seed: 1,
            preset: None,
        }
    }
}

/// A setup with its maps, objects and drape loaded.
pub struct Scene {
    pub maps: Vec<MapInput>,
    pub objects: Vec<Mesh>,
    pub drape: Option<Drape>,
}

impl Setup {
    /// Checks what needs no map.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        self.parameters.validate()?;
        let count = self.maps.len();
        ParameterError::check(count <= Inputs::MAPS, "--map", count, "are too many; at most 16 are united")?;
        let check = |good, name, value: f64, range| ParameterError::check(good, name, value, range);
        let sides = HeightMap::SIDE;
        let range = format!("must be {} to {} samples a side", sides.start(), sides.end());
        check(sides.contains(&self.resolution), "--resolution", self.resolution.into(), &range)?;
        let spacing_m = self.spacing_m.unwrap_or(1.0);
        check((1e-6..=1e6).contains(&spacing_m), "--spacing", spacing_m, "must be 0.000001 to 1000000 metres")?;
        let exaggeration = self.exaggeration.into();
        check((1e-3..=1e3).contains(&exaggeration), "--exaggeration", exaggeration, "must be 0.001 to 1000")?;
        Ok(())
    }

    /// Names the map that the device or the variant cannot hold: the paper calls it by its number.
    fn name_map(&self, label: &str, error: gpu::Error) -> gpu::Error {
        let gpu::Error::Limit { object, .. } = &error else { return error };
        let is_of = |number: &usize| object.starts_with(&format!("{label}/map-{number}/"));
        match (0..self.maps.len()).find(is_of) {
            Some(number) => error.set_by(&format!("--map {}", self.maps[number].source)),
            None => error,
        }
    }

    fn load_map(&self, source: &HeightMapSource) -> Result<HeightMap, Error> {
        let mut map = match source {
            HeightMapSource::Volcano => volcano(self.resolution, self.seed)?,
            other => other.load()?,
        };
        if let Some(spacing_m) = self.spacing_m {
            map = map.with_spacing_m(DVec2::splat(spacing_m))?;
        }
        if self.exaggeration != 1.0 {
            map = map.with_exaggeration(self.exaggeration)?;
        }
        Ok(map)
    }
}

impl Study for Setup {
    const PAPER: &'static str = "terrain";
    const NEEDS: &'static [Feature] = &NEEDS;

    type Variant = Variant;
    type Scene = Scene;
    type Paper = Terrain;

    /// Checks the parameters and loads the maps, the objects and the drape.
    fn load(&self) -> Result<Scene, Error> {
        self.check()?;
        for placed in &self.maps {
            self.parameters.validate_placement(&placed.placement)?;
        }
        let input = |placed: &PlacedMap| -> Result<MapInput, Error> {
            Ok(MapInput { map: Arc::new(self.load_map(&placed.source)?), placement: placed.placement })
        };
        let drape = self.drape.as_ref().map(|path| -> Result<Drape, Error> {
            let picture = read_png(path)?;
            let texels = picture.pixels().as_chunks().0.to_vec();
            Ok(Drape::new(picture.width(), picture.height(), texels)?)
        });
        Ok(Scene {
            maps: self.maps.iter().map(input).collect::<Result<_, _>>()?,
            objects: self.objects.iter().map(|source| source.load()).collect::<Result<_, _>>()?,
            drape: drape.transpose()?,
        })
    }

    fn make(
        &self,
        shaders: &ShaderLibrary,
        label: &str,
        scene: &Scene,
        variant: Variant,
    ) -> Result<Terrain, gpu::Error> {
        let inputs = Inputs { maps: &scene.maps, objects: &scene.objects, drape: scene.drape.as_ref() };
        Terrain::new(shaders, label, variant, &self.parameters, &inputs).map_err(|error| self.name_map(label, error))
    }

    fn identity(&self) -> Identity {
        Identity {
            preset: self.preset.clone(),
            width: self.parameters.width,
            height: self.parameters.height,
            seed: self.seed,
        }
    }

    fn config(&self, scene: &Scene, _: &Terrain) -> Map<String, Value> {
        let p = &self.parameters;
        let maps: Vec<Value> = self
            .maps
            .iter()
            .zip(&scene.maps)
            .map(|(placed, input)| {
                let Placement { center_m, turn_rad } = placed.placement;
                json!({
                    "source": placed.source.to_string(), "samples": [input.map.width(), input.map.height()],
                    "spacing": input.map.spacing_m().to_array(), "voids_filled": input.map.voids_filled(),
                    "place": [center_m.x, center_m.y, turn_rad.to_degrees()],
                })
            })
            .collect();
        let first = scene.maps.first().map(|input| input.map.width().max(input.map.height()));
        let view = match p.view {
            View::Side => json!("side"),
            View::Top => json!("top"),
            View::Camera(camera) => config::camera(&camera),
        };
        let base = match p.base {
            Base::Plane => json!("plane"),
            Base::Ellipsoid { equatorial_m, polar_m } => json!({"ellipsoid": [equatorial_m, polar_m]}),
            Base::Cylinder { radius_m } => json!({"cylinder": radius_m}),
        };
        entries([
            ("resolution", json!(first)),
            ("maps", json!(maps)),
            ("exaggeration", json!(self.exaggeration)),
            ("object", json!(self.objects.iter().map(ToString::to_string).collect::<Vec<_>>())),
            ("drape", json!(self.drape.as_ref().map(|path| path.display().to_string()))),
            ("shadows", json!(p.shadows)),
            ("lod", json!(p.lod.as_str())),
            ("interpolation", json!(p.interpolation.as_str())),
            ("base", base),
            ("base_level", json!(p.base_level_m)),
            ("camera", view),
            ("sun", json!([p.sun.azimuth_rad.to_degrees(), p.sun.elevation_rad.to_degrees()])),
            ("haze", json!(p.haze_per_km)),
        ])
    }

    fn summary(&self) -> String {
        let maps: Vec<String> = self.maps.iter().map(|placed| placed.source.to_string()).collect();
        format!("{}, {} samples a side", maps.join(" + "), self.resolution)
    }

    fn metrics(
        &self,
        machine: &mut Machine,
        measured: &mut [(Built<Self>, Measurement)],
    ) -> Result<Vec<Metrics>, Error> {
        let rays = f64::from(self.parameters.width) * f64::from(self.parameters.height);
        let mut metrics = Vec::new();
        for (built, measurement) in measured {
            let frame_ms = median(&measurement.frame_ms).filter(|&ms| ms > 0.0);
            let census = super::experiments::figures::census(machine, &mut built.paper)?;
            // A rasterised grid has no steps.
            let steps = (built.variant != Variant::Mesh).then(|| census.steps_per_ray());
            let results = entries([
                ("mrays_per_s", json!(frame_ms.map(|ms| rays / ms / 1e3))),
                ("steps_per_ray", json!(steps)),
                ("hit_share", json!(census.hit_fraction())),
            ]);
            metrics.push(Metrics { results, warnings: built.paper.warnings() });
        }
        Ok(metrics)
    }
}
