//! The march of turbulent gas and of solids against rays in double precision, and the light that surfaces get through it.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::gas::model::{DensityFunction, Front, Object, Shape, SolidTexture, Swirl, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::rays::{Rays, Sampling, towards};
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::{Camera, Light, shapes};
use glam::{DVec3, Mat4, UVec2, Vec2, Vec3};

use crate::common::gpu_test;
use crate::drawing::Drawing;

const WIDTH: u32 = 24;
const HEIGHT: u32 = 16;
const FRAME: u32 = 37;

/// From infinity, from outside and from inside of the gas, each of another colour.
fn lights() -> Vec<Light> {
    vec![
        Light::Parallel { direction: Vec3::new(-0.3, -1.0, -0.45), intensity: Vec3::new(0.9, 0.2, 0.3) },
        Light::Point { position: Vec3::new(3.0, 4.0, 1.0), intensity: Vec3::new(4.0, 18.0, 6.0) },
        Light::Point { position: Vec3::new(0.31, -0.22, 0.43), intensity: Vec3::new(0.1, 0.1, 0.4) },
    ]
}

fn parameters(volumes: Vec<Volume>) -> Parameters {
    Parameters {
        volumes,
        lights: lights(),
        background: Vec3::new(0.2, 0.5, 0.8),
        camera: Camera { eye: Vec3::new(1.0, 1.4, 5.0), vertical_fov_rad: 0.5, ..Parameters::default().camera },
        early_end: 0.0,
        first_frame: FRAME,
        frame_step: 0,
        width: WIDTH,
        height: HEIGHT,
        ..Parameters::default()
    }
}

/// Every density function in a solid of its own shape.
fn gases() -> Vec<Volume> {
    let swirl = Swirl { along_per_frame: 0.02, frames: 20.0, ellipse: [0.3, 0.2] };
    let front =
        Front { x_m: -0.8, per_frame_m: 0.02, depth_m: 0.7, full_frames: 50.0, turbulence_m: 0.5, table_m: 0.3 };
    let functions = [
        (DensityFunction::Constant, Shape::Box),
        (DensityFunction::Turbulence, Shape::Sphere),
        (DensityFunction::Clouds { frequency: 4.0 }, Shape::Cylinder),
        (DensityFunction::Fog { swirl, front }, Shape::Box),
        (DensityFunction::Steam { swirl }, Shape::Frustum { bottom: 0.4, top: 0.9 }),
        (DensityFunction::Hypertexture { amplitude: 0.8, softness: 0.6 }, Shape::Sphere),
    ];
    let gas = |(function, shape)| {
        let texture = SolidTexture { function, opaque: 1.3, power: 1.5, scale_per_m: 1.4, offset: Vec3::splat(2.3) };
        Volume { shape, half_extent_m: Vec3::new(1.0, 0.9, 1.1), falloff: 0.3, texture, ..default_volume() }
    };
    functions.map(gas).to_vec()
}

/// Differences of every pixel's colour from the oracle's, over the background.
fn differences(drawing: &Drawing, parameters: &Parameters, is_shadowed: bool, sampling: Sampling) -> Vec<DVec3> {
    let rays = Rays::new(parameters, FRAME);
    let mut seen = 0.0;
    let difference = |pixel: u32| {
        let gas = rays.pixel(pixel % WIDTH, pixel / WIDTH, is_shadowed, sampling);
        seen += 1.0 - gas.transparency;
        drawing.color(pixel as usize) - gas.color - parameters.background.as_dvec3() * gas.transparency
    };
    let differences = (0..WIDTH * HEIGHT).map(difference).collect();
    assert!(seen > 5.0, "there is no gas in the picture: {seen}");
    differences
}

fn worst(differences: &[DVec3]) -> f64 {
    differences.iter().map(|d| d.abs().max_element()).fold(0.0, f64::max)
}

#[test]
fn every_gas_is_marched_as_its_rays_are() {
    gpu_test(|device| {
        for gas in gases() {
            let parameters = Parameters { steps: 12, ..parameters(vec![gas]) };
            for (variant, is_shadowed) in [(Variant::None, false), (Variant::Traced, true)] {
                let drawing = Drawing::of(device, variant, &parameters, &[]);
                let worst = worst(&differences(&drawing, &parameters, is_shadowed, Sampling::Random));
                println!("{:?}, {variant:?}: {worst:.2e}", gas.texture.function);
                assert!(worst < 5e-5, "{:?}, {variant:?}: {worst}", gas.texture.function);
            }
        }
    });
}

/// Three gases of different steps, each partly in the others; and the end of a pixel's tracing.
#[test]
fn gases_that_overlap_are_marched_at_once() {
    gpu_test(|device| {
        let mut volumes = gases();
        volumes.truncate(3);
        volumes[1].center = Vec3::new(0.5, 0.4, 0.3);
        volumes[2].center = Vec3::new(-0.6, 0.2, -0.5);
        volumes[2].half_extent_m *= 1.4;
        for early_end in [0.0, 0.3] {
            let parameters = Parameters { steps: 12, early_end, ..parameters(volumes.clone()) };
            let drawing = Drawing::of(device, Variant::Traced, &parameters, &[]);
            let differences = differences(&drawing, &parameters, true, Sampling::Random);
            // A transparency that is the early end's but for rounding may end an increment earlier or later.
            let off = differences.iter().filter(|d| d.abs().max_element() > 1e-3).count();
            assert!(off <= 1, "{early_end}: {off} pixels, {}", worst(&differences));
        }
    });
}

/// Samples at random places estimate the integral without bias, and the better the more there are.
#[test]
fn random_samples_estimate_the_integral() {
    gpu_test(|device| {
        for gas in gases() {
            let mut spreads = Vec::new();
            for steps in [10, 40] {
                let parameters = Parameters { steps, ..parameters(vec![gas]) };
                let drawing = Drawing::of(device, Variant::None, &parameters, &[]);
                let differences = differences(&drawing, &parameters, false, Sampling::Fine(200 / steps));
                let count = differences.len() as f64;
                let mean = differences.iter().sum::<DVec3>().abs().max_element() / count;
                let spread = (differences.iter().map(|d| d.length_squared()).sum::<f64>() / count).sqrt();
                println!("{:?}, {steps} steps: mean {mean:.5}, spread {spread:.5}", gas.texture.function);
                assert!(mean < 0.003 && spread < 0.05, "{:?}: {mean}, {spread}", gas.texture.function);
                spreads.push(spread);
            }
            assert!(spreads[1] < 0.6 * spreads[0] + 1e-4, "{:?}: {spreads:?}", gas.texture.function);
        }
    });
}

/// A solid's normals are its density's gradient: in a ball whose surface the turbulence does not move, and in one that it does.
#[test]
fn solids_are_shaded_by_their_gradient() {
    gpu_test(|device| {
        for (amplitude, most) in [(0.0, 0.015), (0.9, 0.05)] {
            let texture = SolidTexture {
                function: DensityFunction::Hypertexture { amplitude, softness: 0.3 },
                scale_per_m: 1.5,
                ..default_volume().texture
            };
            let albedo = Vec3::new(0.9, 0.6, 0.3);
            let ball =
                Volume { shape: Shape::Sphere, is_solid: true, texture, tau_per_m: 8.0, albedo, ..default_volume() };
            let mut parameters = Parameters { steps: 200, ..parameters(vec![ball]) };
            parameters.lights.truncate(2);
            parameters.background = Vec3::ZERO;
            let drawing = Drawing::of(device, Variant::None, &parameters, &[]);
            let differences = differences(&drawing, &parameters, false, Sampling::Fine(2));
            let count = differences.len() as f64;
            let mean = differences.iter().map(|d| d.abs().max_element()).sum::<f64>() / count;
            let brightest = (0..(WIDTH * HEIGHT) as usize).map(|p| drawing.color(p).max_element()).fold(0.0, f64::max);
            println!(
                "amplitude {amplitude}: mean {mean:.4}, worst {:.4}, brightest {brightest:.2}",
                worst(&differences)
            );
            assert!(mean < most && brightest > 0.4, "{amplitude}: {mean} of {brightest}");
        }
    });
}

/// A white floor under the gas, seen from beside it: the gas is not in the way of the eye.
fn floor() -> Object {
    let mesh = shapes::plane(Vec2::splat(12.0), UVec2::ONE).transformed(&Mat4::from_translation(Vec3::NEG_Y * 1.6));
    Object::new(mesh, Vec3::ONE)
}

fn floor_view(volumes: Vec<Volume>, lights: Vec<Light>) -> Parameters {
    Parameters {
        lights,
        ambient: Vec3::ZERO,
        camera: Camera {
            eye: Vec3::new(0.0, -1.15, 4.5),
            target: Vec3::new(0.0, -1.6, 0.5),
            vertical_fov_rad: 0.35,
            ..Parameters::default().camera
        },
        ..parameters(volumes)
    }
}

/// The mean and the largest share of light by which the floor's pixels differ from what rays in double precision let through.
fn floor_errors(device: &Arc<Device>, variant: Variant, parameters: &Parameters, finer: u32) -> (f64, f64) {
    let drawing = Drawing::of(device, variant, parameters, &[floor()]);
    let rays = Rays::new(parameters, FRAME);
    let (mut sum, mut worst, mut count, mut darkest) = (0.0, 0.0_f64, 0, 1.0_f64);
    for pixel in 0..WIDTH * HEIGHT {
        // The diagonal of the floor: two pieces with middles of their own.
        let (list, ray) = (
            &drawing.lists[pixel as usize],
            rays.direction(f64::from(pixel % WIDTH) + 0.5, f64::from(pixel / WIDTH) + 0.5),
        );
        if list.len() != 1 || list[0].coverage < 1.0 {
            continue;
        }
        let depth = f64::midpoint(list[0].depth_m[0].into(), list[0].depth_m[1].into());
        let point = rays.eye() + ray * depth;
        assert!(ray.y < 0.0 && (point.y + 1.6).abs() < 0.02, "{point}");
        let (mut expected, mut open) = (DVec3::ZERO, DVec3::ZERO);
        for light in &parameters.lights {
            let (way, _, irradiance) = towards(light, point);
            let passed = (-rays.optical_depth(point, light, finer)).exp();
            darkest = darkest.min(passed);
            expected += irradiance * way.y.max(0.0) * passed;
            open += irradiance * way.y.max(0.0);
        }
        let error = ((drawing.color(pixel as usize) - expected).abs() / open).max_element();
        sum += error;
        worst = worst.max(error);
        count += 1;
    }
    assert!(count > 200 && darkest < 0.95, "{count} pixels, darkest {darkest}");
    (sum / f64::from(count), worst)
}

#[test]
fn surfaces_get_the_light_that_the_gas_lets_through() {
    gpu_test(|device| {
        for gas in gases().into_iter().skip(1) {
            let mut gas = gas;
            gas.texture.opaque = 2.5;
            for light in lights() {
                let parameters = Parameters { steps: 20, ..floor_view(vec![gas], vec![light]) };
                for variant in [Variant::Surfaces, Variant::Traced] {
                    let (_, worst) = floor_errors(device, variant, &parameters, 1);
                    assert!(worst < 1e-3, "{:?}, {light:?}, {variant:?}: {worst}", gas.texture.function);
                }
            }
            let all = floor_view(vec![gas], lights());
            let (mean, worst) = floor_errors(device, Variant::Surfaces, &all, 8);
            println!("{:?}: mean {mean:.4}, worst {worst:.4} from fine rays", gas.texture.function);
            assert!(mean < 0.01, "{:?}: {mean}, {worst}", gas.texture.function);
        }
    });
}

/// Below 0.03 mean error in what comes through, outside of the table's box too.
#[test]
fn the_table_shadows_surfaces_as_rays_do() {
    gpu_test(|device| {
        for gas in gases().into_iter().skip(1) {
            for light in lights() {
                let parameters = floor_view(vec![gas], vec![light]);
                let (mean, worst) = floor_errors(device, Variant::Table, &parameters, 8);
                println!("{:?}, {light:?}: mean {mean:.4}, worst {worst:.4}", gas.texture.function);
                assert!(mean < 0.03, "{:?}, {light:?}: {mean}", gas.texture.function);
            }
        }
    });
}
