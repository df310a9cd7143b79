//! 8-bit RGB drawings of data that is no 8-bit picture.

use super::picture::NOT_FINITE;
use super::srgb;

/// Two channels as red and green, with a blue of 0.
pub(super) fn with_blue<T: Copy + Default>(values: &[T]) -> Vec<T> {
    let pixels = values.chunks_exact(2);
    pixels.flat_map(|pixel| [pixel[0], pixel[1], T::default()]).collect()
}

/// Linear light of two to four channels, clamped to 0..=1 and sRGB-encoded; a fourth channel is left out.
pub(super) fn linear_light(values: &[f32], channels: usize) -> Vec<u8> {
    draw(values, channels, srgb::encode8)
}

/// One to four channels by one linear ramp from the smallest finite value (0) to the largest (255); all 0 when they
/// are equal. A fourth channel counts for the ramp and is left out.
pub(super) fn ramp<T: Copy + Into<f64>>(values: &[T], channels: usize) -> Vec<u8> {
    let finite = values.iter().map(|&value| value.into());
    let finite = finite.filter(|value| value.is_finite());
    let (min, max) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), value| (value.min(min), value.max(max)));
    let scale = if max > min { 1.0 / (max - min) } else { 0.0 };
    draw(values, channels, |value| srgb::unit8((value.into() - min) * scale))
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
    fn the_fourth_channel_is_left_out_but_must_be_finite() {
        assert_eq!(linear_light(&[1.0, 0.0, -3.0, 0.0], 4), [255, 0, 0]);
        assert_eq!(linear_light(&[1.0, 0.0, 0.0, f32::NAN], 4), NOT_FINITE);
        assert_eq!(linear_light(&[1.0, 2.0], 2), [255, 255, 0]);
    }
}
