//! A picture on the object, by the texture coordinates of its corners: the dissertation's objects have textures that it
//! does not name.

use std::path::Path;
use std::sync::Arc;

use ash::vk;

use crate::gpu::transfer::{upload, upload_rows};
use crate::gpu::{Buffer, Error, Image, ImageDesc, ImageView, ShaderLibrary};
use crate::host_block;
use crate::image::{Rgba8, read_png_within, srgb};
use crate::measure;

/// A picture with its smaller versions, each half as large as the one before it, down to one texel.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The picture itself first; at least one.
    pub levels: Vec<Level>,
}

/// One size of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Texels.
    pub width: u32,
    /// Texels.
    pub height: u32,
    /// 8-bit sRGB and an alpha that is not looked at, the top row first.
    pub texels: Vec<u8>,
}

host_block! {
    /// A level of the texture in the image that holds all of them (`burning/draw-textured.frag`), texels.
    pub(super) struct TextureLevel {
        width: u32,
        height: u32,
        first_row: u32,
        level_count: u32,
    }
}

/// The buffers and the image of a texture.
pub struct Surface {
    /// All levels below one another, 8-bit sRGB: the shader filters by itself, so that every device draws the same.
    pub texels: Arc<ImageView>,
    /// [`TextureLevel`] of each.
    pub levels: Arc<Buffer>,
    /// vec2\[C\] for C draw vertices: they stay apart where the simulated vertices are welded.
    pub coordinates: Arc<Buffer>,
}

impl Surface {
    /// Uploads `texture` and the coordinates of the draw vertices.
    ///
    /// # Errors
    /// [`Error::Limit`] for a picture that is too large for the device; what Vulkan answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        texture: &Texture,
        coordinates: &[[f32; 2]],
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let level_count = texture.levels.len() as u32;
        let mut first_row = 0;
        let mut levels: Vec<TextureLevel> = Vec::new();
        for &Level { width, height, .. } in &texture.levels {
            levels.push(TextureLevel { width, height, first_row, level_count });
            first_row += height;
        }
        let width = texture.levels[0].width;
        let desc = ImageDesc::new_2d(format!("{label}/texture"), vk::Format::R8G8B8A8_SRGB, width, first_row);
        let texels = Image::new(device, desc.usage(vk::ImageUsageFlags::SAMPLED))?.view()?;
        let row_bytes = 4 * width as usize;
        upload_rows(device, &texels, (width, first_row), |first_row, bytes| {
            for (row, bytes) in (first_row..).zip(bytes.chunks_exact_mut(row_bytes)) {
                let at = levels.partition_point(|level| level.first_row <= row) - 1;
                let from = &texture.levels[at].texels;
                let own_bytes = 4 * texture.levels[at].width as usize;
                let first = (row - levels[at].first_row) as usize * own_bytes;
                // Nothing to the right of a smaller level is read.
                bytes.fill(0);
                bytes[..own_bytes].copy_from_slice(&from[first..first + own_bytes]);
            }
        })?;
        Ok(Surface {
            texels,
            levels: upload(device, &format!("{label}/texture-levels"), storage, bytemuck::cast_slice(&levels))?,
            coordinates: upload(
                device,
                &format!("{label}/texture-coordinates"),
                storage,
                bytemuck::cast_slice(coordinates),
            )?,
        })
    }
}

/// With all its levels a picture of this side fills an image of 16,384 texels a side, which devices of this size of
/// image take; others name their limit.
pub(super) const LARGEST_SIDE: u32 = 8192;

/// Reads a PNG and makes its levels.
///
/// # Errors
/// [`measure::Error::Image`] for a file that is missing, cut short or no PNG, or of more than 8,192 pixels a side.
pub fn load(path: &Path) -> Result<Texture, measure::Error> {
    let picture = read_png_within(path, LARGEST_SIDE)?;
    Ok(with_levels(&picture))
}

/// The levels of a picture: each texel the mean, in linear light, of those of the level before that it covers.
pub fn with_levels(picture: &Rgba8) -> Texture {
    let linear: Vec<f32> = (0..=255_u8).map(|v| srgb::decode(f64::from(v) / 255.0) as f32).collect();
    let mut levels =
        vec![Level { width: picture.width(), height: picture.height(), texels: picture.pixels().to_vec() }];
    while let Some(last) = levels.last().filter(|l| l.width.max(l.height) > 1) {
        let next = halved(last, &linear);
        levels.push(next);
    }
    Texture { levels }
}

/// Half as many texels along each side, rounded down, but one at least; `linear` is the light of each 8-bit value.
fn halved(from: &Level, linear: &[f32]) -> Level {
    let (width, height) = ((from.width / 2).max(1), (from.height / 2).max(1));
    // An odd side's last texel has three to cover.
    let covered = |at: u32, count: u32, of: u32| {
        let end = if at + 1 == count { of } else { 2 * at + 2 };
        2 * at..end
    };
    let mut texels = Vec::with_capacity(4 * width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let mut sums = [0.0_f32; 3];
            let mut count = 0.0;
            for row in covered(y, height, from.height) {
                for column in covered(x, width, from.width) {
                    let first = 4 * (row as usize * from.width as usize + column as usize);
                    for (sum, &value) in sums.iter_mut().zip(&from.texels[first..first + 3]) {
                        *sum += linear[usize::from(value)];
                    }
                    count += 1.0;
                }
            }
            texels.extend(sums.map(|sum| srgb::encode8(sum / count)));
            texels.push(255);
        }
    }
    Level { width, height, texels }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, color: impl Fn(u32, u32) -> [u8; 3]) -> Rgba8 {
        let at = |i: u32| color(i % width, i / width);
        let pixels = (0..width * height).flat_map(|i| [at(i)[0], at(i)[1], at(i)[2], 255]).collect();
        Rgba8::new(width, height, pixels).unwrap()
    }

    #[test]
    fn levels_halve_down_to_one_texel() {
        for (width, height, sizes) in [
            (1, 1, vec![(1, 1)]),
            (4, 4, vec![(4, 4), (2, 2), (1, 1)]),
            (5, 2, vec![(5, 2), (2, 1), (1, 1)]),
            (1, 3, vec![(1, 3), (1, 1)]),
        ] {
            let texture = with_levels(&picture(width, height, |_, _| [9, 200, 77]));
            let found: Vec<_> = texture.levels.iter().map(|l| (l.width, l.height)).collect();
            assert_eq!(found, sizes);
            // One colour stays so.
            for level in &texture.levels {
                assert_eq!(level.texels.len(), 4 * (level.width * level.height) as usize);
                assert!(level.texels.chunks_exact(4).all(|t| t == [9, 200, 77, 255]));
            }
        }
    }

    #[test]
    fn means_are_of_light() {
        let board = with_levels(&picture(2, 2, |x, y| [255 * ((x + y) % 2) as u8; 3]));
        // Half the light is 188 of 255.
        assert_eq!(board.levels[1].texels, [188, 188, 188, 255]);
        // Three columns become one: none is left out.
        let stripes = with_levels(&picture(3, 1, |x, _| [if x == 2 { 255 } else { 0 }, 0, 0]));
        assert_eq!(stripes.levels[1].texels[0], srgb::encode8(1.0 / 3.0));
    }

    #[test]
    fn a_picture_that_is_too_large_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("wide.png");
        crate::image::write_png(&path, &picture(8193, 1, |_, _| [0; 3])).unwrap();
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains("8193 x 1") && !error.contains('\n'), "{error}");
    }
}
