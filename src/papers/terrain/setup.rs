//! A user's configuration of the `terrain` paper: its declaration, its scene, its measured runs.

use std::sync::Arc;

use glam::DVec2;
use serde_json::{Map, Value as Json, json};

use super::experiments::figures::fractions;
use super::experiments::{self, Options, figures};
use super::{axes, streaming};
use crate::field;
use crate::gpu::{self, Device, Feature, ShaderLibrary};
use crate::measure::bench::Built;
use crate::measure::config::{add_object_triangles, entries};
use crate::measure::estimate::{DRAWN_BYTES, Estimate};
use crate::measure::experiment::Experiment;
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::parameter::{self, Choice, Cost, Given, Parameter, Range};
use crate::measure::statistics::median;
use crate::measure::stress::{Axis, host_memory};
use crate::measure::study::{Identity, Metrics, Preset, Study};
use crate::measure::{Error, Paper, ParameterError};
use crate::papers::terrain::{
    Collider, Drape, DrapeSource, Draping, Inputs, Interpolation, MapInput, NEEDS, ObjectSource, Parameters, Placement,
    Terrain, TileCounts, TileFile, Variant, View, WRITTEN,
};
use crate::scene::loading::CREASE_DEG;
use crate::scene::{HeightMap, HeightMapSource, MapOptions, Mesh, Voids, promised_triangles, volcano};

/// Samples a side that the images of many devices hold.
const LARGE_SIDE: u32 = 16_384;

/// A user's configuration.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The numbers.
    pub parameters: Parameters,
    /// At least one.
    pub maps: Vec<HeightMapSource>,
    /// Of each map: metres east and south of the origin, degrees counterclockwise; 0 where there are none.
    pub places: Vec<[f32; 3]>,
    /// Polygon objects in the maps' frame, metres: x east, y up from the base, z south.
    pub objects: Vec<ObjectSource>,
    /// Crease angle of meshes without normals, degrees.
    pub crease_deg: f32,
    /// The drape over the terrain in place of the colour ramp.
    pub drape: Option<DrapeSource>,
    /// Heights for the samples that maps leave void.
    pub voids: Voids,
    /// Maps are not held: their tiles are read from files that are made once.
    pub streams: bool,
    /// Overview of GeoTIFF maps in place of their data, from 1, the finest, on; 0 for the data.
    pub overview: u32,
    /// Samples a side of the synthetic volcano.
    pub resolution: u32,
    /// Metres between samples, in place of what a map says of itself.
    pub spacing_m: Option<f32>,
    /// Factor of the heights.
    pub exaggeration: f32,
    /// Of the synthetic volcano.
    pub seed: u64,
    /// Name of the preset or the experiment.
    pub preset: Option<String>,
    /// Names of the parameters that were given.
    pub given: Given,
}

impl Default for Setup {
    /// The synthetic volcano at 1024 x 1024 samples.
    fn default() -> Self {
        Setup {
            parameters: Parameters::default(),
            maps: vec![HeightMapSource::Volcano],
            places: Vec::new(),
            objects: Vec::new(),
            crease_deg: CREASE_DEG,
            drape: None,
            voids: Voids::Fill,
            streams: false,
            overview: 0,
            resolution: HeightMapSource::VOLCANO_SIDE,
            spacing_m: None,
            exaggeration: 1.0,
            seed: 1,
            preset: None,
            given: Given::default(),
        }
    }
}

fn tile_results(counts: TileCounts) -> Json {
    let TileCounts { tiles, held, missing, loaded, exchanges, loading_ms, is_cut: _ } = counts;
    json!({
        "tiles": tiles, "held": held, "missing": missing, "loaded": loaded, "exchanges": exchanges, "loading_ms": loading_ms,
    })
}

/// A setup with its maps, objects and drape loaded.
pub struct Scene {
    /// In the order in which they were named.
    pub maps: Vec<MapInput>,
    /// Polygon objects in the maps' frame.
    pub objects: Vec<Mesh>,
    /// The drape over the terrain, loaded.
    pub drape: Option<Drape>,
    /// Of each map where none is held.
    pub tiles: Vec<Arc<TileFile>>,
}

impl Scene {
    fn inputs(&self) -> Inputs<'_> {
        let Scene { maps, objects, drape, tiles } = self;
        Inputs { maps, objects, drape: drape.as_ref(), tiles }
    }
}

impl Setup {
    /// Checks everything that needs no map.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        parameter::check(&Self::parameters(), self)?;
        self.parameters.validate()?;
        let count = self.maps.len();
        ParameterError::check(count <= Inputs::MAPS, "map", count, "are too many; at most 16 are united")?;
        self.placements().try_for_each(|placement| self.parameters.validate_placement(&placement))?;
        Ok(())
    }

    /// The place of each map.
    pub(super) fn placements(&self) -> impl Iterator<Item = Placement> {
        let place = |[east, south, degrees]: [f32; 3]| Placement {
            center_m: DVec2::new(east.into(), south.into()),
            yaw_rad: f64::from(degrees).to_radians(),
        };
        self.maps.iter().enumerate().map(move |(i, _)| place(self.places.get(i).copied().unwrap_or_default()))
    }

    /// Names the map that the device or the variant cannot hold: the paper calls it by its number.
    fn name_map(&self, label: &str, error: gpu::Error) -> gpu::Error {
        let gpu::Error::Limit { object, what, wanted, limit } = error else { return error };
        let maps = self.maps.iter().enumerate();
        let found = maps.into_iter().find(|(number, _)| object.starts_with(&format!("{label}/map-{number}/")));
        let object = found.map_or(object.clone(), |(_, source)| format!("{object} (`map` {source})"));
        gpu::Error::Limit { object, what, wanted, limit }
    }

    /// The objects in their places; those that stand on the ground look for it there.
    fn stand(&self, maps: &[MapInput]) -> Result<Vec<Mesh>, Error> {
        let meshes = self.objects.iter().map(|object| object.load(self.crease_deg)).collect::<Result<Vec<_>, _>>()?;
        if self.objects.iter().all(|object| object.place.is_none()) {
            return Ok(meshes);
        }
        let collider = Collider::new(&self.parameters, &Inputs { maps, ..Inputs::default() });
        let place = |(object, mesh): (&ObjectSource, Mesh)| {
            let Some(stand) = &object.place else { return Ok(mesh) };
            let placed = stand.place(&mesh, &collider);
            if placed.is_within_reach() {
                return Ok(placed);
            }
            let most_m = Mesh::MOST_COORDINATE;
            Err(Error::Input(format!("`object` {object}: its coordinates are beyond {most_m:e} metres; scale it down")))
        };
        self.objects.iter().zip(meshes).map(place).collect()
    }

    /// Triangles of a synthetic volcano that is larger than most devices' images.
    fn promised_cells(&self) -> u64 {
        let is_large = (LARGE_SIDE + 1..=*HeightMap::SIDE.end()).contains(&self.resolution)
            && self.maps.contains(&HeightMapSource::Volcano);
        if is_large { 2 * u64::from(self.resolution).pow(2) } else { 0 }
    }

    /// Refuses a large volcano whose samples, and the levels above them, this machine has no memory for.
    fn check_host_memory(&self) -> Result<(), Error> {
        let needed = u64::from(self.resolution).pow(2) * size_of::<u16>() as u64 * 4 / 3;
        match host_memory::available_bytes() {
            Some(available) if self.resolution > LARGE_SIDE && needed > available => Err(Error::Input(format!(
                "`resolution` {}: its levels take {} MiB, and this machine has {} MiB left; lower it",
                self.resolution,
                needed >> 20,
                available >> 20
            ))),
            _ => Ok(()),
        }
    }

    pub(super) fn map_options(&self) -> MapOptions {
        MapOptions { overview: self.overview, has_own_spacing: self.spacing_m.is_some(), ..MapOptions::default() }
    }

    pub(super) fn load_map(&self, source: &HeightMapSource) -> Result<HeightMap, Error> {
        let mut map = match source {
            HeightMapSource::Volcano => {
                self.check_host_memory()?;
                volcano(self.resolution, self.seed)?
            }
            other => other.load_with(self.map_options())?,
        };
        if let Voids::Level(_) = self.voids {
            map = map.with_voids(self.voids, 0.0)?;
        }
        if let Some(spacing_m) = self.spacing_m {
            map = map.with_spacing_m(DVec2::splat(spacing_m.into()))?;
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
        let drape = self.drape.as_ref().map(DrapeSource::read).transpose()?;
        if self.streams {
            return streaming::load(self, drape);
        }
        let mut maps = self.maps.iter().map(|source| self.load_map(source)).collect::<Result<Vec<_>, _>>()?;
        if self.voids == Voids::Hole {
            let lowest_m = maps.iter().map(|map| map.range_m().0).fold(f32::INFINITY, f32::min);
            let base_m = self.parameters.base_level_m.unwrap_or(lowest_m);
            maps = maps.into_iter().map(|map| map.with_voids(Voids::Hole, base_m)).collect::<Result<_, _>>()?;
        }
        let input = |(map, placement)| MapInput { map: Arc::new(map), placement };
        let maps: Vec<MapInput> = maps.into_iter().zip(self.placements()).map(input).collect();
        let objects = self.stand(&maps)?;
        let bare: Vec<&HeightMap> = maps.iter().map(|input| &*input.map).collect();
        let drape = drape.map(|drape| drape.over(&bare, self.exaggeration)).transpose()?;
        Ok(Scene { maps, objects, drape, tiles: Vec::new() })
    }

    fn reconfigure(&self, _: &Scene, paper: &mut Terrain, changed: &Given) -> Result<bool, Error> {
        if !changed.is_within(&WRITTEN) {
            return Ok(false);
        }
        self.check()?;
        paper.set_written(&self.parameters);
        Ok(true)
    }

    fn make(
        &self,
        shaders: &ShaderLibrary,
        label: &str,
        scene: &Scene,
        variant: Variant,
    ) -> Result<Terrain, gpu::Error> {
        let inputs = scene.inputs();
        let terrain = Terrain::new(shaders, label, variant, &self.parameters, &inputs);
        terrain.map(|terrain| terrain.given(self.given.clone())).map_err(|error| self.name_map(label, error))
    }

    fn estimate(&self, device: &Device, scene: &Scene, variant: Variant) -> Estimate {
        let inputs = scene.inputs();
        let map = if self.maps.contains(&HeightMapSource::Volcano) { "resolution" } else { "map" };
        self.parameters.estimate(device, variant, &inputs, map)
    }

    fn promised_triangles(&self) -> Result<u64, Error> {
        Ok(promised_triangles(self.objects.iter().map(|object| &object.mesh))? + self.promised_cells())
    }

    fn foresee(&self, triangles: u64, variant: Variant) -> Estimate {
        let cells = self.promised_cells();
        // The samples and at least one layer of coarser levels, of 16 bits.
        let whole = if variant.holds_whole_maps() { 2.0 * cells as f64 } else { 0.0 };
        let objects = DRAWN_BYTES * triangles.saturating_sub(cells) as f64;
        Estimate { bytes: vec![("object", objects), ("resolution", whole)], ..Estimate::default() }
    }

    fn identity(&self) -> Identity {
        Identity::new(&self.preset, (self.parameters.width, self.parameters.height), self.seed)
    }

    fn config(&self, scene: &Scene, terrain: &Terrain) -> Map<String, Json> {
        let map = |(source, input): (&HeightMapSource, &MapInput)| {
            let Placement { center_m, yaw_rad } = input.placement;
            json!({
                "source": source.to_string(), "samples": [input.map.width(), input.map.height()],
                "spacing": input.map.spacing_m().to_array(), "voids": input.map.voids(), "void_share": input.map.void_fraction(),
                "voids_filled": if self.voids == Voids::Fill { input.map.voids() } else { 0 },
                "place": [center_m.x, center_m.y, yaw_rad.to_degrees()],
            })
        };
        let maps: Vec<Json> = self.maps.iter().zip(&scene.maps).map(map).collect();
        let first = scene.maps.first().map(|input| input.map.width().max(input.map.height()));
        let mut config = parameter::config(&Self::parameters(), self);
        let haze = terrain.extinction_per_km();
        config.extend(entries([("resolution", json!(first)), ("maps", json!(maps)), ("haze", json!(haze))]));
        if let Some(Draping::Contours { interval_m }) = scene.drape.as_ref().map(Drape::draping) {
            config.insert("contour_interval".to_owned(), json!(interval_m / self.exaggeration));
        }
        add_object_triangles(&mut config, &scene.objects);
        config
    }

    fn summary(&self) -> String {
        let maps: Vec<String> = self.maps.iter().map(ToString::to_string).collect();
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
            let census = figures::census(machine, &mut built.paper)?;
            let levels = built.paper.patches().map_or_else(|| census.levels(), |patches| fractions(&patches));
            // Triangles have no steps.
            let steps = (!built.variant.is_rasterised()).then(|| census.steps_per_ray());
            let results = entries([
                ("mrays_per_s", json!(frame_ms.map(|ms| rays / ms / 1e3))),
                ("steps_per_ray", json!(steps)),
                ("hit_share", json!(census.hit_fraction())),
                ("patches", json!(built.paper.patches().map(|patches| patches.iter().sum::<u64>()))),
                ("levels", json!(levels)),
                ("corners", json!(built.paper.corners().map(Choice::name))),
                ("tiles", json!(built.paper.tiles().map(tile_results))),
            ]);
            metrics.push(Metrics { results, warnings: built.paper.warnings() });
        }
        Ok(metrics)
    }

    const ABOUT: &'static str = "The volcano paper's terrain, ray-cast from a shape texture (Vyatkin), pass by pass";
    const BENCHED: &'static [Variant] = Variant::PAPER;
    const RENDERED: Variant = Variant::GpuCompute;
    const SHARED: &'static [&'static str] = &["1", "screen", "steps", "interpolation"];

    type Options = Options;

    fn parameters() -> Vec<Parameter<Self>> {
        let maps = [
            Parameter::new("map", field!(Setup.maps))
                .help(
                    "Height map: volcano, maunga-whau, jacksboro, or a .hgt, .hdr with .bil or .dem, .tif, .png or .asc file, a .vrt \
                     mosaic of such files, or a folder of .hgt files that lie side by side; the terrains of several are united",
                )
                .cost(Cost::Buffers)
                .everyday()
                .unrecorded(),
            Parameter::new("place", field!(Setup.places))
                .placeholder("EAST,SOUTH,DEGREES")
                .help(
                    "Place of a map's middle: metres east and south of the origin, degrees counterclockwise; once for \
                     each map",
                )
                .default_text("0,0,0")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("resolution", field!(Setup.resolution))
                .range(Range::from(*HeightMap::SIDE.start() as f64).to(*HeightMap::SIDE.end() as f64))
                .unit("samples a side")
                .help("Size of the synthetic volcano")
                .cost(Cost::Buffers)
                .everyday()
                .unrecorded(),
            Parameter::new("spacing", field!(Setup.spacing_m))
                .range(Range::from(*HeightMap::SPACING_M.start()).to(*HeightMap::SPACING_M.end()))
                .unit("metres")
                .help("Distance between samples")
                .default_text("what the map says of itself")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("exaggeration", field!(Setup.exaggeration))
                .range(Range::from(1e-3).to(1e3))
                .help("Factor of the heights")
                .cost(Cost::Buffers),
            Parameter::new("voids", field!(Setup.voids))
                .help(
                    "Samples without a height: fill, from their neighbours; level:M, at M metres; hole, no terrain, so that the \
                     base is seen",
                )
                .cost(Cost::Buffers),
            Parameter::new("overview", field!(Setup.overview))
                .range(Range::from(0.0).to(31.0))
                .help("Overview of GeoTIFF maps in place of the data: 1 the finest that they have, 0 the data")
                .cost(Cost::Buffers),
            Parameter::new("stream", field!(Setup.streams))
                .help(
                    "Hold no map: read tiles from a file of them, made once in the cache of the user's folder; for variant \
                     tiled-compute",
                )
                .cost(Cost::Buffers),
            Parameter::new("seed", field!(Setup.seed))
                .help("Seed of the synthetic volcano")
                .cost(Cost::Buffers)
                .unrecorded(),
        ];
        let scene = [
            Parameter::new("object", field!(Setup.objects))
                .help(
                    "Polygon mesh in the maps' frame, metres (x east, y up from the base, z south): teapot, sphere, box, \
                     bunny, plane, or an OBJ, PLY, STL, glTF or GLB file; with a place, it stands on the ground there, \
                     turned counterclockwise and scaled",
                )
                .section("1")
                .cost(Cost::Buffers),
            parameter::crease_angle(field!(Setup.crease_deg)),
            Parameter::new("drape", field!(Setup.drape))
                .help(
                    "Over the terrain in place of the colour ramp: a picture over the first map, PNG, north up, where a world file \
                     beside it (.pgw or .wld) says, in the map's own coordinates, or without one its corners on the map's; \
                     contours, lines of equal height over the ramp, M metres apart or at most 25 of them, every fifth wide; slope, \
                     colours by the angle of the surface, 0 to 60 degrees; hypsometric, an atlas's colours by height, blue below 0 m",
                )
                .cost(Cost::Buffers),
        ];
        let numbers =
            Parameters::declared().into_iter().map(|p| p.inside(|s: &Setup| &s.parameters, |s| &mut s.parameters));
        maps.into_iter().map(|p| p.group("Terrain")).chain(scene).chain(numbers).collect()
    }

    fn options() -> Vec<Parameter<Options>> {
        experiments::options()
    }

    fn presets() -> Vec<Preset<Self>> {
        let preset = |name, help, setup| Preset { name, help, variant: None, setup };
        vec![
            preset("figure-1", "Figure 1: 200 x 200 samples from above", || Setup::figure(View::Top)),
            preset("figure-2", "Figure 2: 200 x 200 samples from the side", || Setup::figure(View::Side)),
        ]
    }

    fn axes() -> Vec<Axis<Self>> {
        axes::all()
    }

    fn experiments() -> Vec<Experiment<Self>> {
        experiments::all()
    }

    fn verbs() -> Vec<Experiment<Self>> {
        experiments::verbs()
    }

    fn quick() -> Self {
        Setup::default()
    }

    fn preset_mut(&mut self) -> &mut Option<String> {
        &mut self.preset
    }

    fn resolve(&mut self, given: &Given) -> Result<(), Error> {
        self.given = given.clone();
        let (places, maps) = (self.places.len(), self.maps.len());
        if places > maps {
            return Err(Error::Input(format!("`place`: {places} places for {maps} maps; give one for each")));
        }
        if given.has("resolution") && !self.maps.contains(&HeightMapSource::Volcano) {
            let resolution = self.resolution;
            let reason = "only the synthetic volcano has any size; name `map` volcano";
            return Err(Error::Input(format!("`resolution` {resolution}: {reason}")));
        }
        if self.overview > 0 && self.maps.contains(&HeightMapSource::Volcano) {
            let reason = "only a GeoTIFF has any, and the synthetic volcano is none; name another `map`";
            return Err(Error::Input(format!("`overview` {}: {reason}", self.overview)));
        }
        Ok(())
    }
}

impl Setup {
    /// The volcano of figures 1 and 2.
    fn figure(view: View) -> Self {
        let parameters = Parameters { view, interpolation: Interpolation::Bilinear, ..Parameters::default() };
        Setup { parameters, resolution: figures::SIDE, ..Setup::default() }
    }
}
