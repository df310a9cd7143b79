//! The march of turbulent gas and of solids against rays in double precision.

use std::ops::Range;

use fumarole::gpu::{Compiler, Mode, Recorder};
use fumarole::measure::Paper;
use fumarole::papers::gas::model::{DensityFunction, Front, Shape, SolidTexture, Swirl, Volume};
use fumarole::papers::gas::parameters::Jitter;
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::rays::{Rays, Sampling};
use fumarole::papers::gas::{Gas, Parameters, Variant};
use fumarole::scene::{Camera, Light};
use glam::{DVec3, Vec3};

use super::drawing::Drawing;
use crate::common::{gpu_test, shaders_by};

pub const WIDTH: u32 = 24;
pub const HEIGHT: u32 = 16;
pub const FRAME: u32 = 37;

/// From infinity, from outside and from inside of the gas, each of another colour.
pub fn lights() -> Vec<Light> {
    vec![
        Light::Parallel { direction: Vec3::new(-0.3, -1.0, -0.45), intensity: Vec3::new(0.9, 0.2, 0.3) },
        Light::Point { position: Vec3::new(3.0, 4.0, 1.0), intensity: Vec3::new(4.0, 18.0, 6.0) },
        Light::Point { position: Vec3::new(0.31, -0.22, 0.43), intensity: Vec3::new(0.1, 0.1, 0.4) },
    ]
}

pub fn parameters(volumes: Vec<Volume>) -> Parameters {
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
pub fn gases() -> Vec<Volume> {
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
pub fn differences(drawing: &Drawing, parameters: &Parameters, is_shadowed: bool, sampling: Sampling) -> Vec<DVec3> {
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

pub fn worst(differences: &[DVec3]) -> f64 {
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

/// Gas as wide as land, and as a grain of sand, thinner and denser by as much: the unit of length is nothing to a solid.
#[test]
fn solids_of_any_size_are_cut_as_their_rays_are() {
    gpu_test(|device| {
        for shape in [Shape::Box, Shape::Sphere, Shape::Cylinder, Shape::Frustum { bottom: 0.4, top: 0.9 }] {
            for size_m in [1e-3_f32, 1.0, 1e5, 9e5] {
                let texture = SolidTexture { function: DensityFunction::Constant, ..gases()[0].texture };
                let gas = gases()[0];
                let half_extent_m = gas.half_extent_m * size_m;
                let gas = Volume { shape, half_extent_m, tau_per_m: gas.tau_per_m / size_m, texture, ..gas };
                let mut parameters = Parameters { steps: 12, ..parameters(vec![gas]) };
                parameters.lights.truncate(1);
                parameters.camera.eye *= size_m;
                parameters.camera.target *= size_m;
                parameters.camera.near_m *= size_m;
                parameters.camera.far_m *= size_m;
                let drawing = Drawing::of(device, Variant::Traced, &parameters, &[]);
                let worst = worst(&differences(&drawing, &parameters, true, Sampling::Random));
                println!("{shape:?} of {size_m} m: {worst:.2e}");
                assert!(worst < 5e-5, "{shape:?} of {size_m} m: {worst}");
            }
        }
    });
}

/// Several samples of an increment, at random or by blue noise, are those of the rays; and their error is less, or finer.
#[test]
fn samples_lie_where_they_are_told() {
    gpu_test(|device| {
        for (gas, samples, jitter) in
            [(gases()[1], 3, Jitter::Random), (gases()[3], 1, Jitter::BlueNoise), (gases()[1], 4, Jitter::BlueNoise)]
        {
            let parameters = Parameters { steps: 12, samples, jitter, ..parameters(vec![gas]) };
            for (variant, is_shadowed) in [(Variant::None, false), (Variant::Traced, true)] {
                let drawing = Drawing::of(device, variant, &parameters, &[]);
                let differences = differences(&drawing, &parameters, is_shadowed, Sampling::Random);
                assert!(worst(&differences) < 5e-5, "{samples} {jitter:?} {variant:?}: {}", worst(&differences));
            }
        }
        // Over each 3 x 3 pixels the errors of blue noise cancel as those of random samples do not.
        let gas = Volume { falloff: 1.0, tau_per_m: 3.0, ..gases()[0] };
        let grain = |jitter, samples| {
            let parameters = Parameters { steps: 6, jitter, samples, ..parameters(vec![gas]) };
            let drawing = Drawing::of(device, Variant::None, &parameters, &[]);
            let errors = differences(&drawing, &parameters, false, Sampling::Fine(40));
            let at = |x: u32, y: u32| errors[(y * WIDTH + x) as usize].y;
            let means = (1..HEIGHT - 1)
                .flat_map(|y| (1..WIDTH - 1).map(move |x| (x, y)))
                .map(|(x, y)| (0..9).map(|i| at(x + i % 3 - 1, y + i / 3 - 1)).sum::<f64>() / 9.0);
            means.map(|mean| mean * mean).sum::<f64>().sqrt()
        };
        let [random, blue, several] =
            [(Jitter::Random, 1), (Jitter::BlueNoise, 1), (Jitter::Random, 4)].map(|(j, s)| grain(j, s));
        println!("grain: random {random:.2e}, blue noise {blue:.2e}, four samples {several:.2e}");
        assert!(blue < 0.6 * random && several < 0.5 * random, "{random} {blue} {several}");
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

/// Shadows are left out in gas that is thinner than a threshold, and nowhere else.
#[test]
fn gas_thinner_than_the_threshold_is_not_shadowed() {
    gpu_test(|device| {
        let gas = gases()[1];
        let parameters = Parameters { steps: 12, shadow_threshold: 0.25, ..parameters(vec![gas]) };
        let drawing = Drawing::of(device, Variant::Traced, &parameters, &[]);
        let own = differences(&drawing, &parameters, true, Sampling::Random);
        // A density that is the threshold but for rounding may fall to either side.
        let off = |differences: &[DVec3]| differences.iter().filter(|d| d.abs().max_element() > 1e-4).count();
        assert!(off(&own) <= 3, "{} pixels", off(&own));
        let all =
            differences(&drawing, &Parameters { shadow_threshold: 0.0, ..parameters.clone() }, true, Sampling::Random);
        let none = differences(&drawing, &parameters, false, Sampling::Random);
        assert!(off(&all) > 50 && off(&none) > 50, "{} and {} pixels", off(&all), off(&none));
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

/// A solid's normals are its density's gradient: in a ball whose surface the turbulence does not move, and in one that
/// it does.
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

/// Some rows alone, whatever other rows before them have left.
#[test]
fn densities_are_counted_in_the_rows_that_are_drawn() {
    gpu_test(|device| {
        let parameters = Parameters { steps: 8, ..parameters(vec![gases()[0]]) };
        let shaders = shaders_by(device, Compiler::Glslang);
        let mut gas = Gas::new(&shaders, "test", Variant::None, &parameters, &[], None).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let mut count = |rows: Range<u32>| {
            gas.keep_rows(rows);
            loop {
                recorder.run(Mode::Plain, |frame| gas.record(frame, 0)).unwrap();
                if gas.settle(&shaders).unwrap() {
                    break;
                }
            }
            gas.evaluations(&shaders).unwrap().expect("all rows are one band")
        };
        let all = count(0..HEIGHT);
        let (upper, lower) = (count(0..HEIGHT / 2), count(HEIGHT / 2..HEIGHT));
        assert!(upper > 0 && lower > 0 && upper + lower == all, "{upper} and {lower} of {all}");
    });
}
