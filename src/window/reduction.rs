//! A picture made smaller: each pixel is the mean of what it covers. On a software driver this takes a fraction of what
//! drawing a filtered texture does.

use egui::Color32;

/// The pixels that one pixel of the smaller picture covers, along one axis.
struct Span {
    first: usize,
    /// Shares of the covered pixels, which sum up to one.
    shares: Vec<f32>,
}

/// The spans of `to` pixels over `from`, at least as many.
fn spans(from: usize, to: usize) -> Vec<Span> {
    let covered = from as f64 / to as f64;
    let span = |index: usize| {
        let (start, end) = (index as f64 * covered, (index + 1) as f64 * covered);
        let first = (start as usize).min(from - 1);
        // An end that rounding pushed past a pixel covers nothing of it.
        let last = ((end - 1e-9).ceil() as usize).clamp(first + 1, from);
        let share = |pixel: usize| ((end.min((pixel + 1) as f64) - start.max(pixel as f64)) / covered).max(0.0) as f32;
        Span { first, shares: (first..last).map(share).collect() }
    };
    (0..to).map(span).collect()
}

/// Opaque pixels of a picture of `to`, made of the four bytes a pixel of one of `from`, which is at least as large both
/// ways; nothing for other sizes.
pub fn reduced(bytes: &[u8], from: [usize; 2], to: [usize; 2]) -> Option<Vec<Color32>> {
    let is_smaller = (0..2).all(|axis| to[axis] > 0 && to[axis] <= from[axis]);
    if !is_smaller || bytes.len() != from[0] * from[1] * 4 {
        return None;
    }
    let (columns, rows) = (spans(from[0], to[0]), spans(from[1], to[1]));
    let mut sums = vec![0.0_f32; from[0] * 4];
    let mut pixels = Vec::with_capacity(to[0] * to[1]);
    for row in &rows {
        sums.fill(0.0);
        for (share, line) in row.shares.iter().zip(bytes.chunks_exact(from[0] * 4).skip(row.first)) {
            sums.iter_mut().zip(line).for_each(|(sum, byte)| *sum += share * f32::from(*byte));
        }
        pixels.extend(columns.iter().map(|column| {
            let covered = sums.chunks_exact(4).skip(column.first).zip(&column.shares);
            let mean = covered.fold([0.5_f32; 3], |mean, (sum, share)| {
                [mean[0] + share * sum[0], mean[1] + share * sum[1], mean[2] + share * sum[2]]
            });
            // Saturates at both ends.
            Color32::from_rgb(mean[0] as u8, mean[1] as u8, mean[2] as u8)
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
