use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek, Write};
use std::path::{Path, PathBuf};

use ::png::{
    BitDepth, ColorType, Compression, Decoder, DecodingError, Encoder, Filter, Limits, Reader, Transformations,
};

use super::error::one_line;
use super::raster::{Raster, Samples};
use super::view::{Ramp, ramped};
use super::{Error, Rgba8, view};
use crate::content::{self, Hasher};
use crate::file;

/// The largest 2-D image that desktop GPUs commonly take, pixels.
const MAX_SIDE: u32 = 16_384;
/// 256 MiB of RGBA.
const MAX_PIXELS: u64 = 1 << 26;
/// Bytes that a damaged file may take beyond 16 times its own size.
const SPARE_BYTES: u64 = 64 << 20;

/// Colour types by number of channels, where two travel as three.
const COLORS: [ColorType; 4] = [ColorType::Grayscale, ColorType::Rgb, ColorType::Rgb, ColorType::Rgba];

/// Reads a PNG of any colour type as 8-bit RGBA: grey and palettes are expanded, 16-bit values rounded to 8 bits, a
/// missing alpha is opaque.
///
/// # Errors
/// [`Error::Open`]; [`Error::Png`] for a file that is no PNG, is cut short or damaged; [`Error::TooLarge`] beyond
/// 16,384 pixels a side or 2^26 in all, whatever the file's own size, before anything is allocated.
pub fn read_png(path: &Path) -> Result<Rgba8, Error> {
    read_png_within(path, MAX_SIDE)
}

/// As [`read_png`], of at most `max_side` pixels a side.
///
/// # Errors
/// As [`read_png`].
pub fn read_png_within(path: &Path, max_side: u32) -> Result<Rgba8, Error> {
    CheckedPng::open(path, max_side, None)?.into_picture()
}

/// A PNG that was seen to be whole. The pixels of one that has many for its size are not kept before they are wanted: what
/// it is taken with may be refused meanwhile.
pub struct CheckedPng {
    path: PathBuf,
    input: BufReader<File>,
    max_side: u32,
    size: (u32, u32),
    picture: Option<Rgba8>,
}

impl CheckedPng {
    /// As [`read_png`].
    ///
    /// # Errors
    /// As [`read_png`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::open(path, MAX_SIDE, None)
    }

    /// As [`read`](Self::read), with [`Rgba8::sha256`] of the picture; one that is interlaced and has many pixels has none.
    ///
    /// # Errors
    /// As [`read_png`].
    pub fn read_hashed(path: &Path) -> Result<(Self, String), Error> {
        let mut hasher = Hasher::default();
        let found = Self::open(path, MAX_SIDE, Some(&mut hasher))?;
        let sha256 = found.picture.as_ref().map_or_else(|| hasher.sha256(), Rgba8::sha256);
        Ok((found, sha256))
    }

    /// A picture that is not kept is hashed meanwhile, unless it is interlaced.
    fn open(path: &Path, max_side: u32, hasher: Option<&mut Hasher>) -> Result<Self, Error> {
        let opened = file::open(path);
        let (file, size_bytes) =
            opened.map_err(|reason| Error::Open { path: path.into(), reason: one_line(reason) })?;
        let mut input = BufReader::new(file);
        let check = || {
            let (size, is_large) = check(&mut input, size_bytes, max_side, hasher)?;
            Ok((size, if is_large { None } else { Some(pixels(&mut input, max_side)?) }))
        };
        let (size, picture) = check().map_err(|refusal: Refusal| refusal.of(path, max_side))?;
        Ok(CheckedPng { path: path.into(), input, max_side, size, picture })
    }

    /// Pixels a row, and rows.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The picture.
    ///
    /// # Errors
    /// As [`read_png`], of a file that was changed meanwhile.
    pub fn into_picture(self) -> Result<Rgba8, Error> {
        let CheckedPng { path, mut input, max_side, picture, .. } = self;
        match picture {
            Some(picture) => Ok(picture),
            None => pixels(&mut input, max_side).map_err(|refusal| refusal.of(&path, max_side)),
        }
    }
}

/// Why a PNG is not read.
#[derive(Debug)]
pub enum Refusal {
    /// Pixels, by its header.
    TooLarge {
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    Damaged(DecodingError),
}

impl Refusal {
    fn of(self, path: &Path, max_side: u32) -> Error {
        match self {
            Refusal::TooLarge { width, height } => {
                Error::TooLarge { path: path.into(), width, height, max_pixels: MAX_PIXELS, max_side }
            }
            Refusal::Damaged(reason) => Error::Png { path: path.into(), reason: one_line(reason) },
        }
    }
}

impl From<DecodingError> for Refusal {
    fn from(reason: DecodingError) -> Self {
        Refusal::Damaged(reason)
    }
}

/// The size of a PNG of `size_bytes`, and true for one of many pixels for that, which was seen to be whole.
fn check(
    input: &mut (impl BufRead + Seek),
    size_bytes: u64,
    max_side: u32,
    hasher: Option<&mut Hasher>,
) -> Result<((u32, u32), bool), Refusal> {
    let ((width, height), mut reader) = open(input, max_side)?;
    // Some kilobytes can hold 256 MiB of one colour, and a fault at their end: nothing is kept before all is seen to be
    // whole.
    let is_large = u64::from(width) * u64::from(height) * 4 > SPARE_BYTES + 16 * size_bytes;
    if is_large {
        match hasher {
            Some(hasher) if !reader.info().interlaced => each_row(&mut reader, |row| hasher.add(row))?,
            _ => while reader.next_interlaced_row()?.is_some() {},
        }
    }
    Ok(((width, height), is_large))
}

/// The pixels of a PNG.
fn pixels(input: &mut (impl BufRead + Seek), max_side: u32) -> Result<Rgba8, Refusal> {
    let ((width, height), mut reader) = open(input, max_side)?;
    let mut pixels = Vec::with_capacity(4 * width as usize * height as usize);
    if reader.info().interlaced {
        let (color, depth) = reader.output_color_type();
        let mut samples = vec![0; reader.output_buffer_size().unwrap_or(0)];
        reader.next_frame(&mut samples)?;
        push_pixels(&samples, color, depth, &mut pixels);
    } else {
        each_row(&mut reader, |row| pixels.extend(row))?;
    }
    Rgba8::new(width, height, pixels).map_err(|_| Refusal::TooLarge { width, height })
}

/// Takes the rows of a PNG that is not interlaced, from the top, as 8-bit RGBA.
fn each_row(reader: &mut Reader<impl BufRead + Seek>, mut take: impl FnMut(&[u8])) -> Result<(), Refusal> {
    let (color, depth) = reader.output_color_type();
    let mut pixels = Vec::new();
    while let Some(row) = reader.next_row()? {
        pixels.clear();
        push_pixels(row.data(), color, depth, &mut pixels);
        take(&pixels);
    }
    Ok(())
}

/// The size of a PNG and what reads its rows, grey or RGB with an alpha.
fn open<R: BufRead + Seek>(mut input: R, max_side: u32) -> Result<((u32, u32), Reader<R>), Refusal> {
    input.rewind().map_err(DecodingError::from)?;
    // 16-bit RGBA, the widest a PNG can be.
    let mut decoder = Decoder::new_with_limits(input, Limits { bytes: MAX_PIXELS as usize * 8 });
    // Texts and profiles can be compressed too, and are not looked at.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let (width, height) = decoder.read_header_info()?.size();
    if width.max(height) > max_side || u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(Refusal::TooLarge { width, height });
    }
    decoder.set_transformations(Transformations::EXPAND | Transformations::ALPHA);
    Ok(((width, height), decoder.read_info()?))
}

/// Appends samples, grey or RGB with an alpha, as 8-bit RGBA.
fn push_pixels(samples: &[u8], color: ColorType, depth: BitDepth, pixels: &mut Vec<u8>) {
    let nearest = |wide: &[u8; 2]| ((u32::from(u16::from_be_bytes(*wide)) + 128) / 257) as u8;
    let is_grey = color == ColorType::GrayscaleAlpha;
    let grey = |pixel: &[u8; 2]| [pixel[0], pixel[0], pixel[0], pixel[1]];
    match (depth, is_grey) {
        (BitDepth::Sixteen, false) => pixels.extend(samples.as_chunks().0.iter().map(nearest)),
        (BitDepth::Sixteen, true) => {
            pixels.extend(
                samples
                    .as_chunks::<4>()
                    .0
                    .iter()
                    .flat_map(|[a, b, c, d]| grey(&[nearest(&[*a, *b]), nearest(&[*c, *d])])),
            );
        }
        (_, false) => pixels.extend(samples),
        (_, true) => samples.as_chunks().0.iter().for_each(|pixel| pixels.extend_from_slice(&grey(pixel))),
    }
}

/// Writes a picture, whole or not at all, to `path` whatever its ending.
///
/// # Errors
/// [`Error::Empty`] for a picture without pixels; [`Error::Output`] when the file cannot be written.
pub fn write_png(path: &Path, picture: &Rgba8) -> Result<(), Error> {
    write_png_hashed(path, picture).map(drop)
}

/// As [`write_png`], and gives the SHA-256 of the file in lower-case hexadecimal: of what is written here, whatever else is
/// put in its place meanwhile.
///
/// # Errors
/// As [`write_png`].
pub fn write_png_hashed(path: &Path, picture: &Rgba8) -> Result<String, Error> {
    if picture.pixels().is_empty() {
        return Err(Error::Empty { path: path.into() });
    }
    let size = (picture.width(), picture.height());
    let mut bytes = Vec::new();
    store(&mut bytes, picture.pixels(), size, (ColorType::Rgba, BitDepth::Eight), None)
        .map_err(|source| file::OutputError::Write { path: path.into(), source })?;
    file::write(path, &bytes)?;
    Ok(content::sha256(&bytes))
}

/// Writes a raster that is not empty, as [`Format::Png`](super::Format::Png) says, and gives the ramp that it is drawn by.
pub(super) fn encode(file: &mut impl Write, raster: &Raster) -> io::Result<Option<Ramp>> {
    let planes = raster.planes();
    let size = planes
        .layers
        .checked_mul(planes.height)
        .and_then(|height| Some((planes.width.try_into().ok()?, height.try_into().ok()?)))
        .ok_or_else(|| io::Error::other("a PNG cannot be so large, write it as .npy"))?;
    let channels = planes.channels;
    let mut shown = None;
    let mut by = |ramp| *shown.insert(ramp);
    let (bytes, color, depth): (Cow<[u8]>, _, _) = match raster.samples() {
        Samples::U8(values) if channels == 2 => (view::with_blue(values).into(), ColorType::Rgb, BitDepth::Eight),
        Samples::U8(values) => (values.into(), COLORS[channels - 1], BitDepth::Eight),
        Samples::U16(values) => {
            let values = if channels == 2 { view::with_blue(values).into() } else { Cow::Borrowed(&values[..]) };
            let big_endian: Vec<u8> = values.iter().flat_map(|value| value.to_be_bytes()).collect();
            (big_endian.into(), COLORS[channels - 1], BitDepth::Sixteen)
        }
        Samples::F32(values) if channels == 1 => {
            (ramped(values, 1, by(Ramp::of(values))).into(), ColorType::Rgb, BitDepth::Eight)
        }
        Samples::F32(values) if raster.are_numbers() => {
            let (seen, channels) = view::without_fourth(values, channels);
            (ramped(&seen, channels, by(Ramp::of(&seen))).into(), ColorType::Rgb, BitDepth::Eight)
        }
        Samples::F32(values) => (view::linear_light(values, channels).into(), ColorType::Rgb, BitDepth::Eight),
        Samples::U32(values) => {
            (ramped(values, channels, by(Ramp::of(values))).into(), ColorType::Rgb, BitDepth::Eight)
        }
        Samples::I32(values) => {
            (ramped(values, channels, by(Ramp::of(values))).into(), ColorType::Rgb, BitDepth::Eight)
        }
    };
    let comment = shown.map(|ramp| ramp.to_string());
    store(file, &bytes, size, (color, depth), comment)?;
    Ok(shown)
}

/// `bytes` holds exactly the pixels of `size` in its colour type, 16-bit values with the high byte first; the comment goes
/// into the file.
fn store(
    file: &mut impl Write,
    bytes: &[u8],
    (width, height): (u32, u32),
    (color, depth): (ColorType, BitDepth),
    comment: Option<String>,
) -> io::Result<()> {
    let mut encoder = Encoder::new(file, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Balanced);
    encoder.set_filter(Filter::Adaptive);
    if let Some(comment) = comment {
        encoder.add_text_chunk("Comment".to_owned(), comment)?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Rgba8 {
        let pixels = (0..7 * 5 * 4).map(|i| (i * 37 % 251) as u8).collect();
        Rgba8::new(7, 5, pixels).unwrap()
    }

    /// The size, colour type, depth and samples of the file that a raster becomes.
    fn written(raster: &Raster) -> ((u32, u32), ColorType, BitDepth, Vec<u8>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        super::super::write(&path, raster).unwrap();
        let mut reader = Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
        let mut samples = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut samples).unwrap();
        ((frame.width, frame.height), frame.color_type, frame.bit_depth, samples)
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
        store(&mut bytes, picture.pixels(), size, (ColorType::Rgba, BitDepth::Eight), None).unwrap();
        bytes
    }

    #[test]
    fn a_picture_comes_back_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        write_png(&path, &sample()).unwrap();
        assert_eq!(read_png(&path).unwrap(), sample());
        let plain = std::fs::read(&path).unwrap();
        let sha256 = write_png_hashed(&path, &sample()).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), plain);
        assert_eq!(content::file_sha256(&path).unwrap(), sha256);
        let none = Rgba8::new(0, 5, Vec::new()).unwrap();
        assert!(matches!(write_png(&path, &none), Err(Error::Empty { .. })));
        assert!(matches!(write_png_hashed(&path, &none), Err(Error::Empty { .. })));
        assert_eq!(read_png(&path).unwrap(), sample());
    }

    #[test]
    fn grey_and_rgb_files_are_expanded() {
        let mut bytes = Vec::new();
        store(&mut bytes, &[5, 250], (2, 1), (ColorType::Grayscale, BitDepth::Eight), None).unwrap();
        assert_eq!(read(&bytes).unwrap().pixels(), [5, 5, 5, 255, 250, 250, 250, 255]);
        let mut bytes = Vec::new();
        store(&mut bytes, &[1, 2, 3], (1, 1), (ColorType::Rgb, BitDepth::Eight), None).unwrap();
        assert_eq!(read(&bytes).unwrap().pixels(), [1, 2, 3, 255]);
    }

    #[test]
    fn wide_samples_alpha_and_palettes_are_read_to_the_nearest_eight_bits() {
        let pixels = |color, depth, samples: &[u8], size| {
            let mut bytes = Vec::new();
            store(&mut bytes, samples, size, (color, depth), None).unwrap();
            read(&bytes).unwrap().pixels().to_vec()
        };
        let wide = [0u16, 128, 129, 65_406, 65_407, 65_535].map(u16::to_be_bytes).concat();
        let grey = pixels(ColorType::Grayscale, BitDepth::Sixteen, &wide, (6, 1));
        assert_eq!(grey.iter().step_by(4).copied().collect::<Vec<u8>>(), [0, 0, 1, 254, 255, 255]);
        assert!(grey.chunks(4).all(|pixel| pixel[3] == 255 && pixel[1] == pixel[0] && pixel[2] == pixel[0]));
        assert_eq!(pixels(ColorType::GrayscaleAlpha, BitDepth::Eight, &[7, 9], (1, 1)), [7, 7, 7, 9]);
        assert_eq!(pixels(ColorType::Grayscale, BitDepth::Two, &[0b0001_1011], (4, 1))[4..8], [85, 85, 85, 255]);
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(ColorType::Indexed);
        encoder.set_palette(vec![1, 2, 3, 4, 5, 6]);
        encoder.set_trns(vec![255, 100]);
        encoder.write_header().unwrap().write_image_data(&[1, 0]).unwrap();
        assert_eq!(read(&bytes).unwrap().pixels(), [4, 5, 6, 100, 1, 2, 3, 255]);
    }

    #[test]
    fn small_integers_are_stored_unchanged() {
        use BitDepth::{Eight, Sixteen};
        use ColorType::{Grayscale, Rgb, Rgba};
        let image = written(&Raster::image(1, 2, 1, 1, vec![3u8, 200]).unwrap());
        assert_eq!(image, ((1, 2), Grayscale, Eight, vec![3, 200]));
        let image = written(&Raster::image(1, 1, 2, 1, vec![3u8, 200]).unwrap());
        assert_eq!(image, ((1, 1), Rgb, Eight, vec![3, 200, 0]));
        let image = written(&Raster::image(1, 1, 4, 2, vec![1u8, 2, 3, 0, 5, 6, 7, 8]).unwrap());
        assert_eq!(image, ((1, 2), Rgba, Eight, vec![1, 2, 3, 0, 5, 6, 7, 8]));
        let image = written(&Raster::table(1, 2, vec![258u16, 65_535]).unwrap());
        assert_eq!(image, ((2, 1), Grayscale, Sixteen, vec![1, 2, 255, 255]));
        let image = written(&Raster::image(1, 1, 2, 1, vec![258u16, 4]).unwrap());
        assert_eq!(image, ((1, 1), Rgb, Sixteen, vec![1, 2, 0, 4, 0, 0]));
    }

    #[test]
    fn other_data_becomes_a_view() {
        let samples = |raster: &Raster| {
            let (_, color, depth, samples) = written(raster);
            assert_eq!((color, depth), (ColorType::Rgb, BitDepth::Eight));
            samples
        };
        let colour = [0.0, 0.214_041_14, 1.0, 0.0, f32::NAN, 0.0, 0.0, 1.0];
        let image = Raster::image(2, 1, 4, 1, colour.to_vec()).unwrap();
        assert_eq!(samples(&image), [0, 128, 255, 255, 0, 255]);
        let depth = Raster::image(3, 1, 1, 1, vec![-1.0f32, 0.0, 4.0]).unwrap();
        assert_eq!(samples(&depth), [0, 0, 0, 51, 51, 51, 255, 255, 255]);
        let counts = Raster::table(1, 2, vec![0u32, u32::MAX]).unwrap();
        assert_eq!(samples(&counts), [0, 0, 0, 255, 255, 255]);
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

    /// 8,192 pixels a side in some ten kilobytes, whole and without its last row.
    #[test]
    fn a_damaged_picture_of_one_colour_is_refused_before_it_is_kept() {
        let side = 8_192;
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, side, side);
        encoder.set_color(ColorType::Grayscale);
        encoder.set_depth(BitDepth::One);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&vec![0; (side * side / 8) as usize]).unwrap();
        writer.finish().unwrap();
        assert!(bytes.len() < 30_000, "{}", bytes.len());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("black.png");
        let open = |bytes: &[u8], max_side: u32| {
            std::fs::write(&path, bytes).unwrap();
            CheckedPng::open(&path, max_side, None)
        };
        let whole = open(&bytes, MAX_SIDE).unwrap();
        assert!(whole.picture.is_none());
        assert_eq!(whole.size(), (side, side));
        let pixels = whole.into_picture().unwrap().into_pixels();
        assert!(pixels.len() == 1 << 26 && pixels.iter().all(|pixel| *pixel == [0, 0, 0, 255]));
        let cut = &bytes[..bytes.len() - 40];
        assert!(matches!(open(cut, MAX_SIDE), Err(Error::Png { .. })));
        let too_large = open(&bytes, side - 1);
        assert!(matches!(too_large, Err(Error::TooLarge { .. })));
    }
}
