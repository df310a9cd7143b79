//! Lists as images, which `common/texels.glsl` finds its way in.

use std::sync::Arc;

use ash::vk;
use bytemuck::Pod;

use crate::gpu::transfer::upload_rows;
use crate::gpu::{Device, Error, Image, ImageDesc, ImageView};

/// Texels in a row: every device has so long rows.
pub const ROW: u32 = 1 << 12;

/// Makes an image of `count` values, each one or several texels of four numbers of 32 bits and asked for once and in order.
/// The rest of its last row is zero.
///
/// # Errors
/// [`Error::Limit`] for more rows than the device's images have; any error of Vulkan.
pub fn upload_list<T: Pod>(
    device: &Arc<Device>,
    name: &str,
    format: vk::Format,
    count: usize,
    value: impl Fn(usize) -> T,
) -> Result<Arc<ImageView>, Error> {
    let values_of_row = 16 * ROW as usize / size_of::<T>();
    // More rows than a number of 32 bits counts are beyond every device.
    let rows = u32::try_from(count.div_ceil(values_of_row)).unwrap_or(u32::MAX).max(1);
    let desc = ImageDesc::new_2d(name, format, ROW, rows).usage(vk::ImageUsageFlags::STORAGE);
    let view = Image::new(device, desc)?.view()?;
    upload_rows(device, &view, (ROW, rows), |first_row, bytes| {
        let first = first_row as usize * values_of_row;
        for (place, bytes) in (first..).zip(bytes.chunks_exact_mut(size_of::<T>())) {
            match place < count {
                true => bytes.copy_from_slice(bytemuck::bytes_of(&value(place))),
                false => bytes.fill(0),
            }
        }
    })?;
    Ok(view)
}

/// Bytes of so many of its rows.
pub fn bytes_of_rows(rows: u32) -> u64 {
    16 * u64::from(ROW) * u64::from(rows)
}

/// Bytes of such an image of so many texels, whose rows drivers keep by fours.
pub fn bytes_of(texels: f64) -> f64 {
    bytes_of_rows(4) as f64 * (texels / (4.0 * f64::from(ROW))).ceil().max(1.0)
}
