//! Density functions on the device against those of the oracle, by the density table.

use fumarole::papers::gas::model::{DensityFunction, Front, Shape, SolidTexture, Swirl, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::density::Medium;
use fumarole::papers::gas::reference::shadow_table::density_table;
use fumarole::papers::gas::{Parameters, Variant};
use glam::Vec3;

use super::drawing::Drawing;
use crate::common::gpu_test;

const SIZE: u32 = 17;
const FRAME: u32 = 37;

fn largest_differences(
    device: &std::sync::Arc<fumarole::gpu::Device>,
    volumes: &[Volume],
    pixel_size: f32,
    size: u32,
) -> Vec<f64> {
    let parameters = Parameters {
        volumes: volumes.to_vec(),
        table_size: size,
        pixel_size,
        first_frame: FRAME,
        frame_step: 0,
        width: 8,
        height: 8,
        steps: 4,
        ..Parameters::default()
    };
    let drawing = Drawing::of(device, Variant::Table, &parameters, &[]);
    let medium = Medium::new(&parameters, FRAME);
    let entries = drawing.entries("density-table", size as usize);
    let tables = entries.chunks_exact((size * size * size) as usize);
    tables
        .zip(volumes)
        .map(|(table, volume)| {
            let expected = density_table(&medium, volume, size);
            assert!(expected.iter().any(|&d| d != 0.0) && table.iter().all(|d| d.is_finite()));
            table.iter().zip(expected).map(|(&a, b)| (f64::from(a) - b).abs()).fold(0.0, f64::max)
        })
        .collect()
}

/// Noise (one octave) and turbulence at points up to 64 texture units from the origin, exact in single precision,
/// within 1e-5: the gradients of some hundred thousand lattice points, whose hash another one would show at once.
#[test]
fn noise_and_turbulence_are_the_oracles() {
    gpu_test(|device| {
        let texture = SolidTexture { offset: Vec3::new(0.25, 0.625, -0.125), ..default_volume().texture };
        let volume = Volume { half_extent_m: Vec3::splat(63.0 - 31.0), texture, ..default_volume() };
        let far = SolidTexture { offset: Vec3::new(31.5, -30.75, 30.125), ..texture };
        for pixel_size in [0.5, 0.1] {
            let differences = largest_differences(device, &[volume, Volume { texture: far, ..volume }], pixel_size, 33);
            assert!(differences.iter().all(|&d| d < 1e-5), "{pixel_size}: {differences:?}");
        }
    });
}

#[test]
fn every_function_is_the_oracles() {
    gpu_test(|device| {
        let swirl = Swirl { along_per_frame: 0.02, frames: 20.0, ellipse: [0.3, 0.2] };
        let front =
            Front { x_m: -0.8, per_frame_m: 0.02, depth_m: 0.7, full_frames: 50.0, turbulence_m: 0.5, table_m: 0.3 };
        let functions = [
            DensityFunction::Constant,
            DensityFunction::Turbulence,
            DensityFunction::Clouds { frequency: 4.0 },
            DensityFunction::Fog { swirl, front },
            DensityFunction::Steam { swirl },
            DensityFunction::Hypertexture { amplitude: 0.8, softness: 0.4 },
        ];
        let shapes = [Shape::Box, Shape::Sphere, Shape::Cylinder, Shape::Frustum { bottom: 0.4, top: 0.9 }];
        let volumes: Vec<Volume> = functions
            .into_iter()
            .enumerate()
            .map(|(i, function)| {
                let texture = SolidTexture { function, opaque: 1.3, power: 1.5, ..default_volume().texture };
                Volume { shape: shapes[i % 4], falloff: 0.3, texture, ..default_volume() }
            })
            .collect();
        let differences = largest_differences(device, &volumes, 0.1, SIZE);
        // A point on the boundary may fall to either side; the falloff makes the density 0 there.
        assert!(differences.iter().all(|&d| d < 2e-4), "{differences:?}");
    });
}
