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
    let reader = decoder.read_info()?;
    // The library would panic.
    if reader.info().palette.as_ref().is_some_and(|palette| palette.is_empty() || palette.len() % 3 != 0) {
        let reason = "its palette is no list of colours";
        return Err(DecodingError::from(io::Error::new(io::ErrorKind::InvalidData, reason)).into());
    }
    Ok(((width, height), reader))
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
mod tests;
