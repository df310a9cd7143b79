//! Gas in froxels: against froxels in double precision, and the nearer to fine rays the more there are.

use std::sync::Arc;

use fumarole::gpu::Compiler;
use fumarole::papers::gas::grid::Grid;
use fumarole::papers::gas::model::{DensityFunction, Object, SolidTexture, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::froxels::Froxels;
use fumarole::papers::gas::reference::rays::Sampling;
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::{Camera, shapes};
use glam::{DVec3, Mat4, UVec2, Vec2, Vec3};

use super::drawing::Drawing;
use super::march::{FRAME, HEIGHT, WIDTH, differences, gases, parameters};
use crate::common::gpu_test;

/// The largest difference of a pixel's colour from that of froxels in double precision.
fn off(drawing: &Drawing, parameters: &Parameters) -> f64 {
    let froxels = Froxels::new(parameters, FRAME);
    let mut seen = 0.0;
    let difference = |pixel: u32| {
        let gas = froxels.pixel(pixel % WIDTH, pixel / WIDTH);
        seen += 1.0 - gas.transparency;
        let expected = gas.color + parameters.background.as_dvec3() * gas.transparency;
        (drawing.color(pixel as usize) - expected).abs().max_element()
    };
    let worst = (0..WIDTH * HEIGHT).map(difference).fold(0.0, f64::max);
    assert!(seen > 5.0, "there is no gas in the picture: {seen}");
    worst
}

fn froxels(volumes: Vec<Volume>, froxels: [u32; 3]) -> Parameters {
    Parameters { froxels, table_size: 14, ..parameters(volumes) }
}

/// Every gas in every shape, with one sample a froxel and with several, by both compilers.
#[test]
fn gas_in_froxels_is_their_sum() {
    gpu_test(|device| {
        for (number, gas) in gases().into_iter().enumerate() {
            let size = [[9, 7, 10], [24, 16, 5], [1, 3, 17]][number % 3];
            let samples = [1, 3][number % 2];
            let parameters = Parameters { samples, ..froxels(vec![gas], size) };
            for compiler in [Compiler::Glslang, Compiler::Naga] {
                let drawing = Drawing::frame(device, compiler, Variant::Froxel, &parameters, &[], 0);
                let off = off(&drawing, &parameters);
                println!("{:?}, {compiler:?}: {off:.2e}", gas.texture.function);
                assert!(off < 1e-3, "{:?}, {compiler:?}: {off}", gas.texture.function);
            }
        }
    });
}

/// Volumes that overlap, with the eye in the gas, and densities from a table of them.
#[test]
fn froxels_hold_all_volumes_and_begin_at_the_eye() {
    gpu_test(|device| {
        let mut volumes: Vec<Volume> = gases().into_iter().take(3).collect();
        volumes[1].center = Vec3::new(0.5, 0.4, 0.3);
        volumes[2].half_extent_m *= 1.4;
        for eye in [Vec3::new(1.0, 1.4, 5.0), Vec3::new(0.2, 0.1, 0.6)] {
            for density_cache in [None, Some(12)] {
                let mut parameters = Parameters { density_cache, ..froxels(volumes.clone(), [8, 6, 12]) };
                parameters.camera = Camera { eye, ..parameters.camera };
                let drawing = Drawing::of(device, Variant::Froxel, &parameters, &[]);
                let off = off(&drawing, &parameters);
                println!("from {eye}, {density_cache:?}: {off:.2e}");
                assert!(off < 2e-3, "from {eye}, {density_cache:?}: {off}");
            }
        }
    });
}

/// A file's temperatures glow in froxels too.
#[test]
fn temperatures_glow_in_froxels() {
    gpu_test(|device| {
        let steps_m = [DVec3::X, DVec3::Y, DVec3::Z].map(|step| step * 0.6);
        let samples: Vec<f32> = (0..27).map(|i| 0.3 + 0.02 * i as f32).collect();
        let glow = (0..27).map(|i| [2.0 - 0.05 * i as f32, 0.03 * i as f32, 0.1]).collect();
        let grid = Grid { size: [3; 3], steps_m, samples, glow };
        let texture = SolidTexture { function: DensityFunction::Grid(0), ..default_volume().texture };
        let half_extent_m = grid.half_extent_m().as_vec3();
        let gas = Volume { half_extent_m, texture, falloff: 0.2, ..default_volume() };
        let hot = Parameters { grids: vec![Arc::new(grid)], ..froxels(vec![gas], [9, 7, 10]) };
        let drawing = Drawing::of(device, Variant::Froxel, &hot, &[]);
        assert!(off(&drawing, &hot) < 1e-3, "{}", off(&drawing, &hot));
    });
}

/// Pictures come nearer to fine rays with shadows as froxels become more.
#[test]
fn more_froxels_are_nearer_to_fine_rays() {
    gpu_test(|device| {
        let gas = gases()[4];
        let own = Parameters { table_size: 48, ..parameters(vec![gas]) };
        let mean = |froxels: [u32; 3]| {
            let drawing = Drawing::of(device, Variant::Froxel, &Parameters { froxels, ..own.clone() }, &[]);
            let differences = differences(&drawing, &own, true, Sampling::Fine(2));
            differences.iter().map(|d| d.abs().max_element()).sum::<f64>() / differences.len() as f64
        };
        let means = [[6, 4, 4], [12, 8, 8], [24, 16, 32]].map(mean);
        println!("means of the difference: {means:.5?}");
        assert!(means[1] < 0.7 * means[0] && means[2] < 0.5 * means[1], "{means:?}");
    });
}

/// A pane in the gas hides what is behind it, as far as it does, and lets nothing of it through around its edge.
#[test]
fn a_surface_cuts_the_gas_at_its_own_depth() {
    gpu_test(|device| {
        let gas = Volume { falloff: 0.0, half_extent_m: Vec3::splat(1.0), ..gases()[0] };
        let mut own = Parameters { ambient: Vec3::ONE, ..froxels(vec![gas], [12, 8, 24]) };
        // The light of one inside changes more from froxel to froxel than they hold.
        own.lights.truncate(2);
        let pane = |opacity: f32| {
            let turn = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
            let mesh = shapes::plane(Vec2::splat(0.8), UVec2::ONE).transformed(&turn);
            Object { opacity, ..Object::new(mesh, Vec3::splat(0.5)) }
        };
        for opacity in [1.0, 0.5] {
            let froxel = Drawing::of(device, Variant::Froxel, &own, &[pane(opacity)]);
            let table = Drawing::of(device, Variant::Table, &own, &[pane(opacity)]);
            let covered: Vec<usize> = (0..froxel.lists.len()).filter(|&pixel| froxel.lists[pixel].len() == 1).collect();
            assert!(covered.len() > 20, "{} pixels of the pane", covered.len());
            for pixel in covered {
                let off = (froxel.color(pixel) - table.color(pixel)).abs().max_element();
                assert!(off < 0.02, "{opacity}, pixel {pixel}: {off} of {}", table.color(pixel));
            }
        }
    });
}
