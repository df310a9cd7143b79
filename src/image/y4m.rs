//! Films as YUV4MPEG2 (`.y4m`), which video encoders read: uncompressed, a header line and then every frame.
//!
//! Each pixel has all three values (`C444`), 8 bits of ITU-R BT.601 in the limited range, which a reader takes for what
//! no tag says otherwise: from sRGB-encoded R, G, B of 0 to 255, luma `L = 0.299 R + 0.587 G + 0.114 B`,
//! `Y = 16 + 219 L / 255`, `Cb = 128 + 224 (B - L) / (1.772 * 255)`, `Cr = 128 + 224 (R - L) / (1.402 * 255)`, in whole
//! numbers, each rounded to the nearest. Alpha is left out.

use std::io::{self, Write};

use super::Rgba8;

/// Frames a second of a film that names no rate.
pub const RATE: u32 = 30;

/// Writes the frames of one film.
pub struct Film<W> {
    file: W,
    size: (u32, u32),
    planes: [Vec<u8>; 3],
}

impl<W: Write> Film<W> {
    /// Begins a film of frames of one size, `rate` of them a second.
    ///
    /// # Errors
    /// Of the writer.
    pub fn new(mut file: W, (width, height): (u32, u32), rate: u32) -> io::Result<Self> {
        writeln!(file, "YUV4MPEG2 W{width} H{height} F{rate}:1 Ip A1:1 C444 XCOLORRANGE=LIMITED")?;
        Ok(Film { file, size: (width, height), planes: Default::default() })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// Of the writer; of a frame of another size.
    pub fn push(&mut self, frame: &Rgba8) -> io::Result<()> {
        if (frame.width(), frame.height()) != self.size {
            return Err(io::Error::other("a film's frames have one size"));
        }
        self.planes.iter_mut().for_each(Vec::clear);
        for pixel in frame.pixels().chunks_exact(4) {
            let values = converted([pixel[0], pixel[1], pixel[2]]);
            self.planes.iter_mut().zip(values).for_each(|(plane, value)| plane.push(value));
        }
        self.file.write_all(b"FRAME\n")?;
        self.planes.iter().try_for_each(|plane| self.file.write_all(plane))
    }
}

/// Y, Cb and Cr of a colour.
fn converted(rgb: [u8; 3]) -> [u8; 3] {
    let [r, g, b] = rgb.map(i64::from);
    // Thousand times the luma.
    let luma = 299 * r + 587 * g + 114 * b;
    let of = |offset: i64, scaled: i64, whole: i64| {
        // The nearest, halves away from zero; the range holds every colour.
        (offset + (2 * scaled + scaled.signum() * whole) / (2 * whole)) as u8
    };
    [
        of(16, 219 * luma, 255 * 1000),
        of(128, 224 * (1000 * b - luma), 255 * 1772),
        of(128, 224 * (1000 * r - luma), 255 * 1402),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_the_recommendation() {
        // 100 % colour bars in BT.601, as tables of them print them.
        for (rgb, expected) in [
            ([0, 0, 0], [16, 128, 128]),
            ([255, 255, 255], [235, 128, 128]),
            ([255, 255, 0], [210, 16, 146]),
            ([0, 255, 255], [170, 166, 16]),
            ([0, 255, 0], [145, 54, 34]),
            ([255, 0, 255], [106, 202, 222]),
            ([255, 0, 0], [81, 90, 240]),
            ([0, 0, 255], [41, 240, 110]),
        ] {
            assert_eq!(converted(rgb), expected, "{rgb:?}");
        }
    }

    #[test]
    fn every_colour_comes_back_to_what_rounding_leaves() {
        for r in (0..=255u8).step_by(5) {
            for g in (0..=255u8).step_by(5) {
                for b in (0..=255u8).step_by(5) {
                    let exact = [r, g, b].map(f64::from);
                    let luma = 0.299 * exact[0] + 0.587 * exact[1] + 0.114 * exact[2];
                    let expected = [
                        16.0 + 219.0 * luma / 255.0,
                        128.0 + 224.0 * (exact[2] - luma) / (1.772 * 255.0),
                        128.0 + 224.0 * (exact[0] - luma) / (1.402 * 255.0),
                    ];
                    for (found, expected) in converted([r, g, b]).into_iter().zip(expected) {
                        assert!((f64::from(found) - expected).abs() < 0.5 + 1e-9, "{r} {g} {b}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_film_is_a_header_and_planes() {
        let mut bytes = Vec::new();
        let mut film = Film::new(&mut bytes, (2, 1), 25).unwrap();
        film.push(&Rgba8::new(2, 1, vec![255, 0, 0, 255, 0, 0, 255, 255]).unwrap()).unwrap();
        film.push(&Rgba8::new(2, 1, vec![0; 8]).unwrap()).unwrap();
        assert!(film.push(&Rgba8::new(1, 2, vec![0; 8]).unwrap()).is_err());
        let header = b"YUV4MPEG2 W2 H1 F25:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n".to_vec();
        let frames = [
            b"FRAME\n".to_vec(),
            vec![81, 41, 90, 240, 240, 110],
            b"FRAME\n".to_vec(),
            vec![16, 16, 128, 128, 128, 128],
        ];
        assert_eq!(bytes, [header, frames.concat()].concat());
    }
}
