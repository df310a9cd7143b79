//! The finished picture.

use std::path::Path;

use fumarole::image::golden::{self, Tolerance};
use fumarole::measure::Variant as _;
use fumarole::papers::terrain::{Lod, Parameters, Variant, View};

use super::drawing::Drawing;
use super::maps::{alone, volcano};
use crate::common::gpu_test;

/// Tight: the same Mesa draws the same picture, another one rounds differently here and there.
const TOLERANCE: Tolerance = Tolerance { mean: 0.1, p99: 1.0 };

#[test]
fn the_pictures_are_the_golden_ones() {
    gpu_test(|device| {
        for (name, view) in [("side", View::Side), ("top", View::Top)] {
            for variant in [Variant::GpuCompute, Variant::Mesh] {
                let parameters = Parameters { view, shadows: true, width: 128, height: 96, ..Parameters::default() };
                let drawing = Drawing::of(device, variant, &parameters, &alone(volcano(100)));
                let file = format!("tests/golden/terrain-{name}-{}.png", variant.as_str());
                let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
                let output_dir = Path::new(env!("CARGO_TARGET_TMPDIR"));
                if let Err(error) = golden::check(&drawing.picture, &golden, TOLERANCE, output_dir) {
                    panic!("{error}");
                }
            }
        }
    });
}

#[test]
fn one_configuration_gives_one_picture() {
    gpu_test(|device| {
        for variant in Variant::ALL {
            let parameters = Parameters { lod: Lod::Exact, width: 96, height: 64, ..Parameters::default() };
            let of = || Drawing::of(device, *variant, &parameters, &alone(volcano(50))).picture;
            assert_eq!(of().pixels(), of().pixels(), "{variant:?}");
        }
    });
}
