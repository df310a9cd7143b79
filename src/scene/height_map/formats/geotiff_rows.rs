//! GeoTIFFs of which a row of tiles, or a strip, is held at a time.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use tiff::decoder::{ChunkType, DecodingResult};

use super::geotiff::{MAX_BYTES, Picture, fault, foreign};
use super::{auxiliary, malformed, open_tiff, tiff};
use crate::scene::Error;
use crate::scene::binary::spare_bytes;
use crate::scene::error::Fault;
use crate::scene::height_map::grid::{Placement, fits_steps, is_height, is_void, no_height};
use crate::scene::height_map::void_samples::{Suspect, Watch};
use crate::scene::height_map::{HeightMap, MapOptions, Rows, Samples};

/// A GeoTIFF whose samples are all heights.
pub(in crate::scene::height_map) struct GeoTiffRows {
    path: PathBuf,
    options: MapOptions,
    size: (u32, u32),
    placement: Placement,
    /// The height of step 0, metres, where the heights are whole numbers that 16-bit steps hold.
    lowest: Option<f64>,
    suspect: Option<Suspect>,
}

impl GeoTiffRows {
    /// Looks at all samples of a TIFF or of an overview of it; none of another file and of one with voids, or with a row of tiles or
    /// a strip beyond what is ever read at once.
    pub(in crate::scene::height_map) fn survey(path: &Path, options: MapOptions) -> Result<Option<Self>, Error> {
        let Some(mut picture) = open(path, options)? else { return Ok(None) };
        let size = (picture.width, picture.height);
        let (_, chunk_rows) = picture.decoder.chunk_dimensions();
        let band_bytes = u64::from(size.0) * u64::from(chunk_rows.min(size.1)) * size_of::<f64>() as u64;
        // Nor one that could be far larger than its file is.
        if band_bytes > spare_bytes(picture.size_bytes).min(MAX_BYTES as u64)
            || !matches!(picture.bits, 8 | 16 | 32 | 64)
        {
            return Ok(None);
        }
        let (no_data, placement) = (picture.no_data, picture.placement);
        let mut watch = Watch::new(no_data);
        let (mut low, mut high, mut is_void_free, mut row) = (f64::MAX, f64::MIN, true, 0);
        let is_integral = each_band(&mut picture, path, &mut |band| {
            for values in band.chunks_exact(size.0 as usize) {
                for (column, &value) in values.iter().enumerate() {
                    if is_void(value, no_data) {
                        is_void_free = false;
                        return Ok(false);
                    }
                    if !is_height(value) {
                        return Err(malformed(path, no_height(row, column, value)));
                    }
                    (low, high) = (low.min(value), high.max(value));
                    watch.see(value);
                }
                row += 1;
            }
            Ok(true)
        })?;
        let lowest = (is_integral && fits_steps(low, high)).then_some(low);
        let suspect = watch.suspect();
        let rows = GeoTiffRows { path: path.to_owned(), options, size, placement, lowest, suspect };
        Ok(is_void_free.then_some(rows))
    }

    /// All but samples, range and slope.
    pub(in crate::scene::height_map) fn map(&self) -> Result<HeightMap, Error> {
        let kind = match self.lowest {
            Some(lowest) => Samples::Steps { values: Vec::new(), origin_m: lowest as f32, step_m: 1.0 },
            None => Samples::Float(Vec::new()),
        };
        let map = HeightMap::promised(self.size.0, self.size.1, kind)?;
        Ok(self.placement.place(map)?.with_suspect(self.suspect))
    }

    /// Hands all rows to `take` while that says true, and says what it said last; heights in metres are multiplied by `factor`.
    pub(in crate::scene::height_map) fn read(
        &self,
        factor: f32,
        take: &mut dyn FnMut(Rows<'_>) -> Result<bool, Error>,
    ) -> Result<bool, Error> {
        let changed = || {
            let reason = format!("{} was changed while it was read; start again", self.path.display());
            Error::HeightMap { reason }
        };
        let mut picture = open(&self.path, self.options)?.ok_or_else(changed)?;
        if (picture.width, picture.height) != self.size {
            return Err(changed());
        }
        let (mut steps, mut heights, mut goes_on) = (Vec::new(), Vec::new(), true);
        each_band(&mut picture, &self.path, &mut |band| {
            let rows = match self.lowest {
                Some(lowest) => {
                    steps.clear();
                    steps.extend(band.iter().map(|value| (value - lowest) as u16));
                    Rows::Steps(&steps)
                }
                None => {
                    heights.clear();
                    heights.extend(band.iter().map(|&value| value as f32 * factor));
                    Rows::Float(&heights)
                }
            };
            goes_on = take(rows)?;
            Ok(goes_on)
        })?;
        Ok(goes_on)
    }
}

fn open(path: &Path, options: MapOptions) -> Result<Option<Picture<BufReader<File>>>, Error> {
    let Some(opened) = open_tiff(path)? else { return Ok(None) };
    auxiliary::check(path)?;
    tiff(path, opened, options).map(Some)
}

/// Hands whole rows to `take`, as many as a tile or a strip has, while it says true; true where all are whole numbers by their kind.
fn each_band(
    picture: &mut Picture<BufReader<File>>,
    path: &Path,
    take: &mut dyn FnMut(&[f64]) -> Result<bool, Error>,
) -> Result<bool, Error> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let (chunk_width, chunk_height) = picture.decoder.chunk_dimensions();
    if chunk_width == 0 || chunk_height == 0 {
        return Err(malformed(path, fault("TileWidth, TileLength, RowsPerStrip", "a tile or a strip has no samples")));
    }
    let (chunk_width, chunk_height) = (chunk_width as usize, (chunk_height as usize).min(height));
    let across = match picture.decoder.get_chunk_type() {
        ChunkType::Strip => 1,
        ChunkType::Tile => width.div_ceil(chunk_width),
    };
    let mut is_integral = true;
    let mut band = Vec::new();
    for (number, first_row) in (0..height).step_by(chunk_height).enumerate() {
        let rows = chunk_height.min(height - first_row);
        band.resize(rows * width, 0.0);
        for column in 0..across {
            let first = column * chunk_width;
            let columns = chunk_width.min(width - first);
            let chunk = picture.decoder.read_chunk((number * across + column) as u32);
            let (values, is_whole) = numbers(chunk.map_err(|error| malformed(path, foreign(error)))?);
            is_integral &= is_whole;
            if values.len() < rows * columns {
                return Err(malformed(path, short(values.len(), rows * columns)));
            }
            for (row, values) in values.chunks_exact(columns).take(rows).enumerate() {
                band[row * width + first..][..columns].copy_from_slice(values);
            }
        }
        if !take(&band)? {
            break;
        }
    }
    Ok(is_integral)
}

fn short(samples: usize, expected: usize) -> Fault {
    fault(
        "TileWidth, TileLength, RowsPerStrip",
        format!("a tile or a strip has {samples} samples instead of {expected}"),
    )
}

/// The samples of a tile or a strip; true where their kind has whole numbers alone.
fn numbers(chunk: DecodingResult) -> (Vec<f64>, bool) {
    fn all<T: Into<f64>>(values: Vec<T>) -> Vec<f64> {
        values.into_iter().map(Into::into).collect()
    }
    match chunk {
        DecodingResult::U8(values) => (all(values), true),
        DecodingResult::I8(values) => (all(values), true),
        DecodingResult::U16(values) => (all(values), true),
        DecodingResult::I16(values) => (all(values), true),
        DecodingResult::U32(values) => (all(values), true),
        DecodingResult::I32(values) => (all(values), true),
        DecodingResult::U64(values) => (values.into_iter().map(|value| value as f64).collect(), true),
        DecodingResult::I64(values) => (values.into_iter().map(|value| value as f64).collect(), true),
        DecodingResult::F16(values) => (values.into_iter().map(|value| f64::from(f32::from(value))).collect(), false),
        DecodingResult::F32(values) => (all(values), false),
        DecodingResult::F64(values) => (values, false),
    }
}

#[cfg(test)]
mod tests {
    use super::super::load;
    use super::*;
    use crate::scene::height_map::RowSource;
    use tiff::encoder::TiffEncoder;
    use tiff::encoder::colortype::{ColorType, Gray16, Gray32Float};
    use tiff::encoder::{Compression, DeflateLevel, TiffValue};
    use tiff::tags::Tag;

    /// A file of a picture and its overviews, one sample a metre, its first corner at 1000, 2000.
    fn write<C: ColorType>(path: &Path, pictures: &[(u32, u32, Vec<C::Inner>)])
    where
        [C::Inner]: TiffValue,
    {
        let file = File::create(path).unwrap();
        let mut encoder = TiffEncoder::new(file).unwrap().with_compression(Compression::Deflate(DeflateLevel::Fast));
        for (number, (width, height, values)) in pictures.iter().enumerate() {
            let mut picture = encoder.new_image::<C>(*width, *height).unwrap();
            picture.rows_per_strip(7).unwrap();
            if number == 0 {
                picture.encoder().write_tag(Tag::ModelPixelScaleTag, &[1.0_f64, 1.0, 0.0][..]).unwrap();
                let tie = [0.0_f64, 0.0, 0.0, 1000.0, 2000.0, 0.0];
                picture.encoder().write_tag(Tag::ModelTiepointTag, &tie[..]).unwrap();
            } else {
                picture.encoder().write_tag(Tag::NewSubfileType, 1_u32).unwrap();
            }
            picture.write_data(values).unwrap();
        }
    }

    /// All samples in their order, and the map without them.
    fn read(path: &Path, overview: u32, factor: f32) -> (Vec<f32>, HeightMap) {
        let mut values = Vec::new();
        let rows = RowSource::geotiff(path, overview).unwrap().unwrap().with_exaggeration(factor).unwrap();
        let map = rows.read(path, &mut |rows| {
            match rows {
                Rows::Steps(steps) => values.extend(steps.iter().map(|&step| f32::from(step))),
                Rows::Float(heights) => values.extend_from_slice(heights),
            }
            true
        });
        (values, map.unwrap().unwrap())
    }

    fn assert_same(path: &Path, overview: u32) {
        for factor in [1.0, 2.5] {
            let whole = load(path, overview).unwrap().with_exaggeration(factor).unwrap();
            let (values, map) = read(path, overview, factor);
            let expected: Vec<f32> = match whole.samples() {
                Samples::Steps { values, .. } => values.iter().map(|&step| f32::from(step)).collect(),
                Samples::Float(heights) => heights.clone(),
            };
            assert!(values == expected, "{}, overview {overview}", path.display());
            assert_eq!(map, whole.clone().without_samples(whole.range_m(), whole.slope()).unwrap());
        }
    }

    #[test]
    fn rows_of_a_file_and_its_overviews_are_those_of_the_whole_ones() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tif");
        let value = |width: u32, index: u32| 300 + (index % width * 7 + index / width * 13) % 900;
        let picture = |width: u32, height: u32| (0..width * height).map(move |index| value(width, index));
        let steps = |w, h| (w, h, picture(w, h).map(|value| value as u16).collect());
        let heights = |w, h| (w, h, picture(w, h).map(|value| value as f32 - 0.25).collect());
        write::<Gray16>(&path, &[steps(45, 31), steps(23, 16), steps(12, 8)]);
        (0..3).for_each(|overview| assert_same(&path, overview));
        let spacing = |overview: u32| load(&path, overview).unwrap().spacing_m().to_array();
        assert_eq!((spacing(0), spacing(1)), ([1.0, 1.0], [45.0 / 23.0, 31.0 / 16.0]));
        let corner = |overview: u32| {
            let map = load(&path, overview).unwrap();
            map.coordinates().unwrap().corners(map.width(), map.height())[0].to_array()
        };
        assert_eq!((corner(0), corner(2)), ([1000.0, 2000.0], [1000.0, 2000.0]));
        let missing = load(&path, 3).unwrap_err().to_string();
        assert!(missing.contains("NewSubfileType: it has 2 overviews"), "{missing}");
        write::<Gray32Float>(&path, &[heights(45, 31), heights(23, 16)]);
        (0..2).for_each(|overview| assert_same(&path, overview));
    }

    /// Files that GDAL wrote, in tiles and in strips.
    #[test]
    fn shipped_files_are_read_by_their_tiles() {
        let maps = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/maps");
        for name in ["jacksboro.tif", "lidar-dem.tif"] {
            let path = maps.join(name);
            if load(&path, 0).unwrap().voids() == 0 {
                assert_same(&path, 0);
            } else {
                assert!(RowSource::geotiff(&path, 0).unwrap().is_none(), "{name}: its voids need all of it");
            }
        }
        for other in ["topobathy-int16.asc", "topobathy-2000m-uint16.png"] {
            assert!(RowSource::geotiff(&maps.join(other), 0).unwrap().is_none());
            let refused = load(&maps.join(other), 1).unwrap_err().to_string();
            assert!(refused.contains("only a GeoTIFF has any"), "{refused}");
        }
    }

    /// A file that is cut off, or another one, after it was surveyed.
    #[test]
    fn a_file_that_changes_is_told_of() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tif");
        let picture = |w: u32, h: u32| (w, h, (0..w * h).map(|i| (i * 7919 % 60_013) as u16).collect());
        for cut in [true, false] {
            write::<Gray16>(&path, &[picture(45, 31)]);
            let rows = RowSource::geotiff(&path, 0).unwrap().unwrap();
            if cut {
                // Its place and its first strips.
                let mut bytes = std::fs::read(&path).unwrap();
                bytes[20..400].fill(0xaa);
                std::fs::write(&path, bytes).unwrap();
            } else {
                write::<Gray16>(&path, &[picture(40, 31)]);
            }
            let line = rows.read(&path, &mut |_| true).unwrap_err().to_string();
            assert!(!line.contains('\n') && line.contains("a.tif"), "{line}");
            assert!(cut || line.contains("was changed while it was read"), "{line}");
        }
    }
}
