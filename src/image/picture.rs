use std::ops::Range;

use crate::content;

use super::{Error, srgb};

/// Drawn where a value is not finite, so that it cannot pass for a dark or a bright pixel.
pub(super) const NOT_FINITE: [u8; 3] = [255, 0, 255];

/// A finished picture: 8 bits a channel, colour sRGB-encoded, alpha linear and not premultiplied, top row first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rgba8 {
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

impl Rgba8 {
    /// A picture of `width * height` pixels, four bytes each in the order R, G, B, A.
    ///
    /// # Errors
    /// [`Error::Length`] when `pixels` is not `4 * width * height` long.
    pub fn new(width: u32, height: u32, pixels: Vec<u8>) -> Result<Self, Error> {
        check_length(width, height, pixels.len())?;
        Ok(Self { width, height, pixels })
    }

    /// The picture of linear light: R, G, B and A of each pixel, clamped to 0..=1, the colour sRGB-encoded. A pixel
    /// with a value that is not finite becomes opaque magenta.
    ///
    /// # Errors
    /// [`Error::Length`] when `linear` is not `4 * width * height` long.
    pub fn from_linear(width: u32, height: u32, linear: &[f32]) -> Result<Self, Error> {
        check_length(width, height, linear.len())?;
        let pixels = linear.chunks_exact(4).flat_map(|pixel| {
            if pixel.iter().all(|value| value.is_finite()) {
                let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(srgb::encode8);
                [r, g, b, srgb::unit8(f64::from(pixel[3]))]
            } else {
                let [r, g, b] = NOT_FINITE;
                [r, g, b, 255]
            }
        });
        Ok(Self { width, height, pixels: pixels.collect() })
    }

    pub fn width(&self) -> u32 {
        self.width
    }

    pub fn height(&self) -> u32 {
        self.height
    }

    /// R, G, B, A of each pixel, row by row from the top.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// As [`pixels`](Self::pixels).
    pub fn into_pixels(self) -> Vec<[u8; 4]> {
        // As long as four bytes a pixel, and allocated for as many.
        bytemuck::allocation::try_cast_vec(self.pixels).unwrap_or_else(|(_, pixels)| pixels.as_chunks().0.to_vec())
    }

    /// The rows of a range within the height.
    ///
    /// # Errors
    /// [`Error::Length`] for rows that it does not have.
    pub fn rows(&self, rows: Range<u32>) -> Result<Self, Error> {
        let bytes = 4 * self.width as usize;
        let taken = self.pixels.get(rows.start as usize * bytes..rows.end as usize * bytes).unwrap_or_default();
        Self::new(self.width, rows.end.saturating_sub(rows.start), taken.to_vec())
    }

    /// SHA-256 of [`pixels`](Self::pixels) in lower-case hexadecimal: the picture's identity whatever the file's
    /// compression.
    pub fn sha256(&self) -> String {
        content::sha256(&self.pixels)
    }
}

fn check_length(width: u32, height: u32, found: usize) -> Result<(), Error> {
    // At most 2^66: fits u128 whatever the arguments.
    let expected = 4 * u128::from(width) * u128::from(height);
    if expected == found as u128 {
        return Ok(());
    }
    Err(Error::Length {
        what: format!("a picture of {width} x {height} pixels"),
        expected: expected.to_string(),
        found,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_length_must_fit_the_size() {
        assert!(Rgba8::new(2, 3, vec![0; 24]).is_ok());
        assert!(Rgba8::new(2, 3, vec![0; 23]).is_err());
        assert!(Rgba8::new(u32::MAX, u32::MAX, vec![0; 4]).is_err());
        assert!(Rgba8::from_linear(2, 1, &[0.0; 7]).is_err());
    }

    #[test]
    fn linear_light_is_encoded_and_alpha_is_not() {
        let linear = [0.0, 0.214_041_14, 1.0, 0.5, -1.0, 2.0, 0.002, 7.0];
        let picture = Rgba8::from_linear(2, 1, &linear).unwrap();
        assert_eq!(picture.pixels(), [0, 128, 255, 128, 0, 255, 7, 255]);
    }

    #[test]
    fn values_that_are_not_finite_are_magenta() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for channel in 0..4 {
                let mut linear = [0.25f32; 4];
                linear[channel] = bad;
                let picture = Rgba8::from_linear(1, 1, &linear).unwrap();
                assert_eq!(picture.pixels(), [255, 0, 255, 255]);
            }
        }
    }

    #[test]
    fn the_hash_is_sha256_of_the_bytes() {
        // FIPS 180-2 has "abc"; a picture needs a multiple of four bytes: this is sha256sum of "abcd".
        let picture = Rgba8::new(1, 1, b"abcd".to_vec()).unwrap();
        assert_eq!(picture.sha256(), "88d4266fd4e6338d13b845fcf289579d209c897823b9217da3e161936f031589");
    }
}
