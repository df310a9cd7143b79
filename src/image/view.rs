//! 8-bit RGB drawings of data that is no 8-bit picture.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

use super::picture::NOT_FINITE;
use super::srgb;

/// Two channels as red and green, with a blue of 0.
pub(super) fn with_blue<T: Copy + Default>(values: &[T]) -> Vec<T> {
    let pixels = values.chunks_exact(2);
    pixels.flat_map(|pixel| [pixel[0], pixel[1], T::default()]).collect()
}

/// Two or three channels as they are, the first three of four, and how many there are.
pub(super) fn without_fourth(values: &[f32], channels: usize) -> (Cow<'_, [f32]>, usize) {
    match channels {
        4 => (values.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect(), 3),
        _ => (values.into(), channels),
    }
}

/// Linear light of two to four channels, clamped to 0..=1 and sRGB-encoded; a fourth channel is left out.
pub(super) fn linear_light(values: &[f32], channels: usize) -> Vec<u8> {
    draw(values, channels, srgb::encode8)
}

/// A linear ramp over values: the range that it spans, and what it leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// Value of 0, below which all are 0.
    pub low: f64,
    /// Value of 255, above which all are 255.
    pub high: f64,
    /// Values left out as sentinels, which stand far off all others.
    pub masked: usize,
    /// Bounds of those that are not left out.
    kept: [f64; 2],
}

/// Fraction of the values beyond either end of a ramp.
const TAIL: f64 = 0.001;
/// A greatest or smallest value that repeats and lies off the others by more than this many times their range stands
/// for none.
const SENTINEL: f64 = 10.0;

impl Ramp {
    /// The ramp of values without sentinels, from their 0.1st to their 99.9th percentile.
    pub fn of<T: Copy + Into<f64>>(values: &[T]) -> Self {
        let mut ascending: Vec<f64> = values.iter().map(|&value| value.into()).filter(|v| v.is_finite()).collect();
        ascending.sort_unstable_by(f64::total_cmp);
        let kept = &ascending[kept(&ascending)];
        let (Some(&first), Some(&last)) = (kept.first(), kept.last()) else {
            return Ramp { low: 0.0, high: 0.0, masked: 0, kept: [0.0, 0.0] };
        };
        let tail = (kept.len() as f64 * TAIL) as usize;
        Ramp {
            low: kept[tail],
            high: kept[kept.len() - 1 - tail],
            masked: ascending.len() - kept.len(),
            kept: [first, last],
        }
    }

    fn level(&self, value: f64) -> u8 {
        let scale = if self.high > self.low { 1.0 / (self.high - self.low) } else { 0.0 };
        srgb::unit8((value - self.low) * scale)
    }

    fn masks(&self, value: f64) -> bool {
        value < self.kept[0] || value > self.kept[1]
    }
}

impl fmt::Display for Ramp {
    /// As the file's comment and the console say it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} to {} drawn from black to white", self.low, self.high)?;
        match self.masked {
            0 => Ok(()),
            masked => write!(formatter, ", {masked} values far off the others in magenta"),
        }
    }
}

/// The values in ascending order, without the sentinels at either end.
pub(super) fn kept(ascending: &[f64]) -> Range<usize> {
    let mut range = 0..ascending.len();
    if let (Some(&least), Some(&most)) = (ascending.first(), ascending.last()) {
        let above = ascending.partition_point(|&value| value < most);
        if is_sentinel(&ascending[..above], most, ascending.len() - above) {
            range.end = above;
        }
        let below = ascending[..range.end].partition_point(|&value| value <= least);
        if is_sentinel(&ascending[below..range.end], least, below) {
            range.start = below;
        }
    }
    range
}

/// True for a value, found `count` times, that lies far off `others` in ascending order.
fn is_sentinel(others: &[f64], value: f64, count: usize) -> bool {
    let (Some(least), Some(most)) = (others.first(), others.last()) else { return false };
    let distance = (value - most).max(least - value);
    count > 1 && most > least && distance > SENTINEL * (most - least)
}

/// One to four channels by one ramp; a pixel with a sentinel in magenta, as one that is not finite. A fourth channel
/// counts for the ramp and is left out.
pub(super) fn ramped<T: Copy + Into<f64>>(values: &[T], channels: usize, ramp: Ramp) -> Vec<u8> {
    let shown: Vec<f64> = values
        .iter()
        .map(|&value| value.into())
        .map(|value: f64| if ramp.masks(value) { f64::NAN } else { value })
        .collect();
    draw(&shown, channels, |value| ramp.level(value))
}

/// One channel as grey, two as red and green, the first three of more as they are; a pixel with a value that is not
/// finite in magenta.
fn draw<T: Copy + Into<f64>>(values: &[T], channels: usize, level: impl Fn(T) -> u8) -> Vec<u8> {
    let pixels = values.chunks_exact(channels);
    pixels
        .flat_map(|pixel| {
            if pixel.iter().any(|&value| !value.into().is_finite()) {
                return NOT_FINITE;
            }
            match *pixel {
                [grey] => [level(grey); 3],
                [r, g] => [level(r), level(g), 0],
                _ => [level(pixel[0]), level(pixel[1]), level(pixel[2])],
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp<T: Copy + Into<f64>>(values: &[T], channels: usize) -> Vec<u8> {
        ramped(values, channels, Ramp::of(values))
    }

    #[test]
    fn the_ramp_spans_the_finite_values_of_all_channels() {
        assert_eq!(ramp(&[10.0f32, 20.0, 15.0, 11.0], 2), [0, 255, 0, 128, 26, 0]);
        let holes = [f32::INFINITY, 2.0, f32::NAN, 4.0];
        let magenta = [255, 0, 255];
        let expected = [magenta, [0; 3], magenta, [255; 3]].concat();
        assert_eq!(ramp(&holes, 1), expected);
        assert_eq!(ramp(&[7u32, 7], 1), [0; 6]);
        assert_eq!(ramp(&[f32::NAN], 1), magenta);
        assert_eq!(ramp(&[f32::MIN, f32::MAX, 0.0], 3), [0, 255, 128]);
    }

    #[test]
    fn sentinels_and_outliers_do_not_stretch_the_ramp() {
        let mut values: Vec<f32> = (0..=1000).map(|i| 2.0 + i as f32 * 0.001).collect();
        values.extend([-1e30; 5]);
        let found = Ramp::of(&values);
        assert_eq!((found.low, found.high, found.masked), (2.001_f32.into(), 2.999_f32.into(), 5));
        assert_eq!(ramp(&values, 1)[3 * 1001..3 * 1002], NOT_FINITE);
        // Two values alone are no sentinel and the rest, nor is one far value that stands alone.
        assert_eq!(Ramp::of(&[0u32, 0, 1, 1]).masked, 0);
        assert_eq!(Ramp::of(&[0.0f32, 0.1, 0.2, 9.0]).masked, 0);
        assert_eq!(Ramp::of(&[0u32, 1, 2, u32::MAX, u32::MAX]).masked, 2);
    }

    #[test]
    fn the_fourth_channel_is_left_out_but_must_be_finite() {
        assert_eq!(linear_light(&[1.0, 0.0, -3.0, 0.0], 4), [255, 0, 0]);
        assert_eq!(linear_light(&[1.0, 0.0, 0.0, f32::NAN], 4), NOT_FINITE);
        assert_eq!(linear_light(&[1.0, 2.0], 2), [255, 255, 0]);
    }
}
