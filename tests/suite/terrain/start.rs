//! Rays that begin where the beam of their tile may first meet the map: nothing may be seen of it but in the steps.

use std::sync::Arc;

use fumarole::gpu::{Compiler, Device, Mode, Recorder};
use fumarole::image::Samples;
use fumarole::measure::Paper;
use fumarole::measure::picture::read_target;
use fumarole::papers::terrain::{
    Base, Hit, Inputs, Interpolation, Lod, MapInput, Parameters, Placement, Start, Surface, Terrain, Variant, View,
};
use fumarole::scene::Camera;
use fumarole::scene::random::Random;
use glam::{DVec2, Vec3};

use super::drawing::{Drawing, Painter};
use super::maps::{adversaries, alone, ridges, volcano};
use crate::common::{gpu_test, shaders_by};

/// Neither side is a multiple of a tile's.
const SIZE: (u32, u32) = (107, 83);

fn camera(eye: [f32; 3], target: [f32; 3]) -> View {
    let (eye, target) = (Vec3::from(eye), Vec3::from(target));
    View::Camera(Camera { eye, target, up: Vec3::Y, vertical_fov_rad: 0.8, near_m: 1.0, far_m: 1e6 })
}

/// Over, beside, under and inside land of a size, high and low, level and straight down.
fn views(side_m: f32, top_m: f32) -> Vec<View> {
    let (edge, low) = (0.5 * side_m, 0.4 * top_m);
    vec![
        View::Side,
        View::Top,
        camera([0.0, 1.1 * top_m, 0.45 * side_m], [0.0, low, 0.0]),
        camera([0.9 * edge, 1.02 * top_m, -0.9 * edge], [-edge, 0.9 * top_m, edge]),
        camera([1.5 * edge, low, 0.1 * edge], [0.0, low, 0.0]),
        camera([0.1 * edge, 3.0 * top_m, 0.2 * edge], [0.1 * edge, 0.0, 0.2 * edge + 1e-3 * side_m]),
        camera([0.2 * edge, low, 0.3 * edge], [edge, top_m, 0.0]),
        camera([30.0 * side_m, 8.0 * top_m, 20.0 * side_m], [0.0, low, 0.0]),
    ]
}

fn parameters(view: View, start: Start, lod: Lod, interpolation: Interpolation) -> Parameters {
    let (width, height) = SIZE;
    Parameters { view, start, lod, interpolation, width, height, ..Parameters::default() }
}

fn bits(hit: &Hit) -> (u32, [u32; 2], Surface, u32, u32) {
    (hit.depth_m.to_bits(), hit.place.map(f32::to_bits), hit.surface, hit.shift, hit.map)
}

fn steps(drawing: &Drawing) -> u32 {
    drawing.hits.iter().map(|hit| hit.steps).sum()
}

/// Bit for bit, along a path of cameras.
fn is_the_same(device: &Arc<Device>, name: &str, maps: &[MapInput], views: &[View]) -> [u32; 2] {
    let inputs = Inputs { maps, ..Inputs::default() };
    let mut sums = [0; 2];
    for lod in [Lod::Exact, Lod::Pixel] {
        for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
            for variant in [Variant::DdaCompute, Variant::DdaFragment] {
                let mut painters = [Start::Tiles, Start::Rays].map(|start| {
                    let parameters = parameters(views[0], start, lod, interpolation);
                    Painter::new(device, Compiler::Glslang, variant, &parameters, &inputs)
                });
                for &view in views {
                    let [tiles, rays] = painters.each_mut().map(|painter| {
                        painter.paper.set_view(view);
                        painter.draw()
                    });
                    let what = format!("{name} {lod:?} {interpolation:?} {variant:?} {view:?}");
                    assert!(tiles.passes.contains(&"start") && !rays.passes.contains(&"start"), "{what}");
                    let differ = tiles.hits.iter().zip(&rays.hits).filter(|(a, b)| bits(a) != bits(b)).count();
                    assert_eq!(differ, 0, "{what}: hits");
                    assert!(tiles.normals == rays.normals, "{what}: normals");
                    assert!(tiles.picture.pixels() == rays.picture.pixels(), "{what}: the picture");
                    sums[0] += steps(&tiles);
                    sums[1] += steps(&rays);
                }
            }
        }
    }
    sums
}

#[test]
fn rays_that_begin_with_their_tile_see_the_same() {
    gpu_test(|device| {
        for (name, map) in adversaries() {
            let top_m = map.range_m().1 + 5.0;
            is_the_same(device, name, &alone(map), &views(60.0, top_m));
        }
        let rough = ridges(&mut Random::new(62), (300, 211), 6000.0);
        let [tiles, rays] = is_the_same(device, "ridges", &alone(rough), &views(25_000.0, 6000.0));
        println!("{tiles} steps of rays that begin with their tiles, {rays} of those that begin by themselves");
        assert!(10 * tiles < 9 * rays, "{tiles} steps of {rays}");
    });
}

/// One turned over the other: each map has tiles of its own.
#[test]
fn tiles_of_several_maps_see_the_same() {
    gpu_test(|device| {
        let mut maps = alone(volcano(120));
        let placement = Placement { center_m: DVec2::new(5000.0, 2000.0), yaw_rad: 0.6 };
        maps.push(MapInput { map: Arc::new(ridges(&mut Random::new(63), (90, 120), 2500.0)), placement });
        is_the_same(device, "two maps", &maps, &views(12_000.0, 2200.0)[..4]);
    });
}

/// No ray meets the land before its tile lets it begin, and the most of them begin near it.
#[test]
fn a_tile_ends_before_its_rays_meet_the_land() {
    let rough = ridges(&mut Random::new(64), (400, 400), 6000.0);
    let view = camera([0.0, 7000.0, 19_000.0], [0.0, 2000.0, 0.0]);
    gpu_test(|device| {
        let maps = alone(rough.clone());
        let shaders = shaders_by(device, Compiler::Glslang);
        let inputs = Inputs { maps: &maps, ..Inputs::default() };
        let parameters = parameters(view, Start::Tiles, Lod::Exact, Interpolation::Bilinear);
        let truth = Drawing::of(device, Variant::GpuFragment, &parameters, &maps);
        for variant in [Variant::DdaCompute, Variant::DdaFragment] {
            let mut paper = Terrain::new(&shaders, "test", variant, &parameters, &inputs).unwrap();
            Recorder::new(device).unwrap().run(Mode::Plain, |frame| paper.record(frame, 0)).unwrap();
            let target = paper.targets().into_iter().find(|target| target.name == "start").unwrap();
            let array = read_target(device, &target).unwrap();
            let Samples::F32(starts) = array.samples() else { panic!("depths are floats") };
            let across = SIZE.0.div_ceil(8);
            assert_eq!(starts.len() as u32, across * SIZE.1.div_ceil(8));
            let (mut met, mut near) = (0, 0);
            for (index, hit) in (0..).zip(&truth.hits).filter(|(_, hit)| hit.surface == Surface::Terrain) {
                let (x, y) = (index % SIZE.0, index / SIZE.0);
                let start_m = starts[(y / 8 * across + x / 8) as usize];
                assert!(start_m <= hit.depth_m, "{variant:?} {x}, {y}: {start_m} m, met at {} m", hit.depth_m);
                met += 1;
                near += u32::from(start_m > 0.8 * hit.depth_m);
            }
            assert!(met > 3000 && 2 * near > met, "{variant:?}: {near} of {met} begin near the land");
        }
    });
}

/// Rays that are bent begin each by itself.
#[test]
fn there_are_no_tiles_over_a_curved_base() {
    gpu_test(|device| {
        let parameters = Parameters {
            base: Base::Cylinder { radius_m: 30_000.0 },
            ..parameters(View::Side, Start::Tiles, Lod::Exact, Interpolation::Bilinear)
        };
        let drawing = Drawing::of(device, Variant::DdaFragment, &parameters, &alone(volcano(60)));
        assert!(!drawing.passes.contains(&"start"));
        assert!(drawing.hits.iter().any(|hit| hit.surface == Surface::Terrain));
    });
}
