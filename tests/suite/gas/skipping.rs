//! Bricks without density, which rays skip: bounds of the density, pictures with and without.

use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::papers::gas::grid::{Filter, Grid};
use fumarole::papers::gas::model::{DensityFunction, Object, Shape, SolidTexture, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::density::Medium;
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::Mesh;
use fumarole::scene::random::Random;
use glam::{DVec3, Vec3};

use super::drawing::Drawing;
use super::march::{FRAME, gases, parameters};
use crate::common::gpu_test;

const ALL: [Variant; 4] = [Variant::None, Variant::Surfaces, Variant::Traced, Variant::Table];
const TRACED: [Variant; 1] = [Variant::Traced];

/// Zero but for a few boxes, on axes that are upright or not.
fn sparse(is_skewed: bool) -> Grid {
    let size = [14, 11, 13];
    let mut random = Random::new(5);
    let mut samples = vec![0.0; 14 * 11 * 13];
    for (x, y, z) in [(2, 3, 4), (9, 6, 8), (10, 7, 9), (5, 1, 11)] {
        for i in 0..8 {
            samples[((z + (i >> 2)) * 11 + y + (i >> 1 & 1)) * 14 + x + (i & 1)] = 0.2 + 0.8 * random.unit();
        }
    }
    let steps_m = if is_skewed {
        [DVec3::new(0.12, 0.02, -0.02), DVec3::new(0.03, -0.14, 0.04), DVec3::new(0.02, 0.05, 0.12)]
    } else {
        [DVec3::Z * 0.14, DVec3::X * 0.17, DVec3::Y * 0.14]
    };
    Grid { size, steps_m, samples, glow: Vec::new() }
}

fn of_grid(grid: Grid, filter: Filter) -> Parameters {
    let texture = SolidTexture { function: DensityFunction::Grid(0), ..default_volume().texture };
    let volume = Volume { half_extent_m: grid.half_extent_m().as_vec3(), texture, tau_per_m: 5.0, ..default_volume() };
    Parameters { grids: vec![Arc::new(grid)], filter, ..parameters(vec![volume]) }
}

/// A gas that is nowhere but in a part of its solid.
fn patchy() -> Vec<Volume> {
    let mut fog = gases()[3];
    let DensityFunction::Fog { front, .. } = &mut fog.texture.function else { panic!("gases()[3] is the fog") };
    (front.x_m, front.turbulence_m, front.table_m) = (-1.2, 0.1, 0.1);
    let mut ball = gases()[5];
    ball.shape = Shape::Box;
    let solid = Volume { is_solid: true, tau_per_m: 8.0, ..ball };
    vec![fog, ball, solid]
}

/// A plane below the gas that takes its shadow.
pub fn ground() -> Object {
    let positions = [(-3.0, -3.0), (-3.0, 3.0), (3.0, 3.0), (3.0, -3.0)].map(|(x, z)| Vec3::new(x, -1.3, z)).to_vec();
    let mesh = Mesh { positions, normals: vec![Vec3::Y; 4], indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() };
    Object::new(mesh, Vec3::splat(0.6))
}

/// Drawn with all bricks and with those alone that have density; bit for bit the same.
fn is_drawn_alike(device: &Arc<Device>, variants: &[Variant], parameters: &Parameters, name: &str, is_patchy: bool) {
    for &variant in variants {
        let whole = Drawing::of(device, variant, parameters, &[ground()]);
        for bricks in [5, 16] {
            let skipping = Parameters { skip_empty: Some(0.0), bricks, ..parameters.clone() };
            let skipped = Drawing::of(device, variant, &skipping, &[ground()]);
            assert!(skipped.radiance == whole.radiance, "{name}, {variant:?}, {bricks} bricks");
            assert!(skipped.evaluations <= whole.evaluations);
            if is_patchy && bricks == 16 {
                println!("{name}, {variant:?}: {} of {} samples", skipped.evaluations, whole.evaluations);
                assert!(skipped.evaluations < whole.evaluations * 9 / 10, "{name}, {variant:?}");
            }
        }
    }
}

#[test]
fn what_is_empty_is_skipped_bit_for_bit() {
    gpu_test(|device| {
        for (i, gas) in gases().into_iter().enumerate() {
            let parameters = Parameters { steps: 25, table_size: 8, ..parameters(vec![gas]) };
            is_drawn_alike(device, &TRACED, &parameters, &format!("gas {i}"), false);
        }
        for (i, gas) in patchy().into_iter().enumerate() {
            let own = Parameters { steps: 40, table_size: 8, ..parameters(vec![gas]) };
            is_drawn_alike(device, &ALL, &own, &format!("patchy {i}"), true);
            let cached = Parameters { density_cache: Some(20), ..own };
            is_drawn_alike(device, &TRACED, &cached, &format!("patchy {i}, cached"), true);
        }
    });
}

#[test]
fn files_are_skipped_bit_for_bit() {
    gpu_test(|device| {
        for filter in [Filter::Trilinear, Filter::Tricubic] {
            for is_skewed in [false, true] {
                let own = Parameters { steps: 40, table_size: 8, ..of_grid(sparse(is_skewed), filter) };
                is_drawn_alike(device, &TRACED, &own, &format!("{filter:?}, skewed {is_skewed}"), true);
            }
        }
        let cached = Parameters { density_cache: Some(24), ..of_grid(sparse(true), Filter::Tricubic) };
        is_drawn_alike(device, &TRACED, &cached, "cached file", true);
    });
}

/// Volumes that overlap: only what all have nothing in is skipped; several samples of an increment, and naga's shaders.
#[test]
fn overlapping_volumes_are_skipped_bit_for_bit() {
    gpu_test(|device| {
        let mut volumes = patchy();
        volumes[1].center = Vec3::new(0.6, 0.3, -0.4);
        volumes[2].center = Vec3::new(-0.5, -0.2, 0.5);
        let own = Parameters { steps: 30, samples: 2, table_size: 8, early_end: 0.05, ..parameters(volumes) };
        is_drawn_alike(device, &ALL, &own, "overlapping", true);
        let draw = |skip_empty| {
            let parameters = Parameters { skip_empty, ..own.clone() };
            Drawing::frame(device, Compiler::Naga, Variant::Traced, &parameters, &[ground()], 0).radiance
        };
        assert!(draw(None) == draw(Some(0.0)));
    });
}

/// No point of a brick is denser than its bound, and a brick of 0 takes no more of a ray than was asked for.
#[test]
fn bricks_bound_the_density() {
    gpu_test(|device| {
        let functions = gases().into_iter().chain(patchy()).map(|gas| parameters(vec![gas]));
        let files = [Filter::Trilinear, Filter::Tricubic].map(|filter| of_grid(sparse(true), filter));
        let own: Vec<Parameters> = functions.chain(files).collect();
        let cached = own.iter().map(|p| Parameters { density_cache: Some(13), ..p.clone() });
        for parameters in own.iter().cloned().chain(cached) {
            for lost in [0.0, 0.05] {
                let n = 6;
                let parameters = Parameters { steps: 4, skip_empty: Some(lost), bricks: n, ..parameters.clone() };
                let drawing = Drawing::of(device, Variant::None, &parameters, &[]);
                let (medium, volume) = (Medium::new(&parameters, FRAME), &parameters.volumes[0]);
                let half = volume.half_extent_m.as_dvec3();
                let most = f64::from(lost) / (f64::from(volume.tau_per_m) * 2.0 * half.length());
                let mut random = Random::new(9);
                for (i, &bound) in drawing.target("bricks").iter().enumerate() {
                    let at = [i as u32 % n, i as u32 / n % n, i as u32 / (n * n)];
                    for _ in 0..40 {
                        let q =
                            at.map(|a| f64::from(a) + f64::from(random.unit())).map(|a| 2.0 * a / f64::from(n) - 1.0);
                        let density = medium.density(volume, volume.center.as_dvec3() + DVec3::from(q) * half);
                        let limit = if bound > 0.0 { f64::from(bound) } else { most };
                        assert!(
                            density <= limit * (1.0 + 3e-5) + 1e-9,
                            "{:?}, brick {i}: {density} above {limit}",
                            volume.texture.function
                        );
                    }
                }
            }
        }
    });
}

/// Of a table the bound is its greatest entry round the brick, no more.
#[test]
fn bounds_of_a_table_are_its_entries() {
    gpu_test(|device| {
        let gas = Volume { falloff: 0.0, shape: Shape::Box, ..gases()[1] };
        let (n, entries) = (4, 13);
        let parameters = Parameters {
            steps: 4,
            skip_empty: Some(0.0),
            density_cache: Some(entries),
            bricks: n,
            ..parameters(vec![gas])
        };
        let drawing = Drawing::of(device, Variant::None, &parameters, &[]);
        // The first of four that stand together is the entry's own.
        let values: Vec<f32> = drawing.target("density-cache").iter().step_by(4).copied().collect();
        // Three cells of the table a brick, and by the bricks' overlap the cells beside them.
        for (i, &bound) in drawing.target("bricks").iter().enumerate() {
            let low = [i % 4, i / 4 % 4, i / 16].map(|b| (3 * b).saturating_sub(1));
            let mut greatest = 0.0_f32;
            for e in 0..6 * 6 * 6 {
                let at = [low[0] + e % 6, low[1] + e / 6 % 6, low[2] + e / 36];
                let ends = [i % 4, i / 4 % 4, i / 16].map(|b| 3 * b + 4);
                if (0..3).all(|axis| at[axis] <= ends[axis].min(12)) {
                    greatest = greatest.max(values[(at[2] * 13 + at[1]) * 13 + at[0]]);
                }
            }
            assert!((bound / greatest - 1.0001).abs() < 1e-5, "brick {i}: {bound} for {greatest}");
        }
    });
}

/// Of thin gas a ray loses no more than it was told to: transparency and each light change by a factor within exp(depth).
#[test]
fn thin_gas_is_lost_within_the_bound() {
    gpu_test(|device| {
        let gas = Volume { falloff: 0.8, ..gases()[4] };
        let own = Parameters { steps: 40, density_cache: Some(32), ..parameters(vec![gas]) };
        for variant in [Variant::None, Variant::Traced] {
            let whole = Drawing::of(device, variant, &own, &[]);
            let brightest = whole.radiance.iter().copied().fold(0.0, f32::max);
            for lost in [0.02, 0.1] {
                let skipping = Parameters { skip_empty: Some(lost), ..own.clone() };
                let skipped = Drawing::of(device, variant, &skipping, &[]);
                let pairs = whole.radiance.iter().zip(&skipped.radiance);
                let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                println!(
                    "{variant:?}, {lost}: {worst} of {brightest}, {} of {} samples",
                    skipped.evaluations, whole.evaluations
                );
                assert!(worst > 0.0 && worst <= 2.0 * lost * brightest, "{variant:?}, {lost}: {worst}");
                assert!(skipped.evaluations < whole.evaluations);
            }
        }
    });
}
