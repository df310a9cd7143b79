//! The experiments of the `caustics` paper: what a user set up, its scene, its measured runs.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec2, Mat4, UVec2, Vec2, Vec3};
use serde_json::{Map, Value as Json, json};

use super::axes;
use super::experiments::{self, Options};
use super::results;
use crate::field;
use crate::gpu::{self, Device, Feature, ShaderLibrary};
use crate::measure::Error;
use crate::measure::bench::Built;
use crate::measure::config::{self, entries};
use crate::measure::estimate::{DRAWN_BYTES, Estimate};
use crate::measure::experiment::Experiment;
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::parameter::{self, Cost, EyeAndTarget, Given, Parameter, Range, Shape, Value, one};
use crate::measure::stress::Axis;
use crate::measure::study::{Identity, Metrics, Preset, Study};
use crate::papers::caustics::{Caustics, DRAWN, NEEDS, Parameters, ReceiverInput, SmartPlacement, Variant, WaterMap};
use crate::scene::loading::CREASE_DEG;
use crate::scene::{Bounds, Camera, HeightMap, HeightMapSource, Light, MapOptions, MeshOptions, MeshSource, Samples};
use crate::scene::{promised_triangles, shapes};

/// Longest side in metres that a receiver is scaled to: the thesis gives no sizes, and waves of about a metre then play
/// over it.
const RECEIVER_SIZE_M: f32 = 2.0;
/// Gap between receivers in metres.
const GAP_M: f32 = 0.3;
/// Cells a side of the pool's floor: its map needs no more than its normals and edges.
const FLOOR_CELLS: u32 = 8;
/// Side of the pool's floor in receivers.
const FLOOR_SIZE: f32 = 3.0;
/// Distance of the pool's floor below the receivers' feet, metres.
const FLOOR_GAP_M: f32 = 1e-3 * RECEIVER_SIZE_M;
/// A far plane beyond which numbers in single precision tell nothing apart any more.
const FARTHEST_M: f64 = 1e9;

/// A user's choice of everything.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The numbers.
    pub parameters: Parameters,
    /// Receivers, at least one.
    pub meshes: Vec<MeshSource>,
    /// Crease angle of meshes without normals, degrees.
    pub crease_deg: f32,
    /// The pool's floor receives caustics as well.
    pub floor: bool,
    /// Name of the preset that it began with.
    pub preset: Option<String>,
    /// Directions of parallel light and places of point lights; the default light where there are neither.
    pub parallel_lights: Vec<Vec3>,
    /// Positions of point lights, metres.
    pub point_lights: Vec<Vec3>,
    /// Height map in place of the waves.
    pub water_map: Option<HeightMapSource>,
    /// Metres between its samples; those that it states where there are none.
    pub water_map_spacing_m: Option<f32>,
    /// Metres that its heights are scaled to span.
    pub water_map_range_m: Option<f32>,
    /// Side of the water that the picture is taken from.
    pub view: View,
    /// Names of the parameters that were given.
    pub given: Given,
}

/// Place of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum View {
    /// Above the water, through its surface.
    Above,
    /// Plainly under water.
    Below,
    At(EyeAndTarget),
}

impl Value for View {
    const SHAPE: Shape = Shape { placeholder: "above|below|EYE,TARGET", ..EyeAndTarget::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        match one(texts)? {
            "above" => Ok(View::Above),
            "below" => Ok(View::Below),
            _ => EyeAndTarget::parse(texts).map(View::At).map_err(|e| format!("above, below, or eye and target: {e}")),
        }
    }

    fn text(&self) -> String {
        match self {
            View::Above => "above".to_owned(),
            View::Below => "below".to_owned(),
            View::At(place) => place.text(),
        }
    }
}

impl Default for Setup {
    fn default() -> Self {
        Setup {
            parameters: Parameters::default(),
            meshes: vec![MeshSource::Teapot],
            crease_deg: CREASE_DEG,
            floor: false,
            preset: None,
            parallel_lights: Vec::new(),
            point_lights: Vec::new(),
            water_map: None,
            water_map_spacing_m: None,
            water_map_range_m: None,
            view: View::Above,
            given: Given::default(),
        }
    }
}

/// A setup with its meshes loaded and placed.
pub struct Scene {
    /// Receivers, placed.
    pub receivers: Vec<ReceiverInput>,
}

impl Study for Setup {
    const PAPER: &'static str = "caustics";
    const NEEDS: &'static [Feature] = &NEEDS;

    type Variant = Variant;
    type Scene = Scene;
    type Paper = Caustics;

    /// Checks the parameters, loads the meshes, scales each to two metres and stands it on the pool's floor, one beside
    /// the other.
    fn load(&self) -> Result<Scene, Error> {
        self.parameters.validate()?;
        let floor_m = -self.parameters.water_depth_m;
        let mut receivers = Vec::new();
        let mut next_x = 0.0;
        for source in &self.meshes {
            let mesh = source.load_with(&MeshOptions::to_draw(self.crease_deg))?;
            let bounds = mesh.bounds();
            let scale = RECEIVER_SIZE_M / bounds.diagonal().max_element();
            let size = bounds.diagonal() * scale;
            let foot = Vec3::new(bounds.min.x, bounds.min.y, bounds.center().z) * scale;
            let place =
                Mat4::from_translation(Vec3::new(next_x, floor_m, 0.0) - foot) * Mat4::from_scale(Vec3::splat(scale));
            next_x += size.x + GAP_M;
            receivers.push(ReceiverInput { mesh: mesh.placed(&place), albedo: Vec3::new(0.75, 0.75, 0.72) });
        }
        let width = next_x - GAP_M;
        let center = Mat4::from_translation(Vec3::new(-width / 2.0, 0.0, 0.0));
        for receiver in &mut receivers {
            receiver.mesh = std::mem::take(&mut receiver.mesh).placed(&center);
        }
        if self.floor {
            receivers.push(floor(&receivers, floor_m));
        }
        Ok(Scene { receivers })
    }

    fn reconfigure(&self, _: &Scene, paper: &mut Caustics, changed: &Given) -> Result<bool, Error> {
        if !changed.is_within(&DRAWN) {
            return Ok(false);
        }
        self.parameters.validate()?;
        Ok(paper.set_drawn(&self.parameters)?)
    }

    fn make(
        &self,
        shaders: &ShaderLibrary,
        label: &str,
        scene: &Scene,
        variant: Variant,
    ) -> Result<Caustics, gpu::Error> {
        let paper = Caustics::new(shaders, label, variant, &self.parameters, &scene.receivers)?;
        Ok(paper.given(self.given.clone()))
    }

    fn estimate(&self, _: &Device, scene: &Scene, variant: Variant) -> Estimate {
        self.parameters.estimate(variant, &scene.receivers)
    }

    fn promised_triangles(&self) -> Result<u64, Error> {
        Ok(promised_triangles(&self.meshes)?)
    }

    fn foresee(&self, triangles: u64, _: Variant) -> Estimate {
        Estimate { bytes: vec![("mesh", DRAWN_BYTES * triangles as f64)], ..Estimate::default() }
    }

    fn identity(&self) -> Identity {
        Identity::new(&self.preset, (self.parameters.width, self.parameters.height), self.parameters.seed)
    }

    fn summary(&self) -> String {
        format!("{} planes", self.parameters.planes)
    }

    fn metrics(
        &self,
        machine: &mut Machine,
        measured: &mut [(Built<Self>, Measurement)],
    ) -> Result<Vec<Metrics>, Error> {
        results::of_runs(machine, measured)
    }

    fn config(&self, scene: &Scene, paper: &Caustics) -> Map<String, Json> {
        let p = &self.parameters;
        let triangles: usize = scene.receivers.iter().map(|r| r.mesh.triangle_count()).sum();
        let lights: Vec<Json> = p.lights.iter().map(config::light).collect();
        let mut config = parameter::config(&Self::parameters(), self);
        config.extend(entries([
            ("receiver_triangles", json!(triangles)),
            ("water_triangles", json!(paper.grid().triangle_count())),
            ("water_map", json!(p.water_map.as_ref().map(map_value))),
            ("lights", json!(lights)),
            ("ambient", json!(p.ambient.to_array())),
            ("camera", config::camera(&p.camera)),
        ]));
        if p.water_map.is_some() {
            config.extend(["waves", "amplitude", "wavelength"].map(|name| (name.to_owned(), Json::Null)));
        }
        config
    }

    const ABOUT: &'static str = "Refractive water caustics with level maps (Tipprasert), pass by pass";
    // The stencil method takes seconds a frame without a GPU.
    const BENCHED: &'static [Variant] =
        &[Variant::LevelMap, Variant::LevelMapSmart, Variant::Culled, Variant::Hit, Variant::Volumetric];
    const RENDERED: Variant = Variant::LevelMap;
    const SHARED: &'static [&'static str] = &["5-1", "5-3", "appendix"];

    type Options = Options;

    fn parameters() -> Vec<Parameter<Self>> {
        let scene = [
            Parameter::new("mesh", field!(Setup.meshes))
                .help(
                    "Receiver: teapot, sphere, box, bunny, plane, or an OBJ, PLY, STL, glTF or GLB file, with :N divided into N \
                     triangles or more; its longest side is scaled to 2 m, and it stands on the pool's floor",
                )
                .default_text("teapot")
                .cost(Cost::Buffers)
                .everyday(),
            parameter::crease_angle(field!(Setup.crease_deg)),
            Parameter::new("floor", field!(Setup.floor))
                .help("The pool's floor receives caustics as well")
                .cost(Cost::Buffers),
        ];
        let water_and_light = [
            Parameter::new("water-map", field!(Setup.water_map))
                .help(
                    "Water by a height map in place of waves: volcano, maunga-whau, jacksboro, or a file; heights are metres \
                     about the water's level, within 10 m of it",
                )
                .excludes(&["waves", "amplitude", "wavelength"])
                .cost(Cost::Buffers),
            Parameter::new("water-map-spacing", field!(Setup.water_map_spacing_m))
                .range(Range::above(0.0))
                .unit("metres")
                .help("Distance between the samples of `water-map`")
                .default_text("what the map says of itself")
                .requires("water-map")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("water-map-range", field!(Setup.water_map_range_m))
                .range(Range::above(0.0))
                .unit("metres")
                .help("Scale `water-map` so that its heights span this much about the water's level")
                .requires("water-map")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("light", field!(Setup.parallel_lights))
                .help("Direction of parallel light, downwards")
                .section("4.2.1")
                .default_text("0,-1,0")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("point-light", field!(Setup.point_lights))
                .help("Place of a point light above the water, metres")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("camera", field!(Setup.view))
                .help(
                    "Camera: above (through the water's surface), below (plainly underwater), or eye and target x,y,z,x,y,z in \
                     metres, the water's level being y = 0",
                )
                .everyday(),
        ];
        let numbers =
            Parameters::declared().into_iter().map(|p| p.inside(|s: &Setup| &s.parameters, |s| &mut s.parameters));
        scene.into_iter().chain(numbers).chain(water_and_light).collect()
    }

    fn options() -> Vec<Parameter<Options>> {
        experiments::options()
    }

    fn presets() -> Vec<Preset<Self>> {
        vec![Preset {
            name: "5-1",
            help: "Table 5-1 and figure 5-10 at their last row: teapot, 101 planes, 512 x 512 maps",
            variant: None,
            setup: || {
                let numbers =
                    Parameters { planes: 101, map_size: 512, water_triangles: 10_000, ..Parameters::default() };
                Setup { parameters: numbers, ..Setup::default() }
            },
        }]
    }

    fn axes() -> Vec<Axis<Self>> {
        axes::all()
    }

    fn experiments() -> Vec<Experiment<Self>> {
        experiments::all()
    }

    /// The scanned mesh over the pool's floor.
    fn quick() -> Self {
        Setup { meshes: vec![MeshSource::Bunny], floor: true, ..Setup::default() }
    }

    fn preset_mut(&mut self) -> &mut Option<String> {
        &mut self.preset
    }

    fn resolve(&mut self, given: &Given) -> Result<(), Error> {
        self.given = given.clone();
        let p = &mut self.parameters;
        if p.smart.placement == SmartPlacement::Kept && given.has("epsilon") {
            let message = "`epsilon`: `smart-placement` kept keeps the uniform planes; leave one of them out";
            return Err(Error::Input(message.to_owned()));
        }
        parameter::check(&Self::parameters(), self)?;
        let p = &mut self.parameters;
        if let Some(source) = &self.water_map {
            p.water_map = Some(water_map(source, self.water_map_spacing_m, self.water_map_range_m)?);
        }
        let intensity = Vec3::ONE;
        let parallel = self.parallel_lights.iter().map(|&direction| Light::Parallel { direction, intensity });
        let points = self.point_lights.iter().map(|&position| Light::Point { position, intensity });
        let lights: Vec<Light> = parallel.chain(points).collect();
        if !lights.is_empty() {
            p.lights = lights;
        }
        let receivers = receivers_within(self.meshes.len(), self.floor, p.water_depth_m);
        p.camera = match self.view {
            View::Above => Parameters::camera_above(p.water_depth_m),
            View::Below => Parameters::camera_below(p.water_depth_m),
            View::At(EyeAndTarget { eye, target }) => {
                let camera = Camera { eye, target, ..Parameters::camera_above(p.water_depth_m) };
                reaching(camera, &receivers)
            }
        };
        Ok(())
    }
}

/// A box that holds so many receivers, whatever their shapes, and the pool's floor where it is one.
fn receivers_within(meshes: usize, has_floor: bool, depth_m: f32) -> Bounds {
    let width = meshes as f32 * (RECEIVER_SIZE_M + GAP_M) - GAP_M;
    let extent = Vec2::new(width, RECEIVER_SIZE_M);
    let half = if has_floor { floor_size(extent) } else { extent } / 2.0;
    let min = Vec3::new(-half.x, -depth_m - FLOOR_GAP_M, -half.y);
    Bounds { min, max: Vec3::new(half.x, RECEIVER_SIZE_M - depth_m, half.y) }
}

/// The camera with a far plane behind all `receivers`, and where that moves it a near plane that leaves the depth between them its
/// precision.
fn reaching(camera: Camera, receivers: &Bounds) -> Camera {
    let eye = camera.eye.as_dvec3();
    let (min, max) = (receivers.min.as_dvec3(), receivers.max.as_dvec3());
    let farthest_m = (eye - min).abs().max((eye - max).abs()).length();
    let nearest_m = eye.distance(eye.clamp(min, max));
    let far_m = (2.0 * farthest_m).min(FARTHEST_M);
    if far_m <= f64::from(camera.far_m) {
        return camera;
    }
    let near_m = (nearest_m / 2.0).min(far_m / 4.0).max(f64::from(camera.near_m));
    Camera { near_m: near_m as f32, far_m: far_m as f32, ..camera }
}

/// Water by a height map: its heights as they are, metres about the water's level, or scaled so that they span `range_m`
/// about it; samples as far apart as the map says, or `spacing_m`.
///
/// # Errors
/// [`Error::Scene`] for a map that cannot be read; [`Error::Input`] for a flat map that is to span a range.
pub fn water_map(source: &HeightMapSource, spacing_m: Option<f32>, range_m: Option<f32>) -> Result<WaterMap, Error> {
    let mut map = source.load_with(MapOptions { has_own_spacing: spacing_m.is_some(), ..MapOptions::default() })?;
    if let Some(range_m) = range_m {
        let (low, high) = map.range_m();
        let scale = range_m / (high - low);
        if !scale.is_finite() {
            return Err(Error::Input(format!("`water-map-range` {range_m}: {source} is flat; leave the range out")));
        }
        let middle = low + (high - low) / 2.0;
        let places = (0..map.height()).flat_map(|row| (0..map.width()).map(move |column| (column, row)));
        let heights = places.map(|(column, row)| (map.height_m(column, row) - middle) * scale).collect();
        map = HeightMap::new(map.width(), map.height(), Samples::Float(heights))?.with_spacing_m(map.spacing_m())?;
    }
    if let Some(spacing_m) = spacing_m {
        map = map.with_spacing_m(DVec2::splat(f64::from(spacing_m)))?;
    }
    Ok(WaterMap::new(source.to_string(), Arc::new(map)))
}

fn map_value(map: &WaterMap) -> Json {
    let heights = map.heights();
    let (low, high) = heights.range_m();
    json!({
        "name": map.name(), "columns": heights.width(), "rows": heights.height(),
        "spacing": heights.spacing_m().to_array(), "lowest": low, "highest": high,
    })
}

fn floor(receivers: &[ReceiverInput], floor_m: f32) -> ReceiverInput {
    let bounds = receivers.iter().map(|r| r.mesh.bounds()).reduce(|a, b| a.union(&b)).unwrap_or(Bounds::EMPTY);
    let size = floor_size(Vec2::new(bounds.diagonal().x, bounds.diagonal().z));
    let mesh = shapes::plane(size, UVec2::splat(FLOOR_CELLS));
    // Just below the feet, so that no receiver's underside fights with it for the picture's depth.
    let place = Mat4::from_translation(Vec3::new(0.0, floor_m - FLOOR_GAP_M, 0.0));
    ReceiverInput { mesh: mesh.placed(&place), albedo: Vec3::new(0.55, 0.62, 0.62) }
}

/// Sides along x and z of the pool's floor below receivers of that extent, metres.
fn floor_size(receivers: Vec2) -> Vec2 {
    Vec2::splat(FLOOR_SIZE * RECEIVER_SIZE_M).max(receivers * 1.6)
}

/// The thesis's meshes that we have, a scanned one, and a modelled one from `assets/` where that folder is.
pub fn sample_meshes() -> Vec<MeshSource> {
    let wuson = Some(PathBuf::from("assets/meshes/wuson.stl")).filter(|path| path.is_file());
    let built_in = [MeshSource::Teapot, MeshSource::Sphere, MeshSource::Bunny];
    built_in.into_iter().chain(wuson.map(MeshSource::File)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen_from(eye: Vec3, floor: bool) -> Camera {
        let view = View::At(EyeAndTarget { eye, target: Vec3::NEG_Y });
        let mut setup = Setup { view, floor, meshes: vec![MeshSource::Box; 3], ..Setup::default() };
        setup.resolve(&Given::default()).unwrap();
        setup.parameters.camera
    }

    #[test]
    fn a_camera_far_away_has_all_receivers_between_its_planes() {
        let usual = Parameters::camera_above(Parameters::default().water_depth_m);
        for floor in [false, true] {
            let setup = Setup { floor, meshes: vec![MeshSource::Box; 3], ..Setup::default() };
            let scene = setup.load().unwrap();
            let points: Vec<Vec3> = scene.receivers.iter().flat_map(|r| r.mesh.positions.iter().copied()).collect();
            for eye in [Vec3::new(0.0, 300.0, 1.0), Vec3::new(-2000.0, 1500.0, 800.0), Vec3::new(0.0, 1e8, 0.0)] {
                let camera = seen_from(eye, floor);
                camera.validate().unwrap();
                let distances = points.iter().map(|point| point.distance(eye));
                let farthest_m = distances.clone().fold(0.0, f32::max);
                assert!(camera.far_m > 1.99 * farthest_m, "{eye}: {camera:?}");
                assert!(distances.fold(f32::INFINITY, f32::min) > camera.near_m, "{eye}: {camera:?}");
            }
        }
        let near = seen_from(Vec3::new(4.0, 3.0, 5.0), true);
        assert_eq!((near.near_m, near.far_m), (usual.near_m, usual.far_m));
    }
}
