//! Values of a target as colours: a channel through a ramp, or three channels as light.

use egui::{Color32, ColorImage};

use super::protocol::{TargetValues, ValueKind};
use crate::named;

/// Mapping of values to colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawing {
    /// The channel that is drawn, or three as a colour.
    pub channel: Channel,
    /// Values at the two ends.
    pub range: (f64, f64),
    /// Powers of two that values are multiplied by.
    pub exposure: f32,
    /// Colours of a single channel.
    pub ramp: Ramp,
    /// Of depths: the distance along the view, between these planes.
    pub linear_between: Option<[f64; 2]>,
}

/// Channels of a texel that are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// The first three as red, green and blue.
    Colour,
    /// One alone.
    One(usize),
}

named! {
    /// Colours of a single channel.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Ramp {
        Grey = "grey",
        /// Dark blue over green to yellow, of even steps to the eye.
        Viridis = "viridis",
        /// Blue below the middle, red above.
        Diverging = "diverging",
        /// A colour of its own for each integer.
        Labels = "labels",
    }
}

impl Ramp {
    /// The colour at `fraction` of the range.
    fn colour(self, fraction: f64) -> Color32 {
        const VIRIDIS: [[u8; 3]; 9] = [
            [68, 1, 84],
            [71, 44, 122],
            [59, 81, 139],
            [44, 113, 142],
            [33, 144, 141],
            [39, 173, 129],
            [92, 200, 99],
            [170, 220, 50],
            [253, 231, 37],
        ];
        const DIVERGING: [[u8; 3]; 5] =
            [[33, 102, 172], [146, 197, 222], [247, 247, 247], [244, 165, 130], [178, 24, 43]];
        const GREY: [[u8; 3]; 2] = [[0; 3], [255; 3]];
        let stops: &[[u8; 3]] = match self {
            Ramp::Grey | Ramp::Labels => &GREY,
            Ramp::Viridis => &VIRIDIS,
            Ramp::Diverging => &DIVERGING,
        };
        let at = fraction.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let (low, part) = ((at as usize).min(stops.len() - 2), at - (at as usize).min(stops.len() - 2) as f64);
        let mix = |i: usize| (f64::from(stops[low][i]) * (1.0 - part) + f64::from(stops[low + 1][i]) * part).round();
        Color32::from_rgb(mix(0) as u8, mix(1) as u8, mix(2) as u8)
    }
}

/// Colour of what is no number, and of values that stand for none.
pub const NONE: Color32 = Color32::from_rgb(255, 0, 255);

/// The values' numbers at a texel, one a channel.
pub fn texel(values: &TargetValues, x: u32, y: u32) -> Option<Vec<f64>> {
    if x >= values.width || y >= values.height {
        return None;
    }
    let first = (y as usize * values.width as usize + x as usize) * values.channels as usize;
    (first..first + values.channels as usize).map(|index| number(values, index)).collect()
}

/// The number at an index of the block.
pub fn number(values: &TargetValues, index: usize) -> Option<f64> {
    let bytes = &values.block.bytes;
    let word = || bytes.get(index * 4..index * 4 + 4).and_then(|word| word.first_chunk::<4>().copied());
    match values.kind {
        ValueKind::U8 => bytes.get(index).map(|byte| f64::from(*byte)),
        ValueKind::F32 => word().map(|word| f64::from(f32::from_le_bytes(word))),
        ValueKind::U32 => word().map(|word| f64::from(u32::from_le_bytes(word))),
        ValueKind::I32 => word().map(|word| f64::from(i32::from_le_bytes(word))),
    }
}

/// The picture of the values; `None` for a block that is not theirs.
pub fn draw(values: &TargetValues, drawing: &Drawing, is_srgb: bool) -> Option<ColorImage> {
    let (width, height, channels) = (values.width as usize, values.height as usize, values.channels as usize);
    let texels = width.checked_mul(height)?;
    number(values, (texels * channels).checked_sub(1)?)?;
    let gain = f64::from(drawing.exposure).exp2();
    let sentinels = |channel: usize| values.statistics.get(channel).map_or(&[][..], |s| &s.sentinels);
    let (low, high) = drawing.range;
    let scale = if high > low { 1.0 / (high - low) } else { 0.0 };
    let fraction = |value: f64| ((value - low) * scale * gain).clamp(0.0, 1.0);
    let pixels = match drawing.channel {
        Channel::Colour => (0..texels)
            .map(|at| {
                let of = |channel: usize| number(values, at * channels + channel).unwrap_or(0.0);
                let rgb = [of(0), of(1), of(2)];
                if rgb.iter().any(|value| !value.is_finite()) {
                    return NONE;
                }
                if is_srgb {
                    return Color32::from_rgb(rgb[0] as u8, rgb[1] as u8, rgb[2] as u8);
                }
                let [red, green, blue] = rgb.map(|value| encoded(fraction(value)));
                Color32::from_rgb(red, green, blue)
            })
            .collect(),
        Channel::One(channel) => {
            let channel = channel.min(channels - 1);
            let table: Vec<Color32> = (0..=255).map(|step| drawing.ramp.colour(f64::from(step) / 255.0)).collect();
            let none = sentinels(channel);
            (0..texels)
                .map(|at| {
                    let value = number(values, at * channels + channel).unwrap_or(f64::NAN);
                    if !value.is_finite() || none.contains(&value) {
                        return NONE;
                    }
                    let value = drawing.linear_between.map_or(value, |planes| linear_depth(value, planes));
                    if drawing.ramp == Ramp::Labels {
                        return label(value);
                    }
                    table[(fraction(value) * 255.0).round() as usize]
                })
                .collect()
        }
    };
    Some(ColorImage::new([width, height], pixels))
}

/// Distance along the view of a perspective's depth, 0 at the near plane to 1 at the far one.
pub fn linear_depth(depth: f64, [near, far]: [f64; 2]) -> f64 {
    near * far / (far - depth.clamp(0.0, 1.0) * (far - near))
}

/// Light, 0 to 1, as sRGB encodes it.
fn encoded(light: f64) -> u8 {
    let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (value * 255.0).round() as u8
}

/// A colour that differs from those of the numbers near by.
fn label(value: f64) -> Color32 {
    let hash = (value as i64 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let hue = (hash >> 40) as f32 / (1 << 24) as f32;
    egui::ecolor::Hsva::new(hue, 0.65, 0.9, 1.0).into()
}

#[cfg(test)]
mod tests {
    use super::super::protocol::{Block, Statistics, TargetChoice};
    use super::*;

    fn floats(width: u32, channels: u32, numbers: &[f32]) -> TargetValues {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        TargetValues {
            choice: TargetChoice { side: 0, name: "t".into(), layer: 0, first_row: 0 },
            kind: ValueKind::F32,
            width,
            height: numbers.len() as u32 / width / channels,
            channels,
            block: Block { offset: 0, len: bytes.len() as u64, bytes },
            statistics: vec![Statistics { sentinels: vec![-1.0], ..Statistics::default() }],
            is_written: true,
        }
    }

    fn grey(range: (f64, f64)) -> Drawing {
        let channel = Channel::One(0);
        Drawing { channel, range, exposure: 0.0, ramp: Ramp::Grey, linear_between: None }
    }

    #[test]
    fn depths_become_distances_between_the_planes_of_their_camera() {
        let camera = crate::scene::Camera {
            eye: glam::Vec3::ZERO,
            target: glam::Vec3::NEG_Z,
            up: glam::Vec3::Y,
            vertical_fov_rad: 0.7,
            near_m: 0.1,
            far_m: 100.0,
        };
        for distance in [0.1, 0.5, 7.0, 20.0] {
            let clip = camera.projection(1.0) * glam::Vec4::new(0.0, 0.0, -distance, 1.0);
            let found = linear_depth(f64::from(clip.z / clip.w), [0.1, 100.0]);
            assert!((found / f64::from(distance) - 1.0).abs() < 2e-3, "{found} for {distance}");
        }
        let drawing = Drawing { linear_between: Some([1.0, 9.0]), ..grey((1.0, 9.0)) };
        let image = draw(&floats(3, 1, &[0.0, 0.75, 1.0]), &drawing, false).expect("a picture");
        // 9 / (9 - 0.75 * 8) = 3 lies a quarter of the way.
        assert_eq!([0, 1, 2].map(|at| image.pixels[at].r()), [0, 64, 255]);
    }

    #[test]
    fn a_ramp_runs_from_end_to_end_and_shows_what_is_none() {
        let values = floats(5, 1, &[0.0, 2.0, 4.0, f32::NAN, -1.0]);
        let image = draw(&values, &grey((0.0, 4.0)), false).expect("a picture");
        let level = |at: usize| image.pixels[at].r();
        assert_eq!((level(0), level(1), level(2)), (0, 128, 255));
        assert_eq!((image.pixels[3], image.pixels[4]), (NONE, NONE));
    }

    #[test]
    fn exposure_doubles() {
        let drawing = Drawing { exposure: 1.0, ..grey((0.0, 1.0)) };
        let image = draw(&floats(1, 1, &[0.25]), &drawing, false).expect("a picture");
        assert_eq!(image.pixels[0].r(), 128);
    }

    #[test]
    fn colours_are_light_encoded_in_srgb() {
        let drawing = Drawing { channel: Channel::Colour, ..grey((0.0, 1.0)) };
        let image = draw(&floats(1, 3, &[1.0, 0.212_230_76, 0.0]), &drawing, false).expect("a picture");
        assert_eq!(image.pixels[0], Color32::from_rgb(255, 127, 0));
    }

    #[test]
    fn a_block_of_another_length_is_no_picture() {
        let mut values = floats(2, 1, &[0.0, 1.0]);
        values.block.bytes.pop();
        assert!(draw(&values, &grey((0.0, 1.0)), false).is_none());
        assert_eq!(texel(&values, 2, 0), None);
    }
}
