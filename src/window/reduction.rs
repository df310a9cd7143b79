//! A picture made smaller: each pixel is the mean of what it covers. On a software driver this takes a fraction of what
//! drawing a filtered texture does.

use egui::Color32;

/// A whole weight.
const WHOLE: u16 = 256;

/// The pixels that each pixel of the smaller picture covers, along one axis.
struct Spans {
    /// Pixels that one looks at, some of them for nothing.
    taps: usize,
    /// The first of them.
    firsts: Vec<usize>,
    /// Shares of them, which sum up to [`WHOLE`], one pixel's after the other's.
    weights: Vec<u16>,
}

impl Spans {
    /// Those of `to` pixels over `from`, which are at least as many.
    fn new(from: usize, to: usize) -> Self {
        let covered = from as f64 / to as f64;
        // One that begins inside a pixel ends inside another.
        let taps = (covered.ceil() as usize + 1).min(from);
        let (mut firsts, mut weights) = (Vec::with_capacity(to), Vec::with_capacity(to * taps));
        for index in 0..to {
            let start = index as f64 * covered;
            let first = (start as usize).min(from - taps);
            // Rounded as sums, so that none gets lost.
            let up_to = |pixel: usize| {
                let weight = ((pixel as f64 - start) / covered).clamp(0.0, 1.0);
                (weight * f64::from(WHOLE)).round() as u16
            };
            firsts.push(first);
            weights.extend((first..first + taps).map(|pixel| up_to(pixel + 1) - up_to(pixel)));
        }
        Spans { taps, firsts, weights }
    }

    /// The first pixel and the weights of each pixel.
    fn each(&self) -> impl Iterator<Item = (usize, &[u16])> {
        self.firsts.iter().copied().zip(self.weights.chunks_exact(self.taps))
    }
}

/// Opaque pixels of a picture of `to`, made of the four bytes a pixel of one of `from`, which is at least as large both
/// ways; nothing for other sizes.
pub fn reduced(bytes: &[u8], from: [usize; 2], to: [usize; 2]) -> Option<Vec<Color32>> {
    let is_smaller = (0..2).all(|axis| to[axis] > 0 && to[axis] <= from[axis]);
    if !is_smaller || bytes.len() != from[0] * from[1] * 4 {
        return None;
    }
    let (columns, rows) = (Spans::new(from[0], to[0]), Spans::new(from[1], to[1]));
    let width = from[0] * 4;
    let mut sums = vec![0_u16; width];
    let mut pixels = Vec::with_capacity(to[0] * to[1]);
    for (first, weights) in rows.each() {
        sums.fill(0);
        let covered = weights.iter().zip(bytes[first * width..].chunks_exact(width));
        for (weight, line) in covered.filter(|(weight, _)| **weight > 0) {
            // A byte times a whole weight is the most that there is.
            sums.iter_mut().zip(line).for_each(|(sum, byte)| *sum += weight * u16::from(*byte));
        }
        pixels.extend(columns.each().map(|(first, weights)| {
            let mut mean = [1_u32 << 15; 3];
            for (weight, sum) in weights.iter().zip(sums[first * 4..].chunks_exact(4)) {
                let weight = u32::from(*weight);
                mean[0] += weight * u32::from(sum[0]);
                mean[1] += weight * u32::from(sum[1]);
                mean[2] += weight * u32::from(sum[2]);
            }
            let [red, green, blue] = mean.map(|mean| (mean >> 16) as u8);
            Color32::from_rgb(red, green, blue)
        }));
    }
    Some(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grey levels as bytes.
    fn grey(levels: &[u8]) -> Vec<u8> {
        levels.iter().flat_map(|&level| [level, level, level, 7]).collect()
    }

    fn levels(pixels: &[Color32]) -> Vec<u8> {
        assert!(pixels.iter().all(|pixel| pixel.a() == 255 && pixel.r() == pixel.g() && pixel.g() == pixel.b()));
        pixels.iter().map(Color32::r).collect()
    }

    #[test]
    fn a_pixel_is_the_mean_of_what_it_covers() {
        let whole = [10, 20, 30, 40, 50, 60, 70, 80];
        let halved = reduced(&grey(&whole), [4, 2], [2, 1]).expect("smaller");
        assert_eq!(levels(&halved), [35, 55]);
        // Each of two covers one and a half of three.
        let of_three = reduced(&grey(&[0, 90, 180]), [3, 1], [2, 1]).expect("smaller");
        assert_eq!(levels(&of_three), [30, 150]);
        let same = reduced(&grey(&whole), [4, 2], [4, 2]).expect("as large");
        assert_eq!(levels(&same), whole);
    }

    #[test]
    fn what_is_even_stays_even_at_any_size() {
        for (from, to) in
            [([641, 407], [377, 239]), ([1000, 3], [999, 2]), ([7, 500], [1, 1]), ([1920, 1080], [1279, 719])]
        {
            let pixels = reduced(&grey(&vec![201; from[0] * from[1]]), from, to).expect("smaller");
            assert_eq!(pixels.len(), to[0] * to[1]);
            assert!(levels(&pixels).iter().all(|&level| level == 201), "{from:?} to {to:?}");
        }
    }

    #[test]
    fn a_mean_is_kept() {
        let mut seed = 3_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 24) as u8
        };
        let whole: Vec<u8> = (0..90 * 70).map(|_| random()).collect();
        let small = levels(&reduced(&grey(&whole), [90, 70], [41, 33]).expect("smaller"));
        let mean = |of: &[u8]| of.iter().map(|&level| f64::from(level)).sum::<f64>() / of.len() as f64;
        assert!((mean(&whole) - mean(&small)).abs() < 0.05, "{} {}", mean(&whole), mean(&small));
    }

    #[test]
    fn other_sizes_are_none() {
        for (from, to) in [([2, 1], [3, 1]), ([2, 1], [0, 1]), ([3, 1], [1, 1])] {
            assert!(reduced(&grey(&[1, 2]), from, to).is_none(), "{from:?} to {to:?}");
        }
    }
}
