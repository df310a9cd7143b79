//! The picture of a list against 32 sub-pixels that are composited one by one.

use fumarole::papers::gas::model::{Checker, DensityFunction, Object, SolidTexture, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::rays::Rays;
use fumarole::papers::gas::reference::resolve::{Layer, composited};
use fumarole::papers::gas::{Fragment, Parameters, Variant};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, Light, Mesh};
use glam::{DVec3, Vec3};

use super::drawing::Drawing;
use crate::common::gpu_test;

const WIDTH: u32 = 45;
const HEIGHT: u32 = 31;
/// Depths between which there is gas, metres; its optical depth a metre, and its colour.
const GAS_M: [f64; 2] = [4.0, 6.0];
const EXTINCTION: f64 = 0.8;
const GAS_COLOR: f64 = 0.5;

/// Looks along -Z from the origin, under ambient light alone: what a surface shows is its own colour.
fn parameters(volumes: Vec<Volume>) -> Parameters {
    Parameters {
        volumes,
        lights: vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO }],
        ambient: Vec3::ONE,
        background: Vec3::new(0.1, 0.6, 0.3),
        camera: Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, near_m: 0.5, ..Parameters::default().camera },
        early_end: 0.0,
        width: WIDTH,
        height: HEIGHT,
        ..Parameters::default()
    }
}

fn gas() -> Volume {
    let texture = SolidTexture { function: DensityFunction::Constant, opaque: 1.0, ..default_volume().texture };
    Volume {
        center: Vec3::NEG_Z * 5.0,
        half_extent_m: Vec3::new(9.0, 9.0, 1.0),
        texture,
        tau_per_m: EXTINCTION as f32,
        albedo: Vec3::splat(GAS_COLOR as f32),
        ..default_volume()
    }
}

/// Triangles of all sizes and slopes through the picture, each an object with a colour and an opacity of its own.
fn triangles(count: u32, seed: u64) -> Vec<Object> {
    let mut random = Random::new(seed);
    let triangle = |_| {
        let middle = Vec3::new(random.range(-1.6, 1.6), random.range(-1.1, 1.1), -random.range(3.5, 6.5));
        let reach = [0.1, 0.6, 2.5][random.range(0.0, 2.999) as usize];
        let positions = [(); 3].map(|()| {
            middle + Vec3::new(random.range(-reach, reach), random.range(-reach, reach), random.range(-0.4, 0.4))
        });
        let mesh = Mesh {
            name: "triangle".to_owned(),
            positions: positions.to_vec(),
            normals: vec![Vec3::Z; 3],
            indices: vec![0, 1, 2],
            ..Mesh::default()
        };
        let opacity = [0.2, 0.7, 1.0][random.range(0.0, 2.999) as usize];
        let color = Vec3::new(random.unit(), random.unit(), random.unit());
        Object { opacity, ..Object::new(mesh, color) }
    };
    (0..count).map(triangle).collect()
}

/// The list as the device sorted it, with the gas between its fragments in closed form.
fn layers(list: &[Fragment], has_gas: bool, scale: f64) -> Vec<Layer> {
    let section = |from: f64, to: f64| {
        let length = (to.min(GAS_M[1]) - from.max(GAS_M[0])).max(0.0) * scale;
        let transparency = if has_gas { (-EXTINCTION * length).exp() } else { 1.0 };
        Layer::Gas { color: DVec3::splat(GAS_COLOR * (1.0 - transparency)), transparency }
    };
    let mut layers = Vec::new();
    let mut depth_m = 0.0;
    for f in list {
        let fragment_m = f.depth_m.map(f64::from);
        let middle_m = f64::midpoint(fragment_m[0], fragment_m[1]);
        layers.push(section(depth_m, middle_m));
        depth_m = middle_m;
        layers.push(Layer::Surface {
            mask: f.mask,
            depth_m: fragment_m,
            object: f.object,
            opacity: f.opacity.into(),
            color: Vec3::from(f.color).as_dvec3(),
        });
    }
    layers.push(section(depth_m, f64::INFINITY));
    layers
}

/// Partly covered pixels, opaque ones among them, transparent and intersecting surfaces, with gas between them and
/// without.
#[test]
fn a_pixel_is_its_32_sub_pixels() {
    gpu_test(|device| {
        for (has_gas, seed) in [(false, 3), (true, 4), (true, 5)] {
            let volumes = if has_gas { vec![gas()] } else { Vec::new() };
            let parameters = parameters(volumes);
            let drawing = Drawing::of(device, Variant::None, &parameters, &triangles(160, seed));
            let rays = Rays::new(&parameters, 0);
            let (mut partial, mut long) = (0, 0);
            for (pixel, list) in drawing.lists.iter().enumerate() {
                let place = [pixel as u32 % WIDTH, pixel as u32 / WIDTH].map(|p| f64::from(p) + 0.5);
                let scale = rays.direction(place[0], place[1]).length();
                let expected = composited(&layers(list, has_gas, scale), parameters.background.as_dvec3());
                let found = drawing.color(pixel);
                let error = (found - expected).abs().max_element();
                assert!(error < 2e-4, "pixel {pixel}: {found} for {expected}: {list:?}");
                partial += usize::from(list.iter().any(|f| f.mask != u32::MAX && f.opacity == 1.0));
                long += usize::from(list.len() > 4);
            }
            assert!(partial > 200 && long > 200, "{partial} partly covered, {long} of more than four fragments");
        }
    });
}

/// A wall across the whole view.
fn wall(depth_m: f32, color: Vec3) -> Object {
    let corners = [(-20.0, -20.0), (40.0, -20.0), (-20.0, 40.0)].map(|(x, y)| Vec3::new(x, y, -depth_m));
    let mesh = Mesh {
        name: "wall".to_owned(),
        positions: corners.to_vec(),
        normals: vec![Vec3::Z; 3],
        indices: vec![0, 1, 2],
        ..Mesh::default()
    };
    Object::new(mesh, color)
}

/// Half of a surface-defined gas is left half its fade before the wall behind it, all of it where it does not fade, and
/// none beyond its ends.
#[test]
fn gas_fades_before_the_surface_behind_it_and_at_its_ends() {
    gpu_test(|device| {
        let texture = SolidTexture { opaque: 0.5, ..gas().texture };
        for (fade_m, ends_m, expected) in [(2.0, 0.0, 0.25), (0.0, 0.0, 0.5), (0.5, 0.0, 0.5), (1e-3, 0.1, 0.0)] {
            let ends_m = glam::Vec2::splat(ends_m);
            let plane = Object { gas: Some(texture), fade_m, ends_m, ..wall(4.0, Vec3::ONE) };
            let drawing =
                Drawing::of(device, Variant::NoVolume, &parameters(Vec::new()), &[plane, wall(5.0, Vec3::ZERO)]);
            for pixel in 0..(WIDTH * HEIGHT) as usize {
                let found = drawing.red(pixel);
                assert!((found - expected).abs() < 1e-3, "{fade_m}, {ends_m}: {found} for {expected}");
            }
        }
    });
}

/// Squares smaller than a pixel show their mean, squares of many pixels their own colours.
#[test]
fn checkers_are_integrated_over_the_pixel() {
    gpu_test(|device| {
        let draw = |edge_m: f32| {
            let checker = Some(Checker { color: Vec3::ZERO, edge_m });
            let wall = Object { checker, ..wall(5.0, Vec3::ONE) };
            let drawing = Drawing::of(device, Variant::NoVolume, &parameters(Vec::new()), &[wall]);
            (0..(WIDTH * HEIGHT) as usize).map(|pixel| drawing.red(pixel)).collect::<Vec<f64>>()
        };
        // A pixel is 0.0998 m wide there.
        assert!(draw(0.05).iter().all(|value| (value - 0.5).abs() < 0.01));
        let large = draw(1.0);
        let is_pure = |value: &&f64| **value < 1e-6 || **value > 1.0 - 1e-3;
        let pure = large.iter().filter(is_pure).count();
        assert!(pure * 10 > large.len() * 7 && pure < large.len(), "{pure} of {}", large.len());
    });
}
