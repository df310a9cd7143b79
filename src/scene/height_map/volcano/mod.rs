//! A synthetic stratovolcano: one continuous surface, sampled at any size.

mod erosion;
mod noise;
mod relief;

use super::map::check_size;
use super::{HeightMap, Samples};
use crate::scene::Error;
use crate::scene::loading::Conditions;
use erosion::Gullies;
use glam::{DVec2, Vec2};
use noise::Noise;
use rayon::prelude::*;
use relief::{Bare, Relief};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Length of a side of the terrain.
const EXTENT_M: f32 = 12_000.0;
/// Knots of the surface along a side: the shortest wave is two of their spacings, 1/512 of the side.
const KNOTS: usize = 1_024;
/// Control values along a side: a cubic spline reaches one knot beyond each end.
const CONTROLS: usize = KNOTS + 3;

/// A stratovolcano whose north flank collapsed into a horseshoe, as Bandai's did in 1888, on a plain of 12 km x 12 km:
/// `side` x `side` samples in 16-bit steps.
///
/// All sizes sample one smooth surface of the seed, from edge to edge, in the same steps of about 2 cm.
///
/// # Errors
/// A side outside [`HeightMap::SIDE`]; [`Error::Interrupted`].
pub fn volcano(side: u32, seed: u64) -> Result<HeightMap, Error> {
    volcano_unless(Conditions::current().watch.interrupted, side, seed)
}

fn volcano_unless(interrupted: &AtomicBool, side: u32, seed: u64) -> Result<HeightMap, Error> {
    check_size(side.into(), side.into()).map_err(|reason| Error::HeightMap { reason })?;
    let spacing_m = f64::from(EXTENT_M) / f64::from(side - 1);
    let samples = Terrain::of(interrupted, seed, side as usize)?.steps(interrupted, side as usize)?;
    HeightMap::new(side, side, samples)?.with_spacing_m(DVec2::splat(spacing_m))
}

/// Fails once nobody waits for the volcano any more; asked at every row.
fn look(interrupted: &AtomicBool) -> Result<(), Error> {
    if interrupted.load(Ordering::Relaxed) { Err(Error::Interrupted { path: "volcano".into() }) } else { Ok(()) }
}

/// The rows of [`volcano()`] of a side and a seed, made when they are asked for.
pub(super) struct VolcanoRows {
    terrain: Arc<Terrain>,
    side: u32,
}

impl VolcanoRows {
    /// # Errors
    /// [`Error::Interrupted`].
    pub(super) fn new(side: u32, seed: u64) -> Result<Self, Error> {
        let interrupted = Conditions::current().watch.interrupted;
        Ok(VolcanoRows { terrain: Terrain::of(interrupted, seed, side as usize)?, side })
    }

    /// All but the samples.
    pub(super) fn map(&self) -> Result<HeightMap, Error> {
        let (origin_m, step_m) = self.terrain.scale();
        let spacing_m = f64::from(EXTENT_M) / f64::from(self.side - 1);
        let kind = Samples::Steps { values: Vec::new(), origin_m, step_m };
        HeightMap::promised(self.side, self.side, kind)?.with_spacing_m(DVec2::splat(spacing_m))
    }

    /// Whole rows from one on.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub(super) fn fill(&self, first_row: u32, values: &mut [u16]) -> Result<(), Error> {
        let interrupted = Conditions::current().watch.interrupted;
        self.terrain.rows(interrupted, self.side as usize, first_row as usize, values)
    }
}

/// The terrain: a uniform cubic B-spline surface, so smooth that its slope has no kink.
struct Terrain {
    /// CONTROLS x CONTROLS heights in metres, from the north-west; 0 where no sample depends on one.
    controls_m: Vec<f32>,
    /// Bounds of the surface: a B-spline stays within its control values.
    range_m: (f32, f32),
}

/// The seed that is made most, and the range of its terrain in metres: the steps of a few samples need no other of it.
const USUAL: (u64, (f32, f32)) = (1, (500.061_83, 1_716.071_8));

/// Sides of more samples than this depend on most control values.
const FEW: usize = CONTROLS / 8;

/// The terrain made last, its seed, and the side of the few samples that it was made for: whoever compares sizes
/// samples one terrain many times.
static LATEST: Mutex<Option<Latest>> = Mutex::new(None);

/// Seed, samples a side where only theirs are there, and what was made of them.
type Latest = (u64, Option<usize>, Arc<Terrain>);

impl Terrain {
    /// The terrain of a seed, for samples of that side, from [`LATEST`] if it is there.
    fn of(interrupted: &AtomicBool, seed: u64, side: usize) -> Result<Arc<Self>, Error> {
        let latest = || LATEST.lock().unwrap_or_else(PoisonError::into_inner);
        let few = Some(side).filter(|side| seed == USUAL.0 && *side <= FEW);
        let fits = |(of, made_for, _): &&Latest| *of == seed && (made_for.is_none() || *made_for == few);
        if let Some((.., terrain)) = latest().as_ref().filter(fits) {
            return Ok(Arc::clone(terrain));
        }
        // Not under the lock: a thread that waits for rayon may be given a job that comes here too.
        let terrain = Arc::new(Self::new(interrupted, seed, few)?);
        *latest() = Some((seed, few, Arc::clone(&terrain)));
        Ok(terrain)
    }

    /// All of it, or of the usual seed what the samples of a side depend on.
    fn new(interrupted: &AtomicBool, seed: u64, few: Option<usize>) -> Result<Self, Error> {
        let relief = Relief::new(seed);
        let gullies = Gullies::new(Noise::new(seed, 0), 0.51 * EXTENT_M);
        // One control more on each side, for the slopes.
        let side = CONTROLS + 2;
        let place = |column: usize, row: usize| {
            let knots = Vec2::new(column as f32 - 2.0, 2.0 - row as f32);
            knots * (EXTENT_M / KNOTS as f32) + Vec2::new(-0.5, 0.5) * EXTENT_M
        };
        let mut is_needed = vec![few.is_none(); CONTROLS];
        for sample in 0..few.unwrap_or(0) {
            let (first, weights) = taps(sample, few.unwrap_or(2));
            is_needed[first..first + weights.len()].fill(true);
        }
        let has_needed = |at: usize| (at.saturating_sub(2)..=at.min(CONTROLS - 1)).any(|at| is_needed[at]);
        let is_asked: Vec<bool> = (0..side).map(has_needed).collect();
        let mut bare = vec![Bare::default(); side * side];
        bare.par_chunks_mut(side).enumerate().filter(|(row, _)| is_asked[*row]).try_for_each_init(
            || relief.clone(),
            |relief, (row, line)| {
                for (column, bare) in line.iter_mut().enumerate().filter(|(column, _)| is_asked[*column]) {
                    *bare = relief.at(place(column, row));
                }
                look(interrupted)
            },
        )?;
        let knot_m = EXTENT_M / KNOTS as f32;
        let control_m = |column: usize, row: usize| {
            let here = bare[row * side + column];
            let height_m = |column: usize, row: usize| bare[row * side + column].height_m;
            let (west_m, east_m) = (height_m(column - 1, row), height_m(column + 1, row));
            let (north_m, south_m) = (height_m(column, row - 1), height_m(column, row + 1));
            let slope = Vec2::new(east_m - west_m, north_m - south_m) / (2.0 * knot_m);
            here.height_m + here.erodibility * gullies.eroded_m(place(column, row), slope)
        };
        let mut controls_m = vec![0.0; CONTROLS * CONTROLS];
        let rows = controls_m.par_chunks_mut(CONTROLS).enumerate();
        rows.filter(|(row, _)| is_needed[*row]).try_for_each(|(row, line)| {
            for (column, height_m) in line.iter_mut().enumerate().filter(|(column, _)| is_needed[*column]) {
                *height_m = control_m(column + 1, row + 1);
            }
            look(interrupted)
        })?;
        let range_m = match few {
            Some(_) => USUAL.1,
            None => controls_m.iter().fold((f32::MAX, f32::MIN), |(low, high), &h| (low.min(h), high.max(h))),
        };
        Ok(Self { controls_m, range_m })
    }

    /// The surface at `side` x `side` places, at least two a side.
    fn steps(&self, interrupted: &AtomicBool, side: usize) -> Result<Samples, Error> {
        let mut values = vec![0; side * side];
        self.rows(interrupted, side, 0, &mut values)?;
        let (origin_m, step_m) = self.scale();
        Ok(Samples::Steps { values, origin_m, step_m })
    }

    /// Height of step 0 and between steps, metres.
    fn scale(&self) -> (f32, f32) {
        let (low_m, high_m) = self.range_m;
        (low_m, (high_m - low_m) / f32::from(u16::MAX))
    }

    /// Some rows of [`Self::steps`], from `first_row` on.
    fn rows(&self, interrupted: &AtomicBool, side: usize, first_row: usize, values: &mut [u16]) -> Result<(), Error> {
        let (low_m, step_m) = self.scale();
        values.par_chunks_mut(side).enumerate().try_for_each_init(
            || vec![0.0_f32; CONTROLS],
            |line, (row, values)| {
                let (first, weights) = taps(first_row + row, side);
                for (column, height) in line.iter_mut().enumerate() {
                    *height = (0..4).map(|tap| weights[tap] * self.controls_m[(first + tap) * CONTROLS + column]).sum();
                }
                for (column, value) in values.iter_mut().enumerate() {
                    let (first, weights) = taps(column, side);
                    let height_m: f32 = (0..4).map(|tap| weights[tap] * line[first + tap]).sum();
                    *value = ((height_m - low_m) / step_m).round() as u16;
                }
                look(interrupted)
            },
        )
    }
}

/// The first of the four control values that a sample of a side of `side` samples depends on, and their weights.
fn taps(sample: usize, side: usize) -> (usize, [f32; 4]) {
    // Exact: both factors are below 2^24.
    let place = sample as f64 * KNOTS as f64 / (side - 1) as f64;
    let first = (place as usize).min(KNOTS - 1);
    let t = (place - first as f64) as f32;
    let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
    let weights = [s * s * s, 3.0 * t3 - 6.0 * t2 + 4.0, -3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0, t3];
    (first, weights.map(|weight| weight / 6.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    static NEVER: AtomicBool = AtomicBool::new(false);

    fn terrain(seed: u64, few: Option<usize>) -> Terrain {
        Terrain::new(&NEVER, seed, few).unwrap()
    }

    #[test]
    fn one_that_nobody_waits_for_is_not_made() {
        let interrupted = AtomicBool::new(true);
        let is_given_up = |error| matches!(error, Err(Error::Interrupted { .. }));
        // Of a seed that is not there yet, so that the terrain is given up; then its samples.
        assert!(is_given_up(volcano_unless(&interrupted, 2_000, 77).map(drop)));
        let whole = terrain(77, None);
        let mut values = vec![1; 2_000 * 2_000];
        assert!(is_given_up(whole.rows(&interrupted, 2_000, 0, &mut values)));
        assert!(values.iter().filter(|value| **value == 1).count() > values.len() / 2);
        // What was given up is not taken for made.
        assert_eq!(*Terrain::of(&NEVER, 77, CONTROLS).unwrap().controls_m, whole.controls_m);
    }

    #[test]
    fn every_size_samples_the_same_terrain() {
        let [coarse, fine] = [65, 513].map(|side| volcano(side, 1).unwrap());
        for (column, row) in (0..65).flat_map(|row| (0..65).map(move |column| (column, row))) {
            assert_eq!(coarse.height_m(column, row), fine.height_m(column * 8, row * 8), "{column}, {row}");
        }
        for map in [coarse, fine] {
            assert_eq!(map.spacing_m() * f64::from(map.width() - 1), DVec2::splat(12_000.0));
        }
    }

    #[test]
    fn seeds_make_different_terrains_and_one_seed_the_same() {
        let made_again = terrain(1, None);
        let of = |seed: u64| Terrain::of(&NEVER, seed, CONTROLS).unwrap();
        assert_eq!(made_again.controls_m, of(1).controls_m);
        assert_ne!(made_again.controls_m, of(2).controls_m);
        // Whatever was made last.
        assert_eq!(made_again.controls_m, of(1).controls_m);
        assert_eq!(made_again.range_m, USUAL.1);
    }

    #[test]
    fn few_samples_are_those_of_all_the_terrain() {
        let whole = terrain(USUAL.0, None);
        for side in [2, 3, 9, 65, FEW] {
            let few = terrain(USUAL.0, Some(side));
            let computed = few.controls_m.iter().filter(|&&height_m| height_m != 0.0).count();
            assert!(computed <= 16 * side * side && computed < CONTROLS * CONTROLS, "{side}: {computed}");
            let rows = |terrain: &Terrain| {
                let mut values = vec![0; side * side];
                terrain.rows(&NEVER, side, 0, &mut values).unwrap();
                values
            };
            assert_eq!((rows(&few), few.scale()), (rows(&whole), whole.scale()), "{side}");
        }
    }

    #[test]
    fn a_horseshoe_open_to_the_north_crowns_a_concave_cone_on_a_plain() {
        for seed in [1, 2] {
            let map = volcano(601, seed).unwrap();
            // Metres east and north of the summit; 20 m a sample.
            let height_m =
                |east_m: i32, north_m: i32| map.height_m((300 + east_m / 20) as u32, (300 - north_m / 20) as u32);
            // Mean height of an arc around the summit, degrees east of north.
            let ring_m = |radius_m: f64, from_deg: i32, to_deg: i32| {
                let heights = (from_deg..to_deg).map(|angle_deg| {
                    let (east, north) = f64::from(angle_deg).to_radians().sin_cos();
                    height_m((radius_m * east) as i32, (radius_m * north) as i32)
                });
                let heights: Vec<f32> = heights.collect();
                heights.iter().sum::<f32>() / heights.len() as f32
            };
            let (low_m, high_m) = map.range_m();
            assert!((400.0..600.0).contains(&low_m) && (1_500.0..1_900.0).contains(&high_m), "{low_m} to {high_m}");
            // The breach: the floor north of the summit lies far below the rim on the other sides.
            let breach_m = height_m(0, 800);
            let rim_m = ring_m(800.0, 100, 260);
            assert!(breach_m + 250.0 < rim_m, "seed {seed}: floor {breach_m}, rim {rim_m}");
            // Concave flanks on the sides that stand: each kilometre falls less than the one before.
            let flank_m = [1_000.0, 2_000.0, 3_000.0, 4_000.0].map(|radius_m| ring_m(radius_m, 100, 260));
            let falls: Vec<f32> = flank_m.windows(2).map(|pair| pair[0] - pair[1]).collect();
            assert!(falls.is_sorted_by(|a, b| a > b) && falls[2] > 0.0, "seed {seed}: {falls:?}");
            // The plain is nearly level.
            let plain_m = ring_m(5_800.0, 100, 260);
            assert!((plain_m - 560.0).abs() < 40.0, "seed {seed}: {plain_m}");
        }
    }

    #[test]
    fn slopes_are_those_of_rock_and_have_no_step() {
        let map = volcano(2_049, 1).unwrap();
        let spacing_m = map.spacing_m().x as f32;
        let mut steepest = 0.0_f32;
        for (column, row) in (0..2_048).flat_map(|row| (0..2_048).map(move |column| (column, row))) {
            let here = map.height_m(column, row);
            let rise_m = (map.height_m(column + 1, row) - here).hypot(map.height_m(column, row + 1) - here);
            steepest = steepest.max(rise_m / spacing_m);
        }
        assert!((1.0..4.0).contains(&steepest), "{steepest}");
    }

    #[test]
    fn sides_out_of_range_are_refused() {
        for side in [0, 1, 65_537, u32::MAX] {
            let message = volcano(side, 1).unwrap_err().to_string();
            assert!(message.contains("2 to 65536 a side"), "{message}");
        }
        assert_eq!(volcano(2, 1).unwrap().samples().len(), 4);
    }

    #[test]
    fn samples_lie_between_control_values_and_weights_add_up() {
        for side in [2, 3, 1_000, 1_025, 16_384] {
            for sample in [0, 1, side / 2, side - 2, side - 1] {
                let (first, weights) = taps(sample, side);
                assert!(first + 4 <= CONTROLS);
                assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6 && weights.iter().all(|w| *w >= 0.0));
            }
        }
    }
}
