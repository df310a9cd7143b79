//! Gullies and ridges that run down the slope and branch, octave by octave.

use super::noise::{Noise, cell_and_inside};
use super::relief::ramp;
use glam::{IVec2, Vec2};

/// Wavelength of the widest gullies.
const WIDEST_M: f32 = 700.0;
/// Depth of the widest gullies in a slope of 45 degrees.
const DEEPEST_M: f32 = 78.0;
/// Strength with which gullies deflect those of the next octave into them.
const BRANCHING: f32 = 0.55;
const OCTAVES: i32 = 5;

/// Gullies of all sizes over a square.
pub(super) struct Gullies {
    octaves: Vec<Patches>,
}

/// The patches of one octave: how far each one's centre is off that of its cell, in cells.
struct Patches {
    wavelength_m: f32,
    depth_m: f32,
    /// The least cell along both axes.
    first: i32,
    side: usize,
    offsets: Vec<Vec2>,
}

impl Gullies {
    /// Over places as far as `reach_m` from the origin along either axis.
    pub(super) fn new(noise: Noise, reach_m: f32) -> Self {
        let (mut wavelength_m, mut depth_m) = (WIDEST_M, DEEPEST_M);
        let octave = |octave: i32| {
            // A cell farther for patches that reach over the edge, and one for rounding.
            let last = (reach_m / wavelength_m).ceil() as i32 + 1;
            let (first, side) = (-last - 1, 2 * last as usize + 2);
            let cell =
                |i: usize| IVec2::new((i % side) as i32, (i / side) as i32) + IVec2::splat(first + 7_919 * octave);
            let offsets = (0..side * side).map(|i| noise.cell(cell(i)) * STRAY).collect();
            let patches = Patches { wavelength_m, depth_m, first, side, offsets };
            wavelength_m *= 0.5;
            depth_m *= 0.45;
            patches
        };
        Gullies { octaves: (0..OCTAVES).map(octave).collect() }
    }

    /// Metres that erosion adds to the height at `place` (metres east and north), where the uneroded terrain has the
    /// gradient `slope` (metres a metre).
    ///
    /// Each octave is a patchwork of waves whose crests point down the slope. A patch's wave is damped towards its
    /// edge, and patches overlap, so that gullies begin, join and end. The slope that an octave sees includes the
    /// octaves before it: small gullies run into the large ones.
    pub(super) fn eroded_m(&self, place: Vec2, slope: Vec2) -> f32 {
        let (mut height_m, mut total_slope) = (0.0, slope);
        for patches in &self.octaves {
            let steepness = total_slope.length();
            let strength = ramp(0.06, 0.55, steepness);
            if strength > 0.0 {
                let across = Vec2::new(-total_slope.y, total_slope.x) / steepness;
                let (wave, change) = patches.waves(place / patches.wavelength_m, across);
                height_m += patches.depth_m * strength * wave;
                total_slope += across * (BRANCHING * patches.depth_m * strength * change / patches.wavelength_m);
            }
        }
        height_m
    }
}

/// Greatest offset of a patch's centre from its cell's, and the patch's radius, in cells. No patch reaches beyond the
/// neighbouring cells, and one reaches every place: sqrt(2) (0.5 + 0.3) < 1.2 = 1.5 - 0.3.
const STRAY: f32 = 0.3;
const RADIUS: f32 = 1.2;

impl Patches {
    /// Waves of length 1 along `across`, a unit vector, and how they change along it.
    fn waves(&self, place: Vec2, across: Vec2) -> (f32, f32) {
        let (cell, inside) = cell_and_inside(place);
        let (mut wave, mut change, mut weights) = (0.0, 0.0, 0.0);
        for y in -1..=1 {
            let row = (cell.y + y - self.first) as usize * self.side;
            for x in -1..=1 {
                let stray = self.offsets[row + (cell.x + x - self.first) as usize];
                let offset = inside - (IVec2::new(x, y).as_vec2() + 0.5 + stray);
                let near = 1.0 - offset.length_squared() / (RADIUS * RADIUS);
                if near > 0.0 {
                    let weight = near * near * near;
                    let (sine, cosine) = sine_cosine(offset.dot(across));
                    wave += weight * cosine;
                    change -= weight * sine;
                    weights += weight;
                }
            }
        }
        (wave / weights, change * std::f32::consts::TAU / weights)
    }
}

/// Sine and cosine of `turns` full turns, to 0.001: parabolas, equal on every machine.
fn sine_cosine(turns: f32) -> (f32, f32) {
    let sine = |turns: f32| {
        // To the nearest whole number, halves away from zero; without a call, as in `cell_and_inside`.
        let whole = (turns + 0.499_999_97_f32.copysign(turns)) as i32 as f32;
        let x = turns - whole;
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
        let gullies = Gullies::new(Noise::new(3, 0), 5_001.0);
        let height_m = |step: i32| gullies.eroded_m(Vec2::new(step as f32 * 0.25, 17.0), Vec2::new(-0.3, 0.5));
        let most_m: f32 = (0..OCTAVES).map(|octave| DEEPEST_M * 0.45_f32.powi(octave)).sum();
        for step in -20_000..20_000 {
            assert!(height_m(step).abs() <= most_m);
            // A slope of two, over a quarter of a metre.
            assert!((height_m(step + 1) - height_m(step)).abs() < 0.5, "{step}");
        }
        assert_eq!(gullies.eroded_m(Vec2::new(1.0, 2.0), Vec2::ZERO), 0.0);
    }
}
