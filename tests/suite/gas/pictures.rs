//! The figures' pictures: goldens, and how near the shadow table's are to those of traced rays.

use std::path::Path;

use fumarole::gpu::Compiler;
use fumarole::image::compare;
use fumarole::image::golden::{self, Tolerance};
use fumarole::papers::gas::model::{Highlight, Object};
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::Light;
use glam::Vec3;

use super::drawing::Drawing;
use super::scenes::small;
use crate::common::gpu_test;

/// Tight: the same Mesa draws the same picture, another one rounds differently here and there.
const TOLERANCE: Tolerance = Tolerance { mean: 0.1, p99: 1.0 };

#[test]
fn the_pictures_are_the_golden_ones() {
    gpu_test(|device| {
        for preset in Preset::ALL {
            let (parameters, objects) = small(preset);
            let frame = preset.bench_frame();
            let drawing = Drawing::frame(device, Compiler::Glslang, preset.variant(), &parameters, &objects, frame);
            let file = format!("tests/golden/gas-{}.png", preset.as_str());
            let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
            let output_dir = Path::new(env!("CARGO_TARGET_TMPDIR"));
            if let Err(error) = golden::check(&drawing.picture, &golden, TOLERANCE, output_dir) {
                panic!("{error}");
            }
        }
    });
}

/// In gas denser than 1 % opacity, a table of 64 entries a side is within 2 L*u*v* of tracing on average, and within 6
/// at the 99th percentile.
#[test]
fn the_table_s_picture_is_near_the_traced_one() {
    gpu_test(|device| {
        for preset in [Preset::Fig8, Preset::Fig5] {
            let (mut parameters, objects) = small(preset);
            (parameters.steps, parameters.table_size) = (40, 64);
            let frame = preset.bench_frame();
            let draw = |variant, parameters: &Parameters, objects: &[Object]| {
                Drawing::frame(device, Compiler::Glslang, variant, parameters, objects, frame)
            };
            // Gas that shines with its opacity, between black surfaces.
            let mut shining = parameters.clone();
            shining.volumes.iter_mut().for_each(|volume| volume.albedo = Vec3::ONE);
            shining.lights = vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO }];
            (shining.ambient, shining.background) = (Vec3::ONE, Vec3::ZERO);
            let black = |object: &Object| Object {
                color: Vec3::ZERO,
                checker: None,
                highlight: Highlight { strength: 0.0, exponent: 1.0 },
                ..object.clone()
            };
            let black: Vec<Object> = objects.iter().map(black).collect();
            let opacity = draw(Variant::None, &shining, &black);
            let mask: Vec<bool> = opacity.radiance.chunks_exact(4).map(|p| p[0] > 0.01).collect();
            let table = draw(Variant::Table, &parameters, &objects).picture;
            let traced = draw(Variant::Traced, &parameters, &objects).picture;
            let none = draw(Variant::None, &parameters, &objects).picture;
            let near = compare(&table, &traced, Some(&mask)).unwrap();
            println!("{preset:?}: mean {:.3}, p99 {:.3} over {} pixels", near.mean, near.p99, near.pixels);
            assert!(near.pixels > 200 && near.mean < 2.0 && near.p99 < 6.0, "{preset:?}: {near:?}");
            // Shadows are seen at all.
            assert!(compare(&none, &traced, Some(&mask)).unwrap().mean > 2.0 * near.mean, "{preset:?}");
        }
    });
}
