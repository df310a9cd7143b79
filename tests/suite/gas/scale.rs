//! Gas that is marched in some pixels, which the others take theirs from.

use fumarole::gpu::Compiler;
use fumarole::papers::gas::model::{DensityFunction, Object, Shape, SolidTexture, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::rays::{Rays, Sampling};
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{Lists, Parameters, Variant};
use fumarole::scene::{Camera, shapes};
use glam::{DVec3, Mat4, UVec2, Vec2, Vec3};

use super::drawing::Drawing;
use super::march::{FRAME, HEIGHT, WIDTH, gases, parameters};
use super::scenes::small;
use crate::common::gpu_test;

/// Looks along -Z at a box that fills the picture, between the same two depths in every pixel.
fn facing(gas: Volume) -> Parameters {
    let gas = Volume { shape: Shape::Box, half_extent_m: Vec3::new(9.0, 9.0, 1.0), falloff: 0.0, ..gas };
    let mut parameters = parameters(vec![gas]);
    parameters.camera = Camera { eye: Vec3::Z * 5.0, target: Vec3::ZERO, ..parameters.camera };
    parameters.lights.truncate(2);
    parameters
}

fn constant() -> Volume {
    let texture = SolidTexture { function: DensityFunction::Constant, opaque: 1.0, ..default_volume().texture };
    Volume { texture, tau_per_m: 0.7, ..default_volume() }
}

/// Pixels of the lattice are marched, those with half of their weight around them are the mean of their rays, and the others at
/// the borders are marched too.
#[test]
fn pixels_between_are_means_of_the_rays_around_them() {
    gpu_test(|device| {
        for (scale, compiler, variant, is_shadowed) in [
            (3, Compiler::Glslang, Variant::None, false),
            (2, Compiler::Naga, Variant::Traced, true),
            (16, Compiler::Glslang, Variant::None, false),
        ] {
            let parameters = Parameters { steps: 12, volume_scale: scale, ..facing(gases()[1]) };
            let drawing = Drawing::frame(device, compiler, variant, &parameters, &[], 0);
            let rays = Rays::new(&parameters, FRAME);
            let ray = |column: u32, row: u32| {
                let gas = rays.pixel(column, row, is_shadowed, Sampling::Random);
                gas.color + parameters.background.as_dvec3() * gas.transparency
            };
            let mut means = 0;
            for (column, row) in (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| (column, row))) {
                let low = [column / scale * scale, row / scale * scale];
                let part = [column - low[0], row - low[1]].map(|part| f64::from(part) / f64::from(scale));
                let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
                for corner in 0..4_u32 {
                    let ahead = [corner & 1, corner >> 1];
                    let weight: f64 = (0..2).map(|a| if ahead[a] == 1 { part[a] } else { 1.0 - part[a] }).product();
                    let at = [low[0] + ahead[0] * scale, low[1] + ahead[1] * scale];
                    if weight > 0.0 && at[0] < WIDTH && at[1] < HEIGHT {
                        sum += ray(at[0], at[1]) * weight;
                        weights += weight;
                    }
                }
                let is_mean = weights >= 0.5 - 1e-6;
                means += usize::from(is_mean && weights > 0.0 && part != [0.0; 2]);
                let expected = if is_mean { sum / weights } else { ray(column, row) };
                let found = drawing.color((row * WIDTH + column) as usize);
                let off = (found - expected).abs().max_element();
                assert!(off < 2e-4, "every {scale}: pixel {column}, {row}: {found} for {expected}");
            }
            assert!(means > 100, "every {scale}: {means} means");
        }
    });
}

/// Surfaces in the gas, one aslant and half clear: no pixel takes the gas before another surface, whose own gas is as smooth.
#[test]
fn gas_is_taken_from_before_the_same_surfaces_alone() {
    gpu_test(|device| {
        let own = facing(constant());
        let pane = |size: f32, turn: Mat4, opacity: f32| {
            let upright = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
            let mesh = shapes::plane(Vec2::splat(size), UVec2::ONE).transformed(&(turn * upright));
            Object { opacity, ..Object::new(mesh, Vec3::new(0.9, 0.2, 0.1)) }
        };
        let aslant = Mat4::from_translation(Vec3::new(0.4, 0.2, 0.2)) * Mat4::from_rotation_y(0.7);
        let objects = [pane(0.9, Mat4::from_translation(Vec3::new(-0.5, 0.0, 0.5)), 1.0), pane(1.1, aslant, 0.5)];
        let full = Drawing::of(device, Variant::None, &own, &objects);
        let bare = Drawing::of(device, Variant::None, &own, &[]);
        let seen = (0..full.lists.len()).filter(|&p| (full.color(p) - bare.color(p)).abs().max_element() > 0.1).count();
        assert!(seen > 60, "{seen} pixels of surfaces");
        for scale in [2, 4] {
            let scaled =
                Drawing::of(device, Variant::None, &Parameters { volume_scale: scale, ..own.clone() }, &objects);
            for pixel in 0..full.lists.len() {
                let off = (scaled.color(pixel) - full.color(pixel)).abs().max_element();
                let (column, row) = (pixel as u32 % WIDTH, pixel as u32 / WIDTH);
                let is_marched = column % scale == 0 && row % scale == 0;
                // At the border the pixels of one side stand for it alone.
                let most = if is_marched { 0.0 } else { 6e-3 };
                assert!(off <= most, "every {scale}: pixel {column}, {row}: {off}");
            }
            println!("every {scale}: {} of {} densities", scaled.evaluations, full.evaluations);
            assert!(scaled.evaluations * 3 < full.evaluations * 2, "{} of {}", scaled.evaluations, full.evaluations);
        }
    });
}

/// A scene of the paper: near its own picture, with every way to its lists and in bands, and made of far fewer densities.
#[test]
fn a_scene_stays_near_its_picture() {
    gpu_test(|device| {
        let (parameters, objects) = small(Preset::Fig6);
        let draw = |parameters: &Parameters| {
            Drawing::frame(device, Compiler::Glslang, Variant::Table, parameters, &objects, Preset::Fig6.bench_frame())
        };
        let full = draw(&parameters);
        let scaled = Parameters { volume_scale: 2, ..parameters.clone() };
        let whole = draw(&scaled);
        let difference = fumarole::image::compare(&whole.picture, &full.picture, None).unwrap();
        println!(
            "mean {:.3}, p99 {:.2}; {} of {}",
            difference.mean, difference.p99, whole.evaluations, full.evaluations
        );
        assert!(difference.mean < 0.5 && difference.mean > 0.0, "{difference:?}");
        assert!(whole.evaluations * 2 < full.evaluations, "{} of {}", whole.evaluations, full.evaluations);
        let tiles = draw(&Parameters { lists: Lists::Tiles, ..scaled.clone() });
        assert!(tiles.radiance == whole.radiance);
        // At the borders of bands more pixels are marched.
        let banded = draw(&Parameters { list_bytes: Some(100_000), ..scaled });
        assert!(banded.demand.rows < parameters.height);
        let difference = fumarole::image::compare(&banded.picture, &full.picture, None).unwrap();
        assert!(difference.mean < 0.5, "{difference:?}");
    });
}
