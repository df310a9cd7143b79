use super::geotiff_check::check_samples;
use super::placement::{MapCoordinates, Unit, by_world_file};
use super::stored::Stored;
use super::systems::{HEIGHTS_IN_FEET, NOT_IN_METRES, WEB_MERCATOR, foot_m};
use super::{check_compressed, check_unit};
use crate::scene::binary::spare_bytes;
use crate::scene::error::{Fault, Place};
use crate::scene::height_map::grid::{Grid, Placement};
use crate::scene::height_map::map::check_size;
use crate::scene::height_map::{MapOptions, shown};
use crate::scene::{Error, HeightMap};
use glam::DVec2;
use std::io::{Read, Seek};
use std::path::Path;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

/// The largest map in 64 bits a sample.
pub(super) const MAX_BYTES: usize = 8 << 28;
/// Tables of strips or tiles.
const MAX_TAG_BYTES: usize = 16 << 20;
const GDAL_METADATA: Tag = Tag::Unknown(42_112);
const GEO_DOUBLE_PARAMETERS: Tag = Tag::Unknown(34_736);
const GEO_ASCII_PARAMETERS: Tag = Tag::Unknown(34_737);

/// A picture of a TIFF or BigTIFF, with what the tags of GeoTIFF and GDAL say of it.
pub(super) struct Picture<R: Read + Seek> {
    /// At the picture.
    pub(super) decoder: Decoder<Stored<R>>,
    /// Of a sample.
    pub(super) bits: u8,
    /// Samples in a row.
    pub(super) width: u32,
    /// Number of rows.
    pub(super) height: u32,
    /// The value of a sample without a height.
    pub(super) no_data: Option<f64>,
    /// Spacing and coordinates, as far as the file has them.
    pub(super) placement: Placement,
    /// Of its file.
    pub(super) size_bytes: u64,
    /// The unit of its coordinates, where it states no place; nothing where it does.
    unplaced: Option<Option<Unit>>,
    /// Columns and rows of the data, of which this may be an overview.
    whole: (u32, u32),
    options: MapOptions,
}

impl<R: Read + Seek> Picture<R> {
    /// The first picture, or the overview of a number from 1 on, which has its tags.
    pub(super) fn open(size_bytes: u64, input: R, options: impl Into<MapOptions>) -> Result<Self, Fault> {
        let options = options.into();
        let MapOptions { overview, has_own_spacing, .. } = options;
        let mut limits = Limits::default();
        limits.decoding_buffer_size = MAX_BYTES;
        limits.intermediate_buffer_size = MAX_BYTES;
        limits.ifd_value_size = MAX_TAG_BYTES;
        let input = Stored::new(input).map_err(|error| Fault::foreign(Place::Whole, &error))?;
        let mut decoder = Decoder::new(input).map_err(foreign)?.with_limits(limits);
        let whole = decoder.dimensions().map_err(foreign)?;
        if overview == 0 {
            check_shape(&mut decoder, size_bytes)?;
        }
        let mut tags = Tags { decoder: &mut decoder, size_bytes };
        tags.refuse_scaled_heights()?;
        let (no_data, unit, coordinates) = (tags.no_data()?, tags.keys()?.unit, tags.coordinates(whole)?);
        let unplaced = coordinates.is_none().then_some(unit);
        if overview > 0 {
            find_overview(&mut decoder, overview)?;
        }
        let ((width, height), bits) = check_shape(&mut decoder, size_bytes)?;
        let placement = match coordinates {
            Some(coordinates) => coordinates.in_parts(width, height).placed_or_spaced(unit, has_own_spacing)?,
            None => Placement::Unknown,
        };
        Ok(Picture { decoder, bits, width, height, no_data, placement, size_bytes, unplaced, whole, options })
    }

    /// The picture in the file at `path`: where it states no place, that of a world file beside it.
    pub(super) fn in_file(self, path: &Path) -> Result<Self, Error> {
        let Some(unit) = self.unplaced else { return Ok(self) };
        let placement = by_world_file(path, unit, self.whole, (self.width, self.height), self.options)?;
        Ok(Picture { placement, ..self })
    }

    /// Bytes of all samples, unpacked.
    ///
    /// # Errors
    /// Samples that are not read, for their kind or because there are too many.
    pub(super) fn raw_bytes(&self) -> Result<u64, Fault> {
        let Picture { bits, width, height, .. } = *self;
        if !matches!(bits, 8 | 16 | 32 | 64) {
            return Err(fault("BitsPerSample", format!("it is {bits}; 8, 16, 32 and 64 can be read")));
        }
        let raw_bytes = u64::from(width) * u64::from(height) * u64::from(bits / 8);
        if raw_bytes > MAX_BYTES as u64 {
            let reason = format!(
                "its samples take {} MiB, and {} are read at most; write fewer with gdal_translate -outsize 50% 50%, or parts \
                 and a mosaic of them with gdalbuildvrt",
                raw_bytes >> 20,
                MAX_BYTES >> 20
            );
            return Err(fault("ImageWidth, ImageLength, BitsPerSample", reason));
        }
        Ok(raw_bytes)
    }
}

/// Columns, rows and bits of a picture that can be a height map.
fn check_shape(decoder: &mut Decoder<impl Read + Seek>, size_bytes: u64) -> Result<((u32, u32), u8), Fault> {
    let (width, height) = decoder.dimensions().map_err(foreign)?;
    check_size(width.into(), height.into()).map_err(|reason| fault("ImageWidth, ImageLength", reason))?;
    let ColorType::Gray(bits) = decoder.colortype().map_err(foreign)? else {
        return Err(fault("SamplesPerPixel", "it is no picture of one channel; a height map has one band"));
    };
    check_compressed(size_bytes, (width, height), bits.into())
        .map_err(|reason| fault("ImageWidth, ImageLength, BitsPerSample", reason))?;
    Ok(((width, height), bits))
}

/// Moves on to the picture of an overview, from 1 on.
fn find_overview(decoder: &mut Decoder<impl Read + Seek>, overview: u32) -> Result<(), Fault> {
    /// Bits of the tag: a smaller version of another picture, and a mask.
    const SMALLER: u32 = 1;
    const MASK: u32 = 4;
    let mut found = 0;
    while decoder.more_images() {
        decoder.next_image().map_err(foreign)?;
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType).map_err(foreign)?.unwrap_or(0);
        found += u32::from(kind & SMALLER != 0 && kind & MASK == 0);
        if found == overview {
            return Ok(());
        }
    }
    Err(fault("NewSubfileType", format!("it has {found} overviews; `overview` takes one of them, or 0 for the data")))
}

/// Reads the first picture, or an overview, in strips or tiles.
pub(super) fn parse(
    size_bytes: u64,
    input: impl Read + Seek,
    options: impl Into<MapOptions>,
) -> Result<HeightMap, Fault> {
    read(Picture::open(size_bytes, input, options)?)
}

/// Reads a picture in strips or tiles.
pub(super) fn read(mut picture: Picture<impl Read + Seek>) -> Result<HeightMap, Fault> {
    if picture.raw_bytes()? > spare_bytes(picture.size_bytes) {
        check_samples(&mut picture, &[])?;
    }
    let Picture { mut decoder, width, height, no_data, placement, .. } = picture;
    let source = Source { width, height, no_data, placement };
    match decoder.read_image().map_err(foreign)? {
        DecodingResult::U8(values) => source.map(values, true),
        DecodingResult::I8(values) => source.map(values, true),
        DecodingResult::U16(values) => source.map(values, true),
        DecodingResult::I16(values) => source.map(values, true),
        DecodingResult::U32(values) => source.map(values, true),
        DecodingResult::I32(values) => source.map(values, true),
        DecodingResult::U64(values) => source.map(values.into_iter().map(|value| value as f64).collect(), true),
        DecodingResult::I64(values) => source.map(values.into_iter().map(|value| value as f64).collect(), true),
        DecodingResult::F16(values) => source.map(values.into_iter().map(f32::from).collect(), false),
        DecodingResult::F32(values) => source.map(values, false),
        DecodingResult::F64(values) => source.map(values, false),
    }
}

struct Source {
    width: u32,
    height: u32,
    no_data: Option<f64>,
    placement: Placement,
}

impl Source {
    fn map<T: Copy + Into<f64>>(self, values: Vec<T>, integral: bool) -> Result<HeightMap, Fault> {
        let Self { width, height, no_data, placement } = self;
        Grid { width, height, values, integral, no_data, placement }.into_map()
    }
}

/// The tags that concern heights and places.
struct Tags<'a, R: Read + Seek> {
    decoder: &'a mut Decoder<R>,
    size_bytes: u64,
}

impl<R: Read + Seek> Tags<'_, R> {
    fn no_data(&mut self) -> Result<Option<f64>, Fault> {
        let Some(text) = self.text(Tag::GdalNodata, "GDAL_NODATA")? else { return Ok(None) };
        let number = text.trim_matches(|character: char| character == '\0' || character.is_whitespace());
        let shown: String = number.chars().take(40).collect();
        number.parse().map(Some).map_err(|_| fault("GDAL_NODATA", format!("it is {shown:?}, not a number")))
    }

    /// GDAL may store heights / scale; reading them as metres would be wrong in silence.
    fn refuse_scaled_heights(&mut self) -> Result<(), Fault> {
        let metadata = self.text(GDAL_METADATA, "GDAL_METADATA")?.unwrap_or_default();
        if metadata.contains("role=\"scale\"") || metadata.contains("role=\"offset\"") {
            let reason = "it gives heights a scale or an offset; write plain metres with gdal_translate -unscale";
            return Err(fault("GDAL_METADATA", reason));
        }
        let unit = metadata.split_once("role=\"unittype\">").and_then(|(_, rest)| rest.split('<').next());
        check_unit(unit.unwrap_or_default()).map_err(|reason| fault("GDAL_METADATA", reason))
    }

    /// Places of the samples of a picture of so many columns and rows.
    fn coordinates(&mut self, (width, height): (u32, u32)) -> Result<Option<MapCoordinates>, Fault> {
        let keys = self.keys()?;
        // A tie point names the sample's corner, or with PixelIsPoint its centre.
        let offset = if keys.raster_type == Some(2) { 0.0 } else { 0.5 };
        let (field, corner, step) = if let Some(scale) = self.numbers(Tag::ModelPixelScaleTag, "ModelPixelScale", 2)? {
            let step = DVec2::new(scale[0], scale[1]);
            let corner = self
                .numbers(Tag::ModelTiepointTag, "ModelTiepoint", 6)?
                .map(|tie| DVec2::new(tie[3] - tie[0] * step.x, tie[4] + tie[1] * step.y));
            ("ModelPixelScale", corner, step)
        } else if let Some(matrix) = self.numbers(Tag::ModelTransformationTag, "ModelTransformation", 16)? {
            if matrix[1] != 0.0 || matrix[4] != 0.0 {
                let reason = "it turns the map; write one with north up with gdalwarp";
                return Err(fault("ModelTransformation", reason));
            }
            ("ModelTransformation", Some(DVec2::new(matrix[3], matrix[7])), DVec2::new(matrix[0], -matrix[5]))
        } else {
            return Ok(None);
        };
        if !(step.is_finite() && step.min_element() > 0.0) {
            let [x, y] = step.to_array().map(shown);
            let reason = format!(
                "it makes steps of {x} and {y}; both have to be positive, which gdalwarp makes them: it writes north up"
            );
            return Err(fault(field, reason));
        }
        let north_west = corner.map(|corner| corner + DVec2::new(step.x, -step.y) * offset);
        Ok(Some(MapCoordinates { north_west, step, width, height, field }))
    }

    /// GeoTIFF 1.1, section 7.1.2: four numbers a key (name, location, count, value or index), after four of the
    /// header.
    fn keys(&mut self) -> Result<Keys, Fault> {
        let directory = match self.decoder.find_tag(Tag::GeoKeyDirectoryTag).map_err(foreign)? {
            Some(value) => value.into_u16_vec().map_err(|error| Fault::foreign(part("GeoKeyDirectory"), &error))?,
            None => Vec::new(),
        };
        let short = |key: u16| {
            let entry = directory.chunks_exact(4).skip(1).find(|entry| entry[0] == key && entry[1] == 0);
            entry.map(|entry| entry[3])
        };
        let system = short(3_072).unwrap_or_default();
        let unit = match (short(1_024), short(3_076), short(2_054)) {
            (Some(1), Some(9_002), _) => Some(Unit::Metres(0.3048)),
            (Some(1), Some(9_003), _) => Some(Unit::Metres(1_200.0 / 3_937.0)),
            (Some(1), unit, _) if WEB_MERCATOR.contains(&system) && matches!(unit, None | Some(9_001)) => {
                Some(Unit::WebMercator)
            }
            (Some(1), Some(9_001), _) => Some(Unit::Metres(1.0)),
            (Some(1), None, _) => Some(Unit::Metres(self.unit_by_name(system)?)),
            (Some(1), Some(32_767), _) => {
                let entry = directory.chunks_exact(4).skip(1).find(|entry| entry[0] == 3_077 && entry[1] == 34_736);
                let sizes = self.numbers(GEO_DOUBLE_PARAMETERS, "GeoDoubleParams", 1)?.unwrap_or_default();
                let size = entry.and_then(|entry| sizes.get(usize::from(entry[3])));
                Some(Unit::Metres(size.copied().filter(|size| size.is_finite() && *size > 0.0).unwrap_or(1.0)))
            }
            (Some(1), Some(other), _) => {
                return Err(fault("ProjLinearUnits", format!("the unit {other} is not known; use metres or feet")));
            }
            (Some(2), _, None | Some(9_102)) => Some(Unit::Degrees),
            (Some(2), _, Some(other)) => {
                return Err(fault("GeogAngularUnits", format!("the unit {other} is not known; use degrees (9102)")));
            }
            _ => None,
        };
        let name = self.names();
        let (_, name_of_heights) = name.split_once(" + ").unwrap_or_default();
        let is_in_feet = short(4_096).is_some_and(|system| HEIGHTS_IN_FEET.contains(&system));
        match short(4_099) {
            Some(9_002 | 9_003) => Err(fault("VerticalUnits", check_unit("feet").err().unwrap_or_default())),
            None if is_in_feet || foot_m(name_of_heights).is_some() => {
                Err(fault("VerticalCSType", check_unit("feet").err().unwrap_or_default()))
            }
            None | Some(0 | 9_001 | 32_767) => Ok(Keys { raster_type: short(1_025), unit }),
            Some(other) => {
                Err(fault("VerticalUnits", format!("the unit {other} of heights is not known; use metres (9001)")))
            }
        }
    }

    /// Metres of the unit of a projected system of EPSG by its name and number: of one with a system of heights, GDAL writes no
    /// other unit.
    fn unit_by_name(&mut self, system: u16) -> Result<f64, Fault> {
        let name = self.names();
        if let Some(foot_m) = foot_m(name.split(" + ").next().unwrap_or_default()) {
            return Ok(foot_m);
        }
        if NOT_IN_METRES.iter().any(|systems| systems.contains(&system)) {
            let reason = format!(
                "EPSG:{system} is not in metres, and the file names no unit; write one in metres with gdalwarp"
            );
            return Err(fault("ProjectedCSType", reason));
        }
        Ok(1.0)
    }

    /// Names of its systems; without any where they are no text, since they are not needed to read it.
    fn names(&mut self) -> String {
        self.text(GEO_ASCII_PARAMETERS, "GeoAsciiParams").ok().flatten().unwrap_or_default()
    }

    fn text(&mut self, tag: Tag, name: &str) -> Result<Option<String>, Fault> {
        let length = self.decoder.image_ifd().find_entry(tag).map_or(0, |entry| entry.count());
        // The library would allocate it.
        if length > self.size_bytes {
            return Err(fault(name, format!("it claims {length} characters, more than the file has; it is damaged")));
        }
        let Some(value) = self.decoder.find_tag(tag).map_err(foreign)? else { return Ok(None) };
        value.into_string().map(Some).map_err(|error| Fault::foreign(part(name), &error))
    }

    /// A tag's numbers, at least so many.
    fn numbers(&mut self, tag: Tag, name: &str, least: usize) -> Result<Option<Vec<f64>>, Fault> {
        let Some(value) = self.decoder.find_tag(tag).map_err(foreign)? else { return Ok(None) };
        let numbers = value.into_f64_vec().map_err(|error| Fault::foreign(part(name), &error))?;
        if numbers.len() < least {
            return Err(fault(name, format!("it has {} numbers instead of {least}", numbers.len())));
        }
        Ok(Some(numbers))
    }
}

struct Keys {
    raster_type: Option<u16>,
    unit: Option<Unit>,
}

fn part(tag: &str) -> Place {
    Place::Part(tag.to_owned())
}

pub(super) fn fault(tag: &str, reason: impl Into<String>) -> Fault {
    Fault::new(part(tag), reason)
}

pub(super) fn foreign(error: tiff::TiffError) -> Fault {
    Fault::foreign(Place::Whole, &error)
}
