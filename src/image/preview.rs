//! Small pictures of targets.

use super::raster::{Raster, Samples};
use super::view::{self, Ramp, ramped};
use super::{Error, Rgba8, Shape};

/// The first layer of a raster as a picture whose sides have at most `longest_px` pixels, by leaving pixels out. Values are
/// drawn as [`Format::Png`](super::Format::Png) draws them, by a ramp over what is shown.
///
/// # Errors
/// [`Error::Length`] for a raster without values.
pub fn preview(raster: &Raster, longest_px: u32) -> Result<Rgba8, Error> {
    let planes = raster.planes();
    let longest = longest_px.max(1) as usize;
    let step = |side: usize| side.div_ceil(longest).max(1);
    let [across, down] = match raster.shape() {
        Shape::Image { .. } => [step(planes.width.max(planes.height)); 2],
        // The rows of a table are many and short.
        Shape::Table { .. } => [step(planes.width), step(planes.height)],
    };
    let picked = Picked { row: planes.width, height: planes.height, channels: planes.channels, across, down };
    let (width, height) = (planes.width.div_ceil(across), planes.height.div_ceil(down));
    let channels = planes.channels;
    let pixels = match raster.samples() {
        Samples::U8(values) if channels == 4 => picked.of(values),
        Samples::U8(values) => opaque(&plain(&picked.of(values), channels)),
        Samples::U16(values) => {
            let bytes: Vec<u8> = picked.of(values).iter().map(|value| (value >> 8) as u8).collect();
            opaque(&plain(&bytes, channels))
        }
        Samples::F32(values) if channels == 1 => opaque(&by_ramp(&picked.of(values), 1)),
        Samples::F32(values) => opaque(&view::linear_light(&picked.of(values), channels)),
        Samples::U32(values) => opaque(&by_ramp(&picked.of(values), channels)),
        Samples::I32(values) => opaque(&by_ramp(&picked.of(values), channels)),
    };
    Rgba8::new(width as u32, height as u32, pixels)
}

fn by_ramp<T: Copy + Into<f64>>(values: &[T], channels: usize) -> Vec<u8> {
    ramped(values, channels, Ramp::of(values))
}

/// Bytes of one to four channels as RGB.
fn plain(values: &[u8], channels: usize) -> Vec<u8> {
    let pixel = |pixel: &[u8]| match *pixel {
        [grey] => [grey; 3],
        [r, g] => [r, g, 0],
        _ => [pixel[0], pixel[1], pixel[2]],
    };
    values.chunks_exact(channels).flat_map(pixel).collect()
}

fn opaque(rgb: &[u8]) -> Vec<u8> {
    rgb.chunks_exact(3).flat_map(|rgb| [rgb[0], rgb[1], rgb[2], 255]).collect()
}

/// The pixels of the first layer that are taken.
struct Picked {
    row: usize,
    height: usize,
    channels: usize,
    across: usize,
    down: usize,
}

impl Picked {
    fn of<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let rows = values.chunks_exact((self.row * self.channels).max(1)).take(self.height).step_by(self.down);
        rows.flat_map(|row| row.chunks_exact(self.channels).step_by(self.across)).flatten().copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_left_out_until_both_sides_fit() {
        let values: Vec<u8> = (0..10 * 4 * 2).map(|i| i as u8).collect();
        let raster = Raster::image(10, 4, 1, 2, values).unwrap();
        let small = preview(&raster, 5).unwrap();
        assert_eq!((small.width(), small.height()), (5, 2));
        assert_eq!(small.pixels()[..8], [0, 0, 0, 255, 2, 2, 2, 255]);
        assert_eq!(small.pixels()[5 * 4], 20);
        assert_eq!(preview(&raster, 1000).unwrap().width(), 10);
        let table = Raster::table(100, 2, (0..200).collect::<Vec<u32>>()).unwrap();
        let small = preview(&table, 10).unwrap();
        assert_eq!((small.width(), small.height()), (2, 10));
        assert_eq!((small.pixels()[0], small.pixels()[19 * 4]), (0, 255));
    }
}
