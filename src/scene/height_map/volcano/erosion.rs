//! Gullies and ridges that run down the slope and branch, octave by octave.

use super::noise::Noise;
use super::relief::ramp;
use glam::{IVec2, Vec2};

/// Wavelength of the widest gullies.
const WIDEST_M: f32 = 700.0;
/// Depth of the widest gullies in a slope of 45 degrees.
const DEEPEST_M: f32 = 78.0;
/// Strength with which gullies deflect those of the next octave into them.
const BRANCHING: f32 = 0.55;
const OCTAVES: u32 = 5;

/// Metres that erosion adds to the height at `place` (metres east and north), where the uneroded terrain has the
/// gradient `slope` (metres a metre).
///
/// Each octave is a patchwork of waves whose crests point down the slope. A patch's wave is damped towards its edge,
/// and patches overlap, so that gullies begin, join and end. The slope that an octave sees includes the octaves before
/// it: small gullies run into the large ones.
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

/// Greatest offset of a patch's centre from its cell's, and the patch's radius, in cells. No patch reaches beyond the
/// neighbouring cells, and one reaches every place: sqrt(2) (0.5 + 0.3) < 1.2 = 1.5 - 0.3.
const STRAY: f32 = 0.3;
const RADIUS: f32 = 1.2;

/// Waves of length 1 along `across`, a unit vector, and how they change along it.
fn waves(noise: Noise, octave: u32, place: Vec2, across: Vec2) -> (f32, f32) {
    let floor = place.floor();
    let (cell, inside) = (floor.as_ivec2(), place - floor);
    let (mut wave, mut change, mut weights) = (0.0, 0.0, 0.0);
    for y in -1..=1 {
        for x in -1..=1 {
            let neighbour = IVec2::new(x, y);
            let jitter = noise.cell(cell + neighbour + IVec2::splat(7_919 * octave as i32)) * STRAY;
            let offset = inside - (neighbour.as_vec2() + 0.5 + jitter);
            let near = (1.0 - offset.length_squared() / (RADIUS * RADIUS)).max(0.0);
            let weight = near * near * near;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabolas_are_close_to_sine_and_cosine() {
        for step in -300..300 {
            let turns = step as f32 / 97.0;
            let (sine, cosine) = sine_cosine(turns);
            let (true_sine, true_cosine) = (turns * std::f32::consts::TAU).sin_cos();
            assert!((sine - true_sine).abs() < 0.0012 && (cosine - true_cosine).abs() < 0.0012, "{turns}");
        }
    }

    #[test]
    fn gullies_are_bounded_and_have_no_steps_from_patch_to_patch() {
        let noise = Noise::new(3, 0);
        let height_m = |step: i32| eroded_m(noise, Vec2::new(step as f32 * 0.25, 17.0), Vec2::new(-0.3, 0.5));
        let most_m: f32 = (0..OCTAVES).map(|octave| DEEPEST_M * 0.45_f32.powi(octave as i32)).sum();
        for step in -20_000..20_000 {
            assert!(height_m(step).abs() <= most_m);
            // A slope of two, over a quarter of a metre.
            assert!((height_m(step + 1) - height_m(step)).abs() < 0.5, "{step}");
        }
        assert_eq!(eroded_m(noise, Vec2::new(1.0, 2.0), Vec2::ZERO), 0.0);
    }
}
