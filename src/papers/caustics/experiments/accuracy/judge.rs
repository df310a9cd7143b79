//! Distance of a method's maps from the light that truly lands.

use super::super::super::reference::correlation;
use super::truth::{Truth, shrunk};

/// Heights of texels without a receiver are below this.
const NOWHERE: f32 = -1e29;

/// One receiver's map under one light, by a method.
pub struct Found {
    /// I_c of each texel, row by row.
    pub light: Vec<f32>,
    /// The position map.
    pub heights: Vec<f32>,
}

/// A method against the truth, over the texels that the receivers fill in all of its maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// With the truth at the map's own size.
    pub correlation: f64,
    /// Root of the mean square of the differences at the map's own size, of the truth's mean.
    pub rms: f64,
    /// The map's brightest texel, of the truth's.
    pub greatest: f64,
    /// All light, of the truth's.
    pub flux: f64,
    /// The root at the truth's size, where maps of all sizes can be compared: smaller ones are interpolated as in section 4.6.
    pub rms_at_truth: f64,
    /// Correlation of the truth's two halves at the map's own size.
    pub halves: f64,
}

/// `truths` are those of the maps in `found`, of a whole multiple of their size; None where no texel is filled or lit.
pub fn judge(found: &[Found], truths: &[Truth]) -> Option<Verdict> {
    let (mut own, mut enlarged) = (Pairs::default(), Pairs::default());
    let (mut one, mut other) = (Vec::new(), Vec::new());
    for (map, truth) in found.iter().zip(truths) {
        let size = map.heights.len().isqrt();
        let times = truth.halves[0].len().isqrt() / size;
        let halves = truth.halves.each_ref().map(|half| shrunk(half, times));
        for texel in filled(&map.heights) {
            one.push(halves[0][texel]);
            other.push(halves[1][texel]);
            own.add(f64::from(map.light[texel]), (halves[0][texel] + halves[1][texel]) / 2.0);
        }
        let held = filled(&map.heights);
        for texel in held.into_iter().flat_map(|texel| finer(texel, size, times)) {
            let true_light = (truth.halves[0][texel] + truth.halves[1][texel]) / 2.0;
            enlarged.add(interpolated(map, size, times, texel), true_light);
        }
    }
    let verdict = Verdict {
        correlation: correlation(&own.found, &own.truth),
        rms: own.rms()?,
        greatest: greatest(&own.found) / greatest(&own.truth),
        flux: own.found.iter().sum::<f64>() / own.truth.iter().sum::<f64>(),
        rms_at_truth: enlarged.rms()?,
        halves: correlation(&one, &other),
    };
    verdict.rms.is_finite().then_some(verdict)
}

/// Values of a map's texels, and the true ones.
#[derive(Default)]
struct Pairs {
    found: Vec<f64>,
    truth: Vec<f64>,
}

impl Pairs {
    fn add(&mut self, found: f64, truth: f64) {
        self.found.push(found);
        self.truth.push(truth);
    }

    fn rms(&self) -> Option<f64> {
        let count = self.truth.len() as f64;
        let square: f64 = self.found.iter().zip(&self.truth).map(|(a, b)| (a - b).powi(2)).sum();
        let mean = self.truth.iter().sum::<f64>() / count;
        (mean > 0.0).then(|| (square / count).sqrt() / mean)
    }
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// The texels that the receiver fills with all around them: one at an edge has light of a part of it alone.
pub fn filled(heights: &[f32]) -> Vec<usize> {
    let size = heights.len().isqrt();
    let is_held = |x: usize, y: usize| x < size && y < size && heights[y * size + x] > NOWHERE;
    let is_filled = |texel: &usize| {
        let (x, y) = (texel % size, texel / size);
        (0..9).all(|i| is_held((x + i % 3).wrapping_sub(1), (y + i / 3).wrapping_sub(1)))
    };
    (0..heights.len()).filter(is_filled).collect()
}

/// The texels of the truth's map in one of a map that is `times` smaller.
fn finer(texel: usize, size: usize, times: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (texel % size * times, texel / size * times);
    (0..times * times).map(move |i| (y + i / times) * size * times + x + i % times)
}

/// The map's light at the middle of a texel of the truth's: between the four nearest of its texels that hold the receiver.
fn interpolated(map: &Found, size: usize, times: usize, texel: usize) -> f64 {
    let place = |fine: usize| (fine as f64 + 0.5) / times as f64 - 0.5;
    let (x, y) = (place(texel % (size * times)), place(texel / (size * times)));
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, j) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let (column, row) = (x.floor() + i, y.floor() + j);
        let weight = (1.0 - (x - column).abs()) * (1.0 - (y - row).abs());
        if column < 0.0 || row < 0.0 || column >= size as f64 || row >= size as f64 {
            continue;
        }
        let at = row as usize * size + column as usize;
        if map.heights[at] > NOWHERE {
            sum += weight * f64::from(map.light[at]);
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slope of light on 8 x 8 texels.
    fn truth() -> Truth {
        let half: Vec<f64> = (0..64).map(|texel| 1.0 + f64::from(texel % 8)).collect();
        Truth { halves: [half.clone(), half] }
    }

    fn found(light: impl Fn(usize) -> f32, size: usize) -> Found {
        Found { light: (0..size * size).map(light).collect(), heights: vec![0.0; size * size] }
    }

    #[test]
    fn the_truth_itself_has_no_error() {
        let exact = judge(&[found(|texel| 1.0 + (texel % 8) as f32, 8)], &[truth()]).unwrap();
        assert!((exact.correlation - 1.0).abs() < 1e-12 && exact.rms < 1e-12 && exact.rms_at_truth < 1e-12);
        assert_eq!((exact.greatest, exact.flux), (1.0, 1.0));
        assert!((exact.halves - 1.0).abs() < 1e-12);
    }

    /// A quarter of the texels: its own truth has no error, and interpolation shows the slope.
    #[test]
    fn smaller_maps_are_compared_at_their_own_size_and_at_the_truths() {
        let small = judge(&[found(|texel| 1.5 + 2.0 * (texel % 4) as f32, 4)], &[truth()]).unwrap();
        assert!(small.rms < 1e-12 && small.rms_at_truth < 1e-12, "{small:?}");
        let flat = judge(&[found(|_| 4.5, 4)], &[truth()]).unwrap();
        // The filled texels are those in the middle: 1 below and above the mean, and at the truth's size 1.5 and 0.5.
        assert!((flat.rms - 1.0 / 4.5).abs() < 1e-12, "{flat:?}");
        assert!((flat.rms_at_truth - 1.25f64.sqrt() / 4.5).abs() < 1e-12, "{flat:?}");
    }

    #[test]
    fn what_no_receiver_fills_is_not_judged() {
        let mut holes = found(|_| 9.0, 8);
        holes.heights.fill(-1e30);
        assert_eq!(judge(&[holes], &[truth()]), None);
    }
}
