//! Delta and ratio tracking: their means are those of fine marches, within their own errors.

use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::papers::gas::model::{DensityFunction, Object, Volume};
use fumarole::papers::gas::reference::rays::{Rays, Sampling};
use fumarole::papers::gas::{March, Parameters, Variant};
use fumarole::scene::Camera;
use glam::{DVec3, Vec3};

use super::drawing::Drawing;
use super::march::{FRAME, HEIGHT, WIDTH, gases, parameters};
use super::skipping::ground;
use crate::common::gpu_test;

/// Frames of the same gas, whose random numbers differ.
const FRAMES: u32 = 4;
const PIXELS: usize = (WIDTH * HEIGHT) as usize;

/// The gas as it is at all times.
fn still(mut gas: Volume) -> Volume {
    match &mut gas.texture.function {
        DensityFunction::Fog { swirl, front } => {
            (swirl.along_per_frame, swirl.frames, front.full_frames) = (0.0, 0.0, 0.0);
            (front.x_m, front.per_frame_m) = (0.1, 0.0);
        }
        DensityFunction::Steam { swirl } => (swirl.along_per_frame, swirl.frames) = (0.0, 0.0),
        _ => {}
    }
    gas
}

/// Under the lights that are outside of it: near one inside, few ways bring most of the light.
fn lit(volumes: Vec<Volume>) -> Parameters {
    let mut parameters = parameters(volumes);
    parameters.lights.truncate(2);
    parameters
}

/// By delta tracking, 32 ways of a ray through each section; that a ray's end at a small transparency is not its end is
/// part of it.
fn tracked(own: &Parameters) -> Parameters {
    Parameters { march: March::Delta, samples: 32, early_end: 0.3, frame_step: 1, ..own.clone() }
}

/// Of each pixel the mean of all frames and the square of its standard error, in green.
fn estimates(
    device: &Arc<Device>,
    compiler: Compiler,
    variant: Variant,
    parameters: &Parameters,
    objects: &[Object],
) -> Vec<(f64, f64)> {
    let frames: Vec<Drawing> =
        (0..FRAMES).map(|number| Drawing::frame(device, compiler, variant, parameters, objects, number)).collect();
    let count = f64::from(FRAMES);
    let of_pixel = |pixel: usize| {
        let values = || frames.iter().map(|frame| frame.color(pixel).y);
        let mean = values().sum::<f64>() / count;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, variance / count)
    };
    (0..PIXELS).map(of_pixel).collect()
}

/// The mean over all pixels is within four standard errors, and pixels are as far off as their own errors say.
fn agrees(name: &str, estimates: &[(f64, f64)], expected: impl Fn(usize) -> f64) {
    let differences: Vec<f64> = estimates.iter().enumerate().map(|(i, (mean, _))| mean - expected(i)).collect();
    let squares: f64 = estimates.iter().map(|(_, square)| square).sum();
    let (sum, error) = (differences.iter().sum::<f64>(), squares.sqrt());
    let spread = differences.iter().map(|d| d * d).sum::<f64>() / squares;
    println!("{name}: off by {:.2} standard errors of {:.1e}, spread {spread:.2}", sum / error, error / PIXELS as f64);
    assert!(error > 0.0 && sum.abs() < 4.0 * error, "{name}: off by {} standard errors", sum / error);
    assert!((0.5..1.8).contains(&spread), "{name}: {spread}");
}

/// Bounds of functions, and those of a table of them, which are nearer; with and without shadows in the gas.
#[test]
fn the_mean_of_many_ways_is_the_integral() {
    gpu_test(|device| {
        let [constant, turbulence, _, fog, steam, _] = gases().try_into().unwrap();
        for (gas, density_cache) in
            [(constant, None), (turbulence, Some(14)), (still(fog), None), (still(steam), Some(14))]
        {
            let own = Parameters { steps: 60, density_cache, ..lit(vec![gas]) };
            let rays = Rays::new(&own, FRAME);
            for (variant, is_shadowed) in [(Variant::None, false), (Variant::Traced, true)] {
                let expected: Vec<DVec3> = (0..WIDTH * HEIGHT)
                    .map(|pixel| {
                        let gas = rays.pixel(pixel % WIDTH, pixel / WIDTH, is_shadowed, Sampling::Fine(1));
                        gas.color + own.background.as_dvec3() * gas.transparency
                    })
                    .collect();
                let found = estimates(device, Compiler::Glslang, variant, &tracked(&own), &[]);
                agrees(&format!("{:?}, {variant:?}", gas.texture.function), &found, |pixel| expected[pixel].y);
            }
        }
    });
}

/// Volumes that overlap, shadows from the table, and what the gas takes of the light of a surface: against fine marches of
/// the device, and by naga's shaders.
#[test]
fn ways_agree_with_marches() {
    gpu_test(|device| {
        let mut volumes: Vec<Volume> = gases().into_iter().take(2).collect();
        volumes[1].center.x = 0.6;
        let own = Parameters { density_cache: Some(14), table_size: 16, ..lit(volumes) };
        let fine = Parameters { steps: 300, ..own.clone() };
        for (variant, compiler) in [
            (Variant::Surfaces, Compiler::Glslang),
            (Variant::Table, Compiler::Glslang),
            (Variant::Traced, Compiler::Naga),
        ] {
            let march = match variant {
                Variant::Traced => Parameters { steps: 80, ..own.clone() },
                _ => fine.clone(),
            };
            let expected = Drawing::of(device, variant, &march, &[ground()]);
            let found = estimates(device, compiler, variant, &tracked(&own), &[ground()]);
            agrees(&format!("{variant:?}"), &found, |pixel| expected.color(pixel).y);
        }
    });
}

/// A solid is shaded by its gradient too.
#[test]
fn solids_are_tracked() {
    gpu_test(|device| {
        let solid = Volume { is_solid: true, tau_per_m: 8.0, ..gases()[5] };
        let own = Parameters { steps: 300, density_cache: Some(24), ..lit(vec![solid]) };
        let expected = Drawing::of(device, Variant::None, &own, &[]);
        let found = estimates(device, Compiler::Glslang, Variant::None, &tracked(&own), &[]);
        let off =
            found.iter().enumerate().map(|(i, (mean, _))| mean - expected.color(i).y).sum::<f64>() / PIXELS as f64;
        let seen = (0..PIXELS).map(|i| (expected.color(i).y - 0.5).abs()).sum::<f64>() / PIXELS as f64;
        println!("solid: off by {off:.4} of {seen:.3}");
        assert!(off.abs() < 0.005 && seen > 0.05, "{off} of {seen}");
    });
}

/// One seed draws one picture, and bricks without density are passed without a particle.
#[test]
fn ways_follow_from_the_seed() {
    gpu_test(|device| {
        let own = Parameters { density_cache: Some(14), ..parameters(vec![gases()[4]]) };
        let draw = |bricks| {
            let parameters = Parameters { bricks, ..tracked(&own) };
            Drawing::of(device, Variant::Traced, &parameters, &[ground()])
        };
        let (one, other) = (draw(16), draw(16));
        assert!(one.radiance == other.radiance);
        let whole = draw(1);
        assert!(one.radiance != whole.radiance);
        println!("{} densities in 16³ bricks, {} in one", one.evaluations, whole.evaluations);
        assert!(one.evaluations < whole.evaluations / 2);
    });
}

/// Bounds so far above the density that a part of a way is shorter than the last bit of the way so far: such a way is given up
/// on every device, from the eye and, where the eye looks at the ground below the gas, towards a light.
#[test]
fn a_way_that_gets_nowhere_is_refused() {
    gpu_test(|device| {
        let mut gas = gases()[1];
        gas.texture.power = 30.0;
        let seen = Parameters { samples: 1, width: 1, height: 1, ..tracked(&lit(vec![gas])) };
        let (eye, target) = (Vec3::new(1.0, -0.95, 1.0), Vec3::new(-0.4, -1.3, -0.6));
        let camera = Camera { eye, target, vertical_fov_rad: 0.02, ..seen.camera };
        let below = Parameters { camera, ..seen.clone() };
        for (pass, parameters) in [("volume", seen), ("light-attenuation", below)] {
            let drawn = Drawing::tried(device, Variant::Surfaces, &parameters, &[ground()]);
            let error = drawn.err().expect("no way through such gas ends").to_string();
            for part in [pass, "`power`", "1 pixel"] {
                assert!(error.contains(part), "{part}: {error}");
            }
        }
    });
}
