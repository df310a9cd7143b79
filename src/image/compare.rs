//! Visible difference of two pictures: the metric of the caustics thesis (section 2.7, equation 2-9), the Euclidean
//! distance in CIE 1976 L\*u\*v\* pixel by pixel, averaged over the object's pixels.
//!
//! Colours are taken as sRGB with its white D65; alpha takes no part. Black and white are 100 apart, neighbouring greys
//! 0.27 to 0.51, red and blue 250.4, and no two colours more than 274.6 (green and magenta). The thesis gives the range
//! as 0 to 580 with red and blue as its ends, without the white or the scale behind that number: compare figures here
//! with each other, not with the thesis's.

use palette::white_point::D65;
use palette::{FromColor, Luv, Srgb};

use super::{Error, Rgba8};

/// The L\*u\*v\* distances over the pixels compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Equation 2-9: the average distance.
    pub mean: f64,
    /// The 99th percentile by nearest rank: the smallest distance that at least 99 % of the pixels do not exceed.
    pub p99: f64,
    /// The largest distance.
    pub max: f64,
    /// Number of pixels compared.
    pub pixels: usize,
}

/// Compares two pictures over the pixels where `mask` (row by row from the top) is true, or over all.
///
/// Identical pictures give exactly 0.
///
/// # Errors
/// [`Error::SizeMismatch`]; [`Error::MaskLength`]; [`Error::NoPixels`] when nothing is left to compare.
pub fn compare(left: &Rgba8, right: &Rgba8, mask: Option<&[bool]>) -> Result<Difference, Error> {
    let mut distances = distances(left, right)?;
    if let Some(mask) = mask {
        if mask.len() != distances.len() {
            return Err(Error::MaskLength { expected: distances.len(), found: mask.len() });
        }
        let mut inside = mask.iter();
        distances.retain(|_| inside.next() == Some(&true));
    }
    Difference::of(&distances).ok_or(Error::NoPixels)
}

/// The L\*u\*v\* distance of every pixel, row by row from the top.
///
/// # Errors
/// [`Error::SizeMismatch`].
pub fn distances(left: &Rgba8, right: &Rgba8) -> Result<Vec<f64>, Error> {
    let sizes = [left, right].map(|picture| (picture.width(), picture.height()));
    if sizes[0] != sizes[1] {
        return Err(Error::SizeMismatch { left: sizes[0], right: sizes[1] });
    }
    let pixels = left.pixels().chunks_exact(4);
    let pairs = pixels.zip(right.pixels().chunks_exact(4));
    Ok(pairs.map(|(left, right)| distance([left[0], left[1], left[2]], [right[0], right[1], right[2]])).collect())
}

/// A picture of `distances` (of `width * height` pixels): black where they are 0, through red and yellow to white at
/// the largest.
///
/// # Errors
/// [`Error::Length`] when the number of distances does not fit the size.
pub fn heat_map(width: u32, height: u32, distances: &[f64]) -> Result<Rgba8, Error> {
    let max = distances.iter().copied().fold(0.0, f64::max);
    let scale = if max > 0.0 { 3.0 / max } else { 0.0 };
    let pixels = distances.iter().flat_map(|distance| {
        let heat = distance * scale;
        let level = |start: f64| ((heat - start).clamp(0.0, 1.0) * 255.0).round() as u8;
        [level(0.0), level(1.0), level(2.0), 255]
    });
    Rgba8::new(width, height, pixels.collect())
}

impl Difference {
    /// `None` without a distance.
    pub(super) fn of(distances: &[f64]) -> Option<Self> {
        let pixels = distances.len();
        let rank = (pixels - pixels / 100).checked_sub(1)?;
        let mean = distances.iter().sum::<f64>() / pixels as f64;
        let max = distances.iter().copied().fold(0.0, f64::max);
        let mut sorted = distances.to_vec();
        let (_, &mut p99, _) = sorted.select_nth_unstable_by(rank, f64::total_cmp);
        Some(Self { mean, p99, max, pixels })
    }
}

fn distance(left: [u8; 3], right: [u8; 3]) -> f64 {
    if left == right {
        return 0.0;
    }
    let (left, right) = (luv(left), luv(right));
    let (l, u, v) = (left.l - right.l, left.u - right.u, left.v - right.v);
    (l * l + u * u + v * v).sqrt()
}

fn luv([r, g, b]: [u8; 3]) -> Luv<D65, f64> {
    Luv::from_color(Srgb::new(r, g, b).into_linear::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(color: [u8; 3], width: u32, height: u32) -> Rgba8 {
        let [r, g, b] = color;
        let pixels = [r, g, b, 255].repeat((width * height) as usize);
        Rgba8::new(width, height, pixels).unwrap()
    }

    fn mean(left: [u8; 3], right: [u8; 3]) -> f64 {
        let (left, right) = (flat(left, 2, 2), flat(right, 2, 2));
        compare(&left, &right, None).unwrap().mean
    }

    #[test]
    fn primaries_are_as_far_apart_as_published_coordinates_say() {
        // L*, u*, v* of the sRGB primaries and secondaries under D65, as colour tables list them.
        let table = [
            ([255, 0, 0], [53.2408, 175.0150, 37.7564]),
            ([0, 255, 0], [87.7347, -83.0776, 107.3985]),
            ([0, 0, 255], [32.2970, -9.4054, -130.3423]),
            ([255, 0, 255], [60.3242, 84.0714, -108.6834]),
            ([255, 255, 255], [100.0, 0.0, 0.0]),
            ([0, 0, 0], [0.0, 0.0, 0.0]),
        ];
        for (left, [l1, u1, v1]) in table {
            for (right, [l2, u2, v2]) in table {
                let (l, u, v): (f64, f64, f64) = (l1 - l2, u1 - u2, v1 - v2);
                let expected = (l * l + u * u + v * v).sqrt();
                let found = mean(left, right);
                assert!((found - expected).abs() < 0.01, "{left:?} {right:?}: {found}");
            }
        }
        assert!((mean([255, 0, 0], [0, 0, 255]) - 250.4131).abs() < 1e-3);
    }

    #[test]
    fn greys_differ_by_lightness_alone() {
        let lightness = |grey: u8| {
            let encoded = f64::from(grey) / 255.0;
            let y = if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
            if y > 216.0 / 24389.0 { 116.0 * y.cbrt() - 16.0 } else { y * 24389.0 / 27.0 }
        };
        for grey in 0..255u8 {
            let expected = lightness(grey + 1) - lightness(grey);
            assert!((mean([grey; 3], [grey + 1; 3]) - expected).abs() < 1e-4);
            assert!((0.27..0.51).contains(&expected), "{expected}");
        }
    }

    #[test]
    fn identical_pictures_are_exactly_zero_apart() {
        let pixels = (0..40 * 30 * 4).map(|i| (i * 31 % 256) as u8).collect();
        let picture = Rgba8::new(40, 30, pixels).unwrap();
        let expected = Difference { mean: 0.0, p99: 0.0, max: 0.0, pixels: 1200 };
        assert_eq!(compare(&picture, &picture, None).unwrap(), expected);
    }

    #[test]
    fn the_mask_chooses_the_objects_pixels() {
        let black = flat([0; 3], 2, 1);
        let half = Rgba8::new(2, 1, vec![0, 0, 0, 255, 255, 255, 255, 255]).unwrap();
        let found = |mask: Option<&[bool]>| compare(&black, &half, mask);
        assert!((found(None).unwrap().mean - 50.0).abs() < 1e-3);
        assert!((found(Some(&[false, true])).unwrap().mean - 100.0).abs() < 1e-3);
        assert_eq!(found(Some(&[true, false])).unwrap().max, 0.0);
        assert_eq!(found(Some(&[true, false])).unwrap().pixels, 1);
        assert!(matches!(found(Some(&[false; 2])), Err(Error::NoPixels)));
        assert!(matches!(found(Some(&[true; 3])), Err(Error::MaskLength { .. })));
    }

    #[test]
    fn sizes_must_agree_even_when_the_number_of_pixels_does() {
        let error = compare(&flat([0; 3], 2, 3), &flat([0; 3], 3, 2), None).unwrap_err();
        assert!(matches!(error, Error::SizeMismatch { .. }), "{error}");
        let none = flat([0; 3], 0, 3);
        assert!(matches!(compare(&none, &none, None), Err(Error::NoPixels)));
    }

    #[test]
    fn the_percentile_is_the_nearest_rank() {
        let of = |count: u32| {
            let distances: Vec<f64> = (1..=count).rev().map(f64::from).collect();
            Difference::of(&distances).unwrap().p99
        };
        assert_eq!([1, 99, 100, 101, 200, 1000].map(of), [1.0, 99.0, 99.0, 100.0, 198.0, 990.0]);
    }

    #[test]
    fn the_heat_map_runs_from_black_to_white() {
        let map = heat_map(4, 1, &[0.0, 3.0, 6.0, 9.0]).unwrap();
        let expected = [[0, 0, 0, 255], [255, 0, 0, 255], [255, 255, 0, 255], [255, 255, 255, 255]];
        assert_eq!(map.pixels(), expected.concat());
        assert_eq!(heat_map(1, 1, &[0.0]).unwrap().pixels(), [0, 0, 0, 255]);
        assert!(heat_map(2, 1, &[0.0]).is_err());
    }
}
