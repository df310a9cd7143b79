//! A first look at the samples of a GeoTIFF that could be far larger than its file. None is kept.

use super::distinct::firsts;
use super::geotiff::{Picture, fault, foreign};
use crate::scene::binary::spare_bytes;
use crate::scene::error::Fault;
use crate::scene::height_map::grid::{all_void, is_height, is_same, is_void, no_height};
use std::io::{Read, Seek};
use tiff::decoder::{ChunkType, DecodingResult};

/// Decodes all strips or tiles, one by one, and looks for what makes them no map. True where a sample is a height that is none of
/// `voids`, which stand for none as well.
pub(super) fn check_samples(picture: &mut Picture<impl Read + Seek>, voids: &[f64]) -> Result<bool, Fault> {
    let Picture { decoder, bits, width, no_data, size_bytes, .. } = picture;
    let (chunk_width, chunk_height) = decoder.chunk_dimensions();
    if chunk_width == 0 || chunk_height == 0 {
        return Err(fault("TileWidth, TileLength, RowsPerStrip", "a tile or a strip has no samples"));
    }
    let chunk_bytes = u64::from(chunk_width) * u64::from(chunk_height) * u64::from(*bits).div_ceil(8);
    if chunk_bytes > spare_bytes(*size_bytes) {
        let reason = format!(
            "it packs {chunk_bytes} bytes into one strip of a file of {size_bytes}; write it anew in tiles, with \
             gdal_translate -co TILED=YES"
        );
        return Err(fault("RowsPerStrip", reason));
    }
    let (count, across) = match decoder.get_chunk_type() {
        ChunkType::Strip => (decoder.strip_count(), 1),
        ChunkType::Tile => (decoder.tile_count(), width.div_ceil(chunk_width)),
    };
    let mut seen = Seen::default();
    for chunk in 0..count.map_err(foreign)? {
        let columns = decoder.chunk_data_dimensions(chunk).0.max(1) as usize;
        let samples = decoder.read_chunk(chunk).map_err(foreign)?;
        look_at(&samples, *no_data, voids, &mut seen).map_err(|(index, value)| {
            let row = (chunk / across) as usize * chunk_height as usize + index / columns;
            let column = (chunk % across) as usize * chunk_width as usize + index % columns;
            no_height(row, column, value)
        })?;
    }
    if seen.has_height { Ok(seen.has_known) } else { Err(all_void()) }
}

#[derive(Default)]
struct Seen {
    /// A sample of the file is a height.
    has_height: bool,
    /// One is a height to whoever asks, too.
    has_known: bool,
}

/// A sample that is no height: its index and itself.
type NoHeight = (usize, f64);

fn look_at(samples: &DecodingResult, no_data: Option<f64>, voids: &[f64], seen: &mut Seen) -> Result<(), NoHeight> {
    let mut look = Look { no_data, voids, seen };
    match samples {
        DecodingResult::U8(values) => look.at_heights(values, f64::from),
        DecodingResult::I8(values) => look.at_heights(values, f64::from),
        DecodingResult::U16(values) => look.at_heights(values, f64::from),
        DecodingResult::I16(values) => look.at_heights(values, f64::from),
        DecodingResult::U32(values) => look.at(values, f64::from),
        DecodingResult::I32(values) => look.at(values, f64::from),
        DecodingResult::U64(values) => look.at(values, |value| value as f64),
        DecodingResult::I64(values) => look.at(values, |value| value as f64),
        DecodingResult::F16(values) => look.at(values, f64::from),
        DecodingResult::F32(values) => look.at(values, f64::from),
        DecodingResult::F64(values) => look.at(values, f64::from),
    }
}

struct Look<'a> {
    no_data: Option<f64>,
    voids: &'a [f64],
    seen: &'a mut Seen,
}

impl Look<'_> {
    /// At numbers that are all heights: once one is known the others tell nothing.
    fn at_heights<T: Copy + PartialEq>(&mut self, values: &[T], number: impl Fn(T) -> f64) -> Result<(), NoHeight> {
        if self.seen.has_known { Ok(()) } else { self.at(values, number) }
    }

    fn at<T: Copy + PartialEq>(&mut self, values: &[T], number: impl Fn(T) -> f64) -> Result<(), NoHeight> {
        match firsts(values) {
            Some(firsts) => firsts.into_iter().try_for_each(|index| self.at_one(index, number(values[index]))),
            None => (0..).zip(values).try_for_each(|(index, value)| self.at_one(index, number(*value))),
        }
    }

    fn at_one(&mut self, index: usize, value: f64) -> Result<(), NoHeight> {
        let Look { no_data, voids, seen } = self;
        if !is_height(value) {
            return if is_void(value, *no_data) { Ok(()) } else { Err((index, value)) };
        }
        if !seen.has_known && !is_void(value, *no_data) {
            seen.has_height = true;
            seen.has_known = !voids.iter().any(|void| is_same(value, *void));
        }
        Ok(())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::geotiff;
    use std::io::Cursor;
    use tiff::encoder::colortype::Gray32Float;
    use tiff::encoder::{Compression, DeflateLevel, TiffEncoder};
    use tiff::tags::Tag;

    /// Of more bytes than a file of its size may take.
    pub(in super::super) const SIDE: u32 = 4_800;

    /// A packed file of zeros, but for the sample of an index; -9999 is no height.
    pub(in super::super) fn packed(zero: f32, index: usize, sample: f32) -> Vec<u8> {
        let mut values = vec![zero; (SIDE * SIDE) as usize];
        values[index] = sample;
        let mut file = Cursor::new(Vec::new());
        let encoder = TiffEncoder::new(&mut file).unwrap();
        let mut encoder = encoder.with_compression(Compression::Deflate(DeflateLevel::Fast));
        let mut picture = encoder.new_image::<Gray32Float>(SIDE, SIDE).unwrap();
        picture.rows_per_strip(64).unwrap();
        picture.encoder().write_tag(Tag::GdalNodata, "-9999").unwrap();
        picture.write_data(&values).unwrap();
        file.into_inner()
    }

    #[test]
    fn samples_that_are_no_map_are_refused_before_any_is_kept() {
        let last = (SIDE * SIDE - 1) as usize;
        for (zero, index, sample, expected) in [
            (0.0, 0, f32::NAN, "row 0, column 0: its height is NaN"),
            (0.0, last, f32::NAN, "row 4799, column 4799: its height is NaN"),
            (0.0, last - 4_800, 1e30, "row 4798, column 4799: its height is 1.0000000150474662e30 m, and"),
            (-9_999.0, last, -9_999.0, "all its samples are void"),
        ] {
            let bytes = packed(zero, index, sample);
            assert!(bytes.len() < 1 << 20, "{} bytes", bytes.len());
            let mut picture = geotiff::Picture::open(bytes.len() as u64, Cursor::new(&bytes[..]), 0).unwrap();
            let fault = super::check_samples(&mut picture, &[]).unwrap_err();
            assert!(fault.to_string().starts_with(expected), "{fault}");
            let whole = geotiff::parse(bytes.len() as u64, Cursor::new(&bytes[..]), 0);
            assert_eq!(whole.unwrap_err(), fault);
        }
        let bytes = packed(-9_999.0, last / 2, 5.0);
        for (voids, is_known) in [(&[][..], true), (&[4.0, 5.0], false), (&[-9_999.0, 5.1], true)] {
            let mut picture = geotiff::Picture::open(bytes.len() as u64, Cursor::new(&bytes[..]), 0).unwrap();
            assert_eq!(super::check_samples(&mut picture, voids), Ok(is_known), "{voids:?}");
        }
        let map = geotiff::parse(bytes.len() as u64, Cursor::new(&bytes[..]), 0).unwrap();
        assert_eq!((map.voids(), map.range_m()), (last as u64, (5.0, 5.0)));
    }
}
