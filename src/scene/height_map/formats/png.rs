use super::check_compressed;
use crate::scene::HeightMap;
use crate::scene::error::{Fault, Place};
use crate::scene::height_map::grid::{Grid, Placement};
use crate::scene::height_map::map::check_size;
use ::image::codecs::png::PngDecoder;
use ::image::{DynamicImage, ExtendedColorType, ImageDecoder, Limits};
use std::io::{BufRead, Seek};

/// 16 bits and alpha in the largest map.
const MAX_BYTES: u64 = 4 << 28;

/// Reads a grey PNG of 8 or 16 bits: whole metres. Transparent samples, which is how GDAL writes no-data, are void.
pub(super) fn parse(size_bytes: u64, input: impl BufRead + Seek) -> Result<HeightMap, Fault> {
    let foreign = |error: ::image::ImageError| Fault::foreign(Place::Whole, &error);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_BYTES);
    let decoder = PngDecoder::with_limits(input, limits).map_err(foreign)?;
    let (width, height) = decoder.dimensions();
    let header_fault = |reason: String| Fault::new(Place::Part("IHDR".to_owned()), reason);
    check_size(width.into(), height.into()).map_err(header_fault)?;
    check_compressed(size_bytes, (width, height), 8).map_err(header_fault)?;
    use ExtendedColorType::{L1, L2, L4};
    let is_packed = matches!(decoder.original_color_type(), L1 | L2 | L4);
    let image = DynamicImage::from_decoder(decoder).map_err(foreign)?;
    // A value that no 16-bit sample has.
    const VOID: i32 = -1;
    let masked = |value: u16, alpha: u16| if alpha == 0 { VOID } else { value.into() };
    match image {
        DynamicImage::ImageLuma8(samples) if !is_packed => map(width, height, samples.into_raw(), None),
        DynamicImage::ImageLuma16(samples) => map(width, height, samples.into_raw(), None),
        DynamicImage::ImageLumaA8(samples) => {
            let values = samples.pixels().map(|pixel| masked(pixel[0].into(), pixel[1].into())).collect();
            map::<i32>(width, height, values, Some(VOID.into()))
        }
        DynamicImage::ImageLumaA16(samples) => {
            let values = samples.pixels().map(|pixel| masked(pixel[0], pixel[1])).collect();
            map::<i32>(width, height, values, Some(VOID.into()))
        }
        _ => {
            let reason =
                "it is no grey picture of 8 or 16 bits; write heights as grey, for instance with gdal_translate";
            Err(Fault::new(Place::Part("IHDR".to_owned()), reason))
        }
    }
}

fn map<T: Copy + Into<f64>>(width: u32, height: u32, values: Vec<T>, no_data: Option<f64>) -> Result<HeightMap, Fault> {
    Grid { width, height, values, integral: true, no_data, placement: Placement::Unknown }.into_map()
}
