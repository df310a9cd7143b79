//! Small maps.

use std::f32::consts::TAU;
use std::sync::Arc;

use fumarole::papers::terrain::{MapInput, Placement};
use fumarole::scene::random::Random;
use fumarole::scene::{HeightMap, Samples};
use glam::DVec2;

/// Metres of the volcano from side to side.
const EXTENT_M: f64 = 12_000.0;

/// A cone with a crater, gullies and some roughness, the same terrain at every number of samples a side.
pub fn volcano(side: u32) -> HeightMap {
    let height = |column: u32, row: u32| {
        let at = |i: u32| (i as f32 / (side - 1) as f32 - 0.5) * 2.0;
        let (x, z) = (at(column), at(row));
        let distance = x.hypot(z);
        let angle = z.atan2(x);
        let cone = 1800.0 * (-4.0 * distance).exp();
        let crater = -900.0 * (-(distance / 0.09).powi(2)).exp();
        let gully = 90.0 * (angle * 17.0 + 5.0 * (3.0 * distance).sin()).sin() * distance * (1.0 - distance).max(0.0);
        let rough = 12.0 * (TAU * 9.0 * x).sin() * (TAU * 7.0 * z).cos() * distance;
        400.0 + cone + crater + gully + rough
    };
    let heights = (0..side).flat_map(|row| (0..side).map(move |column| height(column, row)));
    let values = heights.map(|h| (h * 8.0).round() as u16).collect();
    map(side, side, Samples::Steps { values, origin_m: 0.0, step_m: 0.125 }, EXTENT_M / f64::from(side - 1))
}

pub fn map(width: u32, height: u32, samples: Samples, spacing_m: f64) -> HeightMap {
    HeightMap::new(width, height, samples).unwrap().with_spacing_m(DVec2::splat(spacing_m)).unwrap()
}

/// One map in the middle of the world.
pub fn alone(map: HeightMap) -> Vec<MapInput> {
    vec![MapInput { map: Arc::new(map), placement: Placement::default() }]
}

/// Maps that break careless bounds.
pub fn adversaries() -> Vec<(&'static str, HeightMap)> {
    let steps = |width: u32, height: u32, value: &dyn Fn(u32, u32) -> u16| {
        let values = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let values = values.map(|(column, row)| value(column, row)).collect();
        map(width, height, Samples::Steps { values, origin_m: -3.0, step_m: 0.01 }, 1.5)
    };
    let floats = |width: u32, height: u32, value: &dyn Fn(u32, u32) -> f32| {
        let values = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        map(width, height, Samples::Float(values.map(|(column, row)| value(column, row)).collect()), 1.5)
    };
    vec![
        ("spike", steps(67, 43, &|column, row| if (column, row) == (31, 17) { 6000 } else { 0 })),
        ("checkerboard", steps(32, 32, &|column, row| if (column + row) % 2 == 0 { 1500 } else { 0 })),
        ("cliff", steps(50, 33, &|column, _| if column > 47 { 4000 } else { 100 })),
        ("plateau", steps(17, 17, &|_, _| 700)),
        ("two by two", steps(2, 2, &|column, row| (1000 * (column + row)) as u16)),
        ("ditch", floats(5, 90, &|column, row| if row == 44 { -40.0 } else { column as f32 })),
    ]
}

/// Ridges and gorges at every scale down to the cells, 100 m apart: octaves of noise folded at its middle, each rough where the
/// one before is high.
pub fn ridges(random: &mut Random, (width, height): (u32, u32), highest_m: f32) -> HeightMap {
    let mut heights = vec![0.0_f32; (width * height) as usize];
    let mut carried = vec![1.0_f32; heights.len()];
    for octave in 0..6 {
        let knots = 3 << octave;
        let grid: Vec<f32> = (0..(knots + 2) * (knots + 2)).map(|_| random.unit()).collect();
        for (index, (sum, carried)) in heights.iter_mut().zip(&mut carried).enumerate() {
            let along = |at: u32, side: u32| {
                let place = at as f32 / side as f32 * knots as f32;
                let t = place.fract();
                (place as usize, t * t * (3.0 - 2.0 * t))
            };
            let ((i, a), (j, b)) = (along(index as u32 % width, width), along(index as u32 / width, height));
            let at = |i: usize, j: usize| grid[j * (knots + 2) + i];
            let north = at(i, j) + (at(i + 1, j) - at(i, j)) * a;
            let south = at(i, j + 1) + (at(i + 1, j + 1) - at(i, j + 1)) * a;
            let folded = 1.0 - (2.0 * (north + (south - north) * b) - 1.0).abs();
            *carried *= folded * folded;
            *sum += *carried * 0.6_f32.powi(octave);
        }
    }
    let top = heights.iter().copied().fold(1e-3, f32::max);
    map(width, height, Samples::Float(heights.iter().map(|h| h / top * highest_m).collect()), 100.0)
}
