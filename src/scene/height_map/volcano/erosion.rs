//! Gullies and ridges that run down the slope and branch, octave by octave.

use super::noise::Noise;
use super::relief::ramp;
use glam::{IVec2, Vec2};

/// Wavelength of the widest gullies.
const WIDEST_M: f32 = 700.0;
/// How deep the widest gullies cut into a slope of 45 degrees.
const DEEPEST_M: f32 = 78.0;
/// How strongly gullies turn those of the next octave into them.
const BRANCHING: f32 = 0.55;
const OCTAVES: u32 = 5;

/// What erosion adds to the height at `place` (metres east and north), where the uneroded land has the gradient `slope`
/// (metres a metre).
///
/// Each octave is a patchwork of waves whose crests point down the slope. A patch's wave is damped towards its edge, and
/// patches overlap, so that gullies begin, join and end. The slope that an octave sees includes the octaves before it:
/// small gullies run into the large ones.
pub(super) fn eroded_m(noise: Noise, place: Vec2, slope: Vec2) -> f32 {
    let (mut height_m, mut total_slope) = (0.0, slope);
    let (mut wavelength_m, mut depth_m) = (WIDEST_M, DEEPEST_M);
    for octave in 0..OCTAVES {
        let steepness = total_slope.length();
        let strength = ramp(0.06, 0.55, steepness);
        if strength > 0.0 {
            let across = Vec2::new(-total_slope.y, total_slope.x) / steepness;
            let (wave, change) = waves(noise, octave, place / wavelength_m, across);
            height_m += depth_m * strength * wave;
            total_slope += across * (BRANCHING * depth_m * strength * change / wavelength_m);
        }
        wavelength_m *= 0.5;
        depth_m *= 0.45;
    }
    height_m
}

/// Waves of length 1 along `across`, a unit vector, and how they change along it.
fn waves(noise: Noise, octave: u32, place: Vec2, across: Vec2) -> (f32, f32) {
    let floor = place.floor();
    let (cell, inside) = (floor.as_ivec2(), place - floor);
    let (mut wave, mut change, mut weights) = (0.0, 0.0, 0.0);
    for y in -1..=1 {
        for x in -1..=1 {
            let neighbour = IVec2::new(x, y);
            let jitter = noise.cell(cell + neighbour + IVec2::splat(7_919 * octave as i32)) * 0.4;
            let offset = inside - (neighbour.as_vec2() + 0.5 + jitter);
            let near = (1.0 - offset.length_squared() / 1.96).max(0.0);
            let weight = near * near * near * near;
            let (sine, cosine) = sine_cosine(offset.dot(across));
            wave += weight * cosine;
            change -= weight * sine;
            weights += weight;
        }
    }
    (wave / weights, change * std::f32::consts::TAU / weights)
}

/// Sine and cosine of `turns` full turns, to 0.001: parabolas, equal on every machine.
fn sine_cosine(turns: f32) -> (f32, f32) {
    let sine = |turns: f32| {
        let x = turns - turns.round();
        let arch = 8.0 * x - 16.0 * x * x.abs();
        arch * (0.775 + 0.225 * arch.abs())
    };
    (sine(turns), sine(turns + 0.25))
}
