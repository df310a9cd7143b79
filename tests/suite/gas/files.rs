//! Volumes of files against rays in double precision.

use std::sync::Arc;

use fumarole::gpu::Compiler;
use fumarole::papers::gas::grid::{Filter, Grid};
use fumarole::papers::gas::model::{DensityFunction, SolidTexture, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::density::Medium;
use fumarole::papers::gas::reference::rays::Sampling;
use fumarole::papers::gas::reference::shadow_table::density_table;
use fumarole::papers::gas::{March, Parameters, Variant};
use fumarole::scene::random::Random;
use glam::{DVec3, Vec3};

use super::drawing::Drawing;
use super::march::{FRAME, differences, parameters, worst};
use crate::common::gpu_test;

/// Samples at random from -0.2 to 1.2, on axes that are upright, or not.
fn grid(seed: u64, size: [u32; 3], is_skewed: bool) -> Grid {
    let mut random = Random::new(seed);
    let count = size.iter().product::<u32>();
    let samples = (0..count).map(|_| 1.4 * random.unit() - 0.2).collect();
    let side = |axis: usize| 2.0 / f64::from(size[axis]);
    let steps_m = if is_skewed {
        [
            DVec3::new(0.6, 0.1, -0.1) * side(0),
            DVec3::new(0.2, -0.5, 0.3) * side(1),
            DVec3::new(0.1, 0.3, 0.7) * side(2),
        ]
    } else {
        // As a scan has its axes: from the left to the right, up, to the front.
        [DVec3::Z * side(0), DVec3::X * side(1), DVec3::Y * side(2)]
    };
    Grid { size, steps_m, samples, glow: Vec::new() }
}

fn volume(index: usize, grid: &Grid, center: Vec3) -> Volume {
    let texture =
        SolidTexture { function: DensityFunction::Grid(index), opaque: 1.3, power: 1.5, ..default_volume().texture };
    // Faded at the edges of its box: a ray that cuts off less than a corner of it is none to the oracle.
    Volume { center, half_extent_m: grid.half_extent_m().as_vec3(), falloff: 0.2, texture, ..default_volume() }
}

fn scene(grids: Vec<Grid>, filter: Filter) -> Parameters {
    let places = [Vec3::new(0.1, 0.0, -0.1), Vec3::new(0.4, 0.3, 0.5)];
    let volumes = grids.iter().zip(places).enumerate().map(|(i, (grid, at))| volume(i, grid, at)).collect();
    let grids = grids.into_iter().map(Arc::new).collect();
    Parameters { steps: 12, grids, filter, ..parameters(volumes) }
}

#[test]
fn grids_are_marched_as_their_rays_are() {
    gpu_test(|device| {
        for filter in [Filter::Trilinear, Filter::Tricubic] {
            for is_skewed in [false, true] {
                let parameters = scene(vec![grid(1, [9, 7, 8], is_skewed)], filter);
                for (variant, is_shadowed) in
                    [(Variant::None, false), (Variant::Surfaces, false), (Variant::Traced, true)]
                {
                    let drawing = Drawing::of(device, variant, &parameters, &[]);
                    let worst = worst(&differences(&drawing, &parameters, is_shadowed, Sampling::Random));
                    println!("{filter:?}, skewed {is_skewed}, {variant:?}: {worst:.2e}");
                    assert!(worst < 5e-5, "{filter:?}, {is_skewed}, {variant:?}: {worst}");
                }
            }
        }
    });
}

/// Each volume has its own samples, also where it overlaps another, and a grid of one sample is a box of that density.
#[test]
fn several_grids_are_marched_at_once() {
    gpu_test(|device| {
        for filter in [Filter::Trilinear, Filter::Tricubic] {
            let one =
                Grid { samples: vec![0.4], steps_m: [DVec3::X, DVec3::Y, DVec3::Z].map(|s| 1.5 * s), ..Grid::empty() };
            let parameters = scene(vec![grid(2, [5, 6, 2], true), one], filter);
            let drawing = Drawing::of(device, Variant::Traced, &parameters, &[]);
            let worst = worst(&differences(&drawing, &parameters, true, Sampling::Random));
            assert!(worst < 5e-5, "{filter:?}: {worst}");
        }
    });
}

/// Hot gas glows by what it absorbs, in every variant that has rays in double precision beside it, and in froxels.
#[test]
fn temperatures_glow() {
    gpu_test(|device| {
        for (filter, is_skewed) in [(Filter::Trilinear, true), (Filter::Tricubic, false)] {
            let mut hot = grid(5, [6, 5, 7], is_skewed);
            let mut random = Random::new(8);
            hot.glow = hot.samples.iter().map(|_| [3.0 * random.unit(), random.unit(), 0.3 * random.unit()]).collect();
            let mut own = scene(vec![hot, grid(2, [5, 6, 2], true)], filter);
            own.volumes[0].albedo = Vec3::new(0.2, 0.5, 1.0);
            for (variant, is_shadowed) in [(Variant::None, false), (Variant::Traced, true)] {
                for compiler in [Compiler::Glslang, Compiler::Naga] {
                    let drawing = Drawing::frame(device, compiler, variant, &own, &[], 0);
                    let worst = worst(&differences(&drawing, &own, is_shadowed, Sampling::Random));
                    assert!(worst < 5e-5, "{filter:?}, {variant:?}, {compiler:?}: {worst}");
                }
            }
            let mut cold = own.clone();
            cold.grids = own.grids.iter().map(|grid| Arc::new(Grid { glow: Vec::new(), ..(**grid).clone() })).collect();
            let drawing = Drawing::of(device, Variant::None, &cold, &[]);
            let off = differences(&drawing, &own, false, Sampling::Random);
            let [red, blue] = [0, 2].map(|channel| off.iter().map(|d| d[channel].abs()).fold(0.0, f64::max));
            assert!(red > 0.05 && blue < 1e-4, "what absorbs nothing does not glow: {red}, {blue}");
            let tracked = Parameters { march: March::Delta, samples: 64, early_end: 0.3, ..own.clone() };
            let drawing = Drawing::of(device, Variant::None, &tracked, &[]);
            let off = differences(&drawing, &own, false, Sampling::Fine(4));
            let mean = off.iter().sum::<DVec3>() / off.len() as f64;
            assert!(mean.abs().max_element() < 0.03, "{mean}");
        }
    });
}

#[test]
fn both_compilers_march_the_same() {
    gpu_test(|device| {
        for filter in [Filter::Trilinear, Filter::Tricubic] {
            let parameters = scene(vec![grid(5, [6, 7, 5], true)], filter);
            for variant in [Variant::Traced, Variant::Table] {
                let draw = |compiler| Drawing::frame(device, compiler, variant, &parameters, &[], 0).radiance;
                let [ours, nagas] = [Compiler::Glslang, Compiler::Naga].map(draw);
                let worst = ours.iter().zip(&nagas).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(worst < 1e-5, "{filter:?}, {variant:?}: {worst}");
            }
        }
    });
}

/// The table of densities, which shadows are made of.
#[test]
fn grids_are_tabled_as_the_oracle_has_them() {
    gpu_test(|device| {
        const SIZE: u32 = 17;
        for filter in [Filter::Trilinear, Filter::Tricubic] {
            let parameters = scene(vec![grid(3, [9, 7, 8], true), grid(4, [6, 6, 6], false)], filter);
            let mut parameters = Parameters { table_size: SIZE, ..parameters };
            parameters.volumes.iter_mut().for_each(|volume| volume.falloff = 0.0);
            let drawing = Drawing::of(device, Variant::Table, &parameters, &[]);
            let medium = Medium::new(&parameters, FRAME);
            let entries = drawing.entries("density-table", SIZE as usize);
            let tables = entries.chunks_exact((SIZE * SIZE * SIZE) as usize);
            assert_eq!(tables.len(), 2);
            for (table, volume) in tables.zip(&parameters.volumes) {
                let expected = density_table(&medium, volume, SIZE);
                let off = table.iter().zip(&expected).filter(|(a, b)| (f64::from(**a) - **b).abs() > 2e-5).count();
                // Of a skewed grid's corners a point may fall to either side of the border.
                assert!(off <= 2 && expected.iter().any(|&d| d > 0.5), "{filter:?}: {off} entries");
            }
        }
    });
}
