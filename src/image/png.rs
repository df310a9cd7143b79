use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::Path;

use ::image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError, Limits};

use super::error::one_line;
use super::raster::{Raster, Samples};
use super::replace::replace;
use super::{Error, Rgba8, view};

/// The largest 2-D image that desktop GPUs commonly take.
const MAX_SIDE: u32 = 16_384;
/// 256 MiB of RGBA.
const MAX_PIXELS: u64 = 1 << 26;

/// Colour types by number of channels, where two travel as three.
const COLORS_8: [ExtendedColorType; 4] =
    [ExtendedColorType::L8, ExtendedColorType::Rgb8, ExtendedColorType::Rgb8, ExtendedColorType::Rgba8];
const COLORS_16: [ExtendedColorType; 4] =
    [ExtendedColorType::L16, ExtendedColorType::Rgb16, ExtendedColorType::Rgb16, ExtendedColorType::Rgba16];

/// Reads a PNG of any colour type as 8-bit RGBA: grey and palettes are expanded, 16-bit values rounded to 8 bits, a
/// missing alpha is opaque.
///
/// # Errors
/// [`Error::Open`]; [`Error::Png`] for a file that is no PNG, is cut short or damaged; [`Error::TooLarge`] beyond
/// 16,384 pixels a side or 2^26 in all, whatever the file's own size, before anything is allocated.
pub fn read_png(path: &Path) -> Result<Rgba8, Error> {
    let too_large = || Error::TooLarge { path: path.into(), max_pixels: MAX_PIXELS, max_side: MAX_SIDE };
    let damaged = |reason| match reason {
        ImageError::Limits(_) => too_large(),
        reason => Error::Png { path: path.into(), reason: one_line(reason) },
    };
    let file = File::open(path).map_err(|reason| Error::Open { path: path.into(), reason: one_line(reason) })?;
    let mut limits = Limits::default();
    // 16-bit RGBA, the widest a PNG can be.
    limits.max_alloc = Some(MAX_PIXELS * 8);
    let decoder = PngDecoder::with_limits(BufReader::new(file), limits).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    if width.max(height) > MAX_SIDE || pixels > MAX_PIXELS {
        return Err(too_large());
    }
    let image = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    Rgba8::new(width, height, image.into_rgba8().into_raw())
}

/// Writes a picture, whole or not at all, to `path` whatever its ending.
///
/// # Errors
/// [`Error::Empty`] for a picture without pixels; [`Error::Write`] when the folder cannot be written to.
pub fn write_png(path: &Path, picture: &Rgba8) -> Result<(), Error> {
    if picture.pixels().is_empty() {
        return Err(Error::Empty { path: path.into() });
    }
    let size = (picture.width(), picture.height());
    replace(path, |file| store(file, picture.pixels(), size, ExtendedColorType::Rgba8))
        .map_err(|reason| Error::write(path, &reason))
}

/// Writes a raster that is not empty, as [`Format::Png`](super::Format::Png) says.
pub(super) fn encode(file: &mut impl Write, raster: &Raster) -> io::Result<()> {
    let planes = raster.planes();
    let size = planes
        .layers
        .checked_mul(planes.height)
        .and_then(|height| Some((planes.width.try_into().ok()?, height.try_into().ok()?)))
        .ok_or_else(|| io::Error::other("a PNG cannot be so large, write it as .npy"))?;
    let (bytes, color): (Cow<[u8]>, _) = match (raster.samples(), planes.channels) {
        (Samples::U8(values), 2) => (view::with_blue(values).into(), ExtendedColorType::Rgb8),
        (Samples::U8(values), channels) => (values.into(), COLORS_8[channels - 1]),
        (Samples::U16(values), 2) => {
            (bytemuck::cast_slice(&view::with_blue(values)).to_vec().into(), ExtendedColorType::Rgb16)
        }
        (Samples::U16(values), channels) => (bytemuck::cast_slice(values).into(), COLORS_16[channels - 1]),
        (Samples::F32(values), 1) => (view::ramp(values, 1).into(), ExtendedColorType::Rgb8),
        (Samples::F32(values), channels) => (view::linear_light(values, channels).into(), ExtendedColorType::Rgb8),
        (Samples::U32(values), channels) => (view::ramp(values, channels).into(), ExtendedColorType::Rgb8),
        (Samples::I32(values), channels) => (view::ramp(values, channels).into(), ExtendedColorType::Rgb8),
    };
    store(file, &bytes, size, color)
}

/// `bytes` holds exactly the pixels of `size` in `color`, 16-bit values in the machine's byte order.
fn store(file: &mut impl Write, bytes: &[u8], (width, height): (u32, u32), color: ExtendedColorType) -> io::Result<()> {
    PngEncoder::new_with_quality(file, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, color)
        .map_err(super::encoder_error)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Rgba8 {
        let pixels = (0..7 * 5 * 4).map(|i| (i * 37 % 251) as u8).collect();
        Rgba8::new(7, 5, pixels).unwrap()
    }

    fn written(raster: &Raster) -> DynamicImage {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        super::super::write(&path, raster).unwrap();
        ::image::open(path).unwrap()
    }

    /// Reads `bytes` as a picture file.
    fn read(bytes: &[u8]) -> Result<Rgba8, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        std::fs::write(&path, bytes).unwrap();
        read_png(&path)
    }

    fn encoded(picture: &Rgba8) -> Vec<u8> {
        let mut bytes = Vec::new();
        let size = (picture.width(), picture.height());
        store(&mut bytes, picture.pixels(), size, ExtendedColorType::Rgba8).unwrap();
        bytes
    }

    #[test]
    fn a_picture_comes_back_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        write_png(&path, &sample()).unwrap();
        assert_eq!(read_png(&path).unwrap(), sample());
        let none = Rgba8::new(0, 5, Vec::new()).unwrap();
        assert!(matches!(write_png(&path, &none), Err(Error::Empty { .. })));
        assert_eq!(read_png(&path).unwrap(), sample());
    }

    #[test]
    fn grey_and_rgb_files_are_expanded() {
        let mut bytes = Vec::new();
        store(&mut bytes, &[5, 250], (2, 1), ExtendedColorType::L8).unwrap();
        assert_eq!(read(&bytes).unwrap().pixels(), [5, 5, 5, 255, 250, 250, 250, 255]);
        let mut bytes = Vec::new();
        store(&mut bytes, &[1, 2, 3], (1, 1), ExtendedColorType::Rgb8).unwrap();
        assert_eq!(read(&bytes).unwrap().pixels(), [1, 2, 3, 255]);
    }

    #[test]
    fn small_integers_are_stored_unchanged() {
        let image = written(&Raster::image(1, 2, 1, 1, vec![3u8, 200]).unwrap());
        assert_eq!(image.as_luma8().unwrap().as_raw(), &[3, 200]);
        let image = written(&Raster::image(1, 1, 2, 1, vec![3u8, 200]).unwrap());
        assert_eq!(image.as_rgb8().unwrap().as_raw(), &[3, 200, 0]);
        let image = written(&Raster::image(1, 1, 4, 2, vec![1u8, 2, 3, 0, 5, 6, 7, 8]).unwrap());
        assert_eq!((image.width(), image.height()), (1, 2));
        assert_eq!(image.as_rgba8().unwrap().as_raw(), &[1, 2, 3, 0, 5, 6, 7, 8]);
        let image = written(&Raster::table(1, 2, vec![258u16, 65_535]).unwrap());
        assert_eq!(image.as_luma16().unwrap().as_raw(), &[258, 65_535]);
        let image = written(&Raster::image(1, 1, 2, 1, vec![258u16, 4]).unwrap());
        assert_eq!(image.as_rgb16().unwrap().as_raw(), &[258, 4, 0]);
    }

    #[test]
    fn other_data_becomes_a_view() {
        let colour = [0.0, 0.214_041_14, 1.0, 0.0, f32::NAN, 0.0, 0.0, 1.0];
        let image = written(&Raster::image(2, 1, 4, 1, colour.to_vec()).unwrap());
        assert_eq!(image.as_rgb8().unwrap().as_raw(), &[0, 128, 255, 255, 0, 255]);
        let depth = Raster::image(3, 1, 1, 1, vec![-1.0f32, 0.0, 4.0]).unwrap();
        assert_eq!(written(&depth).as_rgb8().unwrap().as_raw(), &[0, 0, 0, 51, 51, 51, 255, 255, 255]);
        let counts = Raster::table(1, 2, vec![0u32, u32::MAX]).unwrap();
        assert_eq!(written(&counts).as_rgb8().unwrap().as_raw(), &[0, 0, 0, 255, 255, 255]);
    }

    #[test]
    fn truncated_and_damaged_files_are_errors_and_never_panic() {
        let whole = encoded(&sample());
        for length in 0..whole.len() {
            match read(&whole[..length]) {
                Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
                // Only the end chunk may be missing: every pixel is there.
                Ok(picture) => assert!(picture == sample() && length >= whole.len() - 12),
            }
        }
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state >> 24
        };
        for position in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[position] ^= random() as u8 | 1;
            // Damage in the end chunk may pass; what is read then must be the picture.
            assert!(read(&bytes).map_or(true, |picture| picture == sample()));
        }
        for length in [1usize, 8, 60, 1000] {
            let noise: Vec<u8> = (0..length).map(|_| random() as u8).collect();
            assert!(read(&noise).is_err());
            assert!(read(&[&whole[..8], &noise].concat()).is_err());
            assert!(read(&[&whole[..33], &noise].concat()).is_err());
        }
        assert!(matches!(read_png(Path::new("no/such.png")), Err(Error::Open { .. })));
        assert!(read_png(&std::env::temp_dir()).is_err());
    }

    /// A file whose header promises a size and whose data never comes.
    fn promise(width: u32, height: u32) -> Vec<u8> {
        let mut header = b"IHDR".to_vec();
        header.extend(width.to_be_bytes());
        header.extend(height.to_be_bytes());
        header.extend([8, 0, 0, 0, 0]);
        let crc = !header.iter().fold(!0u32, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
        });
        let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
        bytes.extend(header);
        bytes.extend(crc.to_be_bytes());
        bytes.extend(b"\0\0\0\x08IDAT");
        bytes
    }

    #[test]
    fn an_absurd_size_is_refused_before_it_is_allocated() {
        for (width, height) in [(16_385, 1), (1, 16_385), (16_384, 4_097), (1 << 30, 1 << 30)] {
            let error = read(&promise(width, height)).unwrap_err();
            assert!(matches!(error, Error::TooLarge { .. }), "{error}");
        }
        assert!(matches!(read(&promise(4, 4)), Err(Error::Png { .. })));
    }
}
