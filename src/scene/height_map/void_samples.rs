//! The samples that a source leaves void, and the heights that stand there.

use super::Samples;
use std::sync::Arc;

/// Heights for the samples that a source left void.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Voids {
    /// From their neighbours.
    Fill,
    /// One height, metres in the map's own frame.
    Level(f32),
    /// Below the base: there is no terrain.
    Hole,
}

/// Heights that look like voids which the source does not declare: many times the same number that programs write for none,
/// far below all others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Suspect {
    /// The number.
    pub height_m: f64,
    /// Samples that have it.
    pub samples: u64,
    /// The lowest of the others.
    pub next_m: f64,
}

/// Numbers that programs write where there is no height.
const NO_HEIGHTS: [f64; 4] = [-32_768.0, -32_767.0, -9_999.0, -99_999.0];
/// So far below all others, metres, no height lies.
const FAR_BELOW_M: f64 = 1_000.0;
/// A hole's depth below the base, as a fraction of the map's relief.
const HOLE_DEPTH: f32 = 1e-3;

/// Looks for a [`Suspect`] among the heights of a source.
pub(super) struct Watch {
    counts: [u64; NO_HEIGHTS.len()],
    lowest: f64,
    no_data: Option<f64>,
}

impl Watch {
    pub(super) fn new(no_data: Option<f64>) -> Self {
        Watch { counts: [0; NO_HEIGHTS.len()], lowest: f64::INFINITY, no_data }
    }

    pub(super) fn see(&mut self, height_m: f64) {
        if height_m > -9_000.0 {
            self.lowest = self.lowest.min(height_m);
            return;
        }
        match NO_HEIGHTS.iter().position(|number| *number == height_m) {
            Some(index) => self.counts[index] += 1,
            None => self.lowest = self.lowest.min(height_m),
        }
    }

    pub(super) fn suspect(&self) -> Option<Suspect> {
        let seen = NO_HEIGHTS.iter().zip(self.counts).filter(|(_, samples)| *samples > 0);
        let (&height_m, samples) = seen.max_by_key(|(_, samples)| *samples)?;
        let is_far = self.lowest.is_finite() && self.lowest - height_m >= FAR_BELOW_M;
        (is_far && self.no_data != Some(height_m)).then_some(Suspect { height_m, samples, next_m: self.lowest })
    }
}

/// A map's void samples, and how they were treated.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct VoidSamples {
    count: u64,
    /// A bit for each sample of the map, row by row.
    mask: Arc<[u64]>,
    treatment: Voids,
}

impl VoidSamples {
    pub(super) fn new(samples: usize, places: &[u32]) -> Self {
        let mut mask = vec![0; samples.div_ceil(64)];
        for &place in places {
            mask[place as usize / 64] |= 1 << (place % 64);
        }
        VoidSamples { count: places.len() as u64, mask: mask.into(), treatment: Voids::Fill }
    }

    /// So many in places that are not known.
    pub(super) fn anywhere(count: u64, treatment: Voids) -> Self {
        VoidSamples { count, mask: Arc::new([]), treatment }
    }

    pub(super) fn treatment(&self) -> Voids {
        self.treatment
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    pub(super) fn treated(self, treatment: Voids) -> Self {
        VoidSamples { treatment, ..self }
    }

    /// The number and the treatment alone, for a map whose samples lie elsewhere.
    pub(super) fn counted(&self) -> Self {
        VoidSamples { mask: Arc::new([]), ..self.clone() }
    }

    pub(super) fn note(&self) -> String {
        match self.treatment {
            Voids::Fill => "they are filled from their neighbours; `voids` hole leaves them out".to_owned(),
            Voids::Level(level_m) => format!("they lie at {level_m} m"),
            Voids::Hole => "there is no terrain".to_owned(),
        }
    }

    pub(super) fn places(&self) -> impl Iterator<Item = usize> + '_ {
        let bits = |(word, bits): (usize, u64)| {
            (0..64).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| 64 * word + bit)
        };
        self.mask.iter().copied().enumerate().flat_map(bits)
    }

    /// The samples with one height for all voids. Steps stay steps where one of them is that height.
    pub(super) fn at(&self, samples: Samples, level_m: f32) -> Samples {
        let step = match &samples {
            Samples::Steps { origin_m, step_m, .. } => f64::from(level_m - origin_m) / f64::from(*step_m),
            Samples::Float(_) => f64::NAN,
        };
        let is_step = (step - step.round()).abs() < 1e-4;
        self.set(samples, is_step.then_some(step.round()), level_m)
    }

    /// The samples with all voids a little below `base_m`; the map's relief says how much a little is.
    pub(super) fn below(&self, samples: Samples, base_m: f32, relief_m: f32) -> Samples {
        let step = match &samples {
            Samples::Steps { origin_m, step_m, .. } => {
                (f64::from(base_m - origin_m) / f64::from(*step_m)).floor() - 1.0
            }
            Samples::Float(_) => f64::NAN,
        };
        let lower_m = (HOLE_DEPTH * relief_m).max(1e-5 * base_m.abs()).max(1e-3);
        self.set(samples, Some(step).filter(|step| step.is_finite()), base_m - lower_m)
    }

    /// `step` counts from the samples' own origin; `height_m` is for samples that cannot hold it.
    fn set(&self, samples: Samples, step: Option<f64>, height_m: f32) -> Samples {
        let (mut values, origin_m, step_m) = match samples {
            Samples::Float(mut heights) => {
                self.places().for_each(|place| heights[place] = height_m);
                return Samples::Float(heights);
            }
            Samples::Steps { values, origin_m, step_m } => (values, origin_m, step_m),
        };
        // A height below the origin lowers it for all.
        let lowered = step.map_or(0.0, |step| (-step).max(0.0));
        let highest = f64::from(values.iter().copied().max().unwrap_or(0));
        match step {
            Some(step) if step <= f64::from(u16::MAX) && highest + lowered <= f64::from(u16::MAX) => {
                values.iter_mut().for_each(|value| *value += lowered as u16);
                self.places().for_each(|place| values[place] = (step + lowered) as u16);
                Samples::Steps { values, origin_m: (f64::from(origin_m) - lowered * f64::from(step_m)) as f32, step_m }
            }
            _ => {
                let mut heights: Vec<f32> = values.iter().map(|&value| origin_m + step_m * f32::from(value)).collect();
                self.places().for_each(|place| heights[place] = height_m);
                Samples::Float(heights)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::HeightMap;

    fn map(samples: Samples) -> HeightMap {
        HeightMap::new(3, 2, samples).unwrap().with_void_samples(&[1, 5])
    }

    fn heights(map: &HeightMap) -> Vec<f32> {
        (0..6).map(|index| map.height_m(index % 3, index / 3)).collect()
    }

    #[test]
    fn voids_lie_where_they_are_asked_to() {
        let steps = || map(Samples::Steps { values: vec![0, 7, 20, 30, 40, 7], origin_m: 100.0, step_m: 0.5 });
        let float = || map(Samples::Float(vec![100.0, 103.5, 110.0, 115.0, 120.0, 103.5]));
        for of in [&steps as &dyn Fn() -> HeightMap, &float] {
            assert_eq!((of().voids(), of().void_fraction()), (2, 2.0 / 6.0));
            assert_eq!(of().with_voids(Voids::Fill, 0.0).unwrap(), of());
            for level_m in [102.0, 80.25, 99.5, 200_000.0] {
                let level = of().with_voids(Voids::Level(level_m), 0.0).unwrap();
                assert_eq!(heights(&level), [100.0, level_m, 110.0, 115.0, 120.0, level_m], "{level_m}");
                assert_eq!(level.range_m(), (level_m.min(100.0), level_m.max(120.0)), "{level_m}");
            }
            for base_m in [100.0, 112.3, -30.0, -50_000.0] {
                let hole = of().with_voids(Voids::Hole, base_m).unwrap();
                let found = heights(&hole);
                assert_eq!([found[0], found[2], found[3], found[4]], [100.0, 110.0, 115.0, 120.0], "{base_m}");
                assert!(found[1] < base_m && found[1] > base_m - 2.0 && found[5] == found[1], "{base_m}: {found:?}");
                assert_eq!(hole.range_m(), (100.0, 120.0), "a hole is no height");
                assert_eq!(hole.lowest_node_m(), found[1].min(100.0), "{base_m}");
            }
        }
        assert!(matches!(steps().with_voids(Voids::Level(80.0), 0.0).unwrap().samples(), Samples::Steps { .. }));
        assert!(matches!(steps().with_voids(Voids::Hole, 50.0).unwrap().samples(), Samples::Steps { .. }));
        assert!(steps().with_voids(Voids::Level(f32::NAN), 0.0).is_err());
    }

    #[test]
    fn a_note_says_how_many_and_what_became_of_them() {
        let of = |voids| map(Samples::Float(vec![1.0; 6])).with_voids(voids, 0.0).unwrap().void_note().unwrap();
        assert!(of(Voids::Fill).starts_with("2 samples, 33.3 %, are void: they are filled from their neighbours"));
        assert_eq!(of(Voids::Level(-2.5)), "2 samples, 33.3 %, are void: they lie at -2.5 m");
        assert_eq!(of(Voids::Hole), "2 samples, 33.3 %, are void: there is no terrain");
        assert_eq!(HeightMap::new(2, 2, Samples::Float(vec![0.0; 4])).unwrap().void_note(), None);
    }

    #[test]
    fn numbers_that_stand_for_no_height_are_suspected() {
        let suspect = |heights: &[f64], no_data| {
            let mut watch = Watch::new(no_data);
            heights.iter().for_each(|height| watch.see(*height));
            watch.suspect()
        };
        let found = |height_m, samples, next_m| Some(Suspect { height_m, samples, next_m });
        assert_eq!(suspect(&[-9_999.0, 12.0, -9_999.0, -3.0], None), found(-9_999.0, 2, -3.0));
        assert_eq!(suspect(&[-32_768.0, 12.0], Some(-1.0)), found(-32_768.0, 1, 12.0));
        assert_eq!(suspect(&[-9_999.0, 12.0], Some(-9_999.0)), None);
        // The sea is as deep.
        assert_eq!(suspect(&[-9_999.0, -9_800.0, 12.0], None), None);
        assert_eq!(suspect(&[-9_999.0, -10_400.0, 12.0], None), None);
        assert_eq!(suspect(&[-9_999.0, -9_999.0], None), None);
        assert_eq!(suspect(&[5.0, 12.0], None), None);
    }
}
