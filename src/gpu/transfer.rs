//! Moving data between host and device outside frames: uploads at start, readbacks at the end.

use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::bindings::{Resource, Use};
use super::buffer::{Buffer, BufferDesc, Location};
use super::commands::Commands;
use super::device::Device;
use super::error::Error;
use super::image::{Image, ImageView};

/// Makes a device buffer that holds `bytes`.
///
/// # Errors
/// As [`Buffer::new`]; what Vulkan answers.
pub fn upload(
    device: &Arc<Device>,
    name: &str,
    usage: vk::BufferUsageFlags,
    bytes: &[u8],
) -> Result<Arc<Buffer>, Error> {
    let size_bytes = bytes.len() as u64;
    let buffer = Buffer::new(device, BufferDesc::new(name, size_bytes).usage(usage))?;
    let staging =
        Buffer::new(device, BufferDesc::new(format!("{name} staging"), size_bytes).location(Location::Upload))?;
    // A buffer has at least four bytes, and all of them are copied.
    staging.write(0, &[0; 4])?;
    staging.write(0, bytes)?;
    let uses = [
        Use { resource: (&staging).into(), access: Access::CopySource, discard: false },
        Use { resource: (&buffer).into(), access: Access::CopyDestination, discard: true },
    ];
    once(device, "upload", &uses, |raw, commands| record_copy(raw, commands, &uses[0].resource, &buffer))?;
    Ok(buffer)
}

/// Copies buffers, each into one of its own size at least, in one submission.
///
/// # Errors
/// [`Error::ReadBeforeWrite`] when nothing has written a source; what Vulkan answers.
pub fn copy_buffers(device: &Arc<Device>, pairs: &[(&Arc<Buffer>, &Arc<Buffer>)]) -> Result<(), Error> {
    let uses: Vec<Use> = pairs
        .iter()
        .flat_map(|&(from, to)| {
            [
                Use { resource: from.into(), access: Access::CopySource, discard: false },
                Use { resource: to.into(), access: Access::CopyDestination, discard: true },
            ]
        })
        .collect();
    once(device, "copy", &uses, |raw, commands| {
        for (from, to) in pairs {
            record_copy(raw, commands, &Resource::from(*from), to);
        }
    })
}

/// Bytes of the staging buffer that images are uploaded through, and of one row at least.
const CHUNK_BYTES: u64 = 8 << 20;

/// Fills the upper left `width` x `height` texels of a view of one layer, through a small staging buffer, chunk by chunk.
/// `fill` writes rows, tightly packed, from the given one on into the bytes it is handed.
///
/// # Errors
/// [`Error::Limit`] when the rectangle is larger than the view; what Vulkan answers.
pub fn upload_rows(
    device: &Arc<Device>,
    view: &Arc<ImageView>,
    (width, height): (u32, u32),
    mut fill: impl FnMut(u32, &mut [u8]),
) -> Result<(), Error> {
    check_rectangle(view, width, height)?;
    let row_bytes = u64::from(width) * texel_bytes(view.image())?;
    let chunk_rows = ((CHUNK_BYTES / row_bytes).max(1) as u32).min(height);
    let name = format!("{} staging", view.image().name());
    let desc = BufferDesc::new(name, row_bytes * u64::from(chunk_rows)).location(Location::Upload);
    let staging = Buffer::new(device, desc)?;
    let mut bytes = vec![0; (row_bytes * u64::from(chunk_rows)) as usize];
    for first_row in (0..height).step_by(chunk_rows as usize) {
        let rows = chunk_rows.min(height - first_row);
        let chunk = &mut bytes[..(row_bytes * u64::from(rows)) as usize];
        fill(first_row, chunk);
        staging.write(0, chunk)?;
        let uses = [
            Use { resource: (&staging).into(), access: Access::CopySource, discard: false },
            Use { resource: view.into(), access: Access::CopyDestination, discard: first_row == 0 },
        ];
        let region = vk::BufferImageCopy::default()
            .image_subresource(subresource(view))
            .image_offset(vk::Offset3D { x: 0, y: first_row as i32, z: 0 })
            .image_extent(vk::Extent3D { width, height: rows, depth: 1 });
        let layout = Access::CopyDestination.info().layout;
        once(device, "upload", &uses, |raw, commands| {
            // SAFETY: recording; the rows lie inside the view, which is in that layout by its barrier, and the staging
            // buffer holds them; both outlive the submission.
            unsafe { raw.cmd_copy_buffer_to_image(commands, staging.raw, view.image.raw, layout, &[region]) };
        })?;
    }
    Ok(())
}

/// Copies the upper left `width` x `height` texels of `from` to column `column` and row `row` of `to`, views of one layer of
/// one format. The rest of `to` keeps what it holds.
///
/// # Errors
/// [`Error::Limit`] when the rectangle is larger than a view; what Vulkan answers.
pub fn copy_rectangle(
    device: &Arc<Device>,
    from: &Arc<ImageView>,
    to: &Arc<ImageView>,
    (column, row): (u32, u32),
    (width, height): (u32, u32),
) -> Result<(), Error> {
    check_rectangle(from, width, height)?;
    check_rectangle(to, column.saturating_add(width), row.saturating_add(height))?;
    let uses = [
        Use { resource: from.into(), access: Access::CopySource, discard: false },
        Use { resource: to.into(), access: Access::CopyDestination, discard: false },
    ];
    let region = vk::ImageCopy::default()
        .src_subresource(subresource(from))
        .dst_subresource(subresource(to))
        .dst_offset(vk::Offset3D { x: column as i32, y: row as i32, z: 0 })
        .extent(vk::Extent3D { width, height, depth: 1 });
    let [source, destination] = uses.each_ref().map(|u| u.access.info().layout);
    once(device, "copy", &uses, |raw, commands| {
        // SAFETY: recording; the rectangle lies inside both views, which are in these layouts by their barriers and
        // outlive the submission.
        unsafe { raw.cmd_copy_image(commands, from.image.raw, source, to.image.raw, destination, &[region]) };
    })
}

fn check_rectangle(view: &Arc<ImageView>, right: u32, bottom: u32) -> Result<(), Error> {
    let sides = [("column of a copy", right, view.width()), ("row of a copy", bottom, view.height())];
    match sides.into_iter().find(|&(_, wanted, limit)| wanted > limit) {
        None => Ok(()),
        Some((what, wanted, limit)) => Err(Error::Limit {
            object: view.image().name().to_owned(),
            what,
            wanted: wanted.into(),
            limit: limit.into(),
        }),
    }
}

fn subresource(view: &ImageView) -> vk::ImageSubresourceLayers {
    vk::ImageSubresourceLayers::default()
        .aspect_mask(copied_aspect(view.image.aspect()))
        .base_array_layer(view.layers.start)
        .layer_count(view.layers.end - view.layers.start)
}

/// Reads a buffer back.
///
/// # Errors
/// [`Error::ReadBeforeWrite`] when no pass has written it; what Vulkan answers.
pub fn read_buffer(device: &Arc<Device>, buffer: &Arc<Buffer>) -> Result<Vec<u8>, Error> {
    read(device, buffer.into(), buffer.size_bytes())
}

/// Reads the texels of a view back: layers, then rows, then columns, tightly packed.
///
/// # Errors
/// [`Error::ReadBeforeWrite`] when no pass has written it; what Vulkan answers.
pub fn read_image(device: &Arc<Device>, view: &Arc<ImageView>) -> Result<Vec<u8>, Error> {
    let layer_count = view.layers.end - view.layers.start;
    let texels = u64::from(view.width()) * u64::from(view.height()) * u64::from(layer_count);
    read(device, view.into(), texels * texel_bytes(view.image())?)
}

fn read(device: &Arc<Device>, from: Resource, size_bytes: u64) -> Result<Vec<u8>, Error> {
    let desc = BufferDesc::new(format!("{} readback", from.name()), size_bytes).location(Location::Readback);
    let target = Buffer::new(device, desc)?;
    let uses = [
        Use { resource: from, access: Access::CopySource, discard: false },
        Use { resource: (&target).into(), access: Access::CopyDestination, discard: true },
    ];
    once(device, "readback", &uses, |raw, commands| record_copy(raw, commands, &uses[0].resource, &target))?;
    target.read(size_bytes, <[u8]>::to_vec)
}

/// Records a copy of all of `from` to the start of `to`, texels tightly packed. The barriers are the caller's.
pub(crate) fn record_copy(raw: &ash::Device, commands: vk::CommandBuffer, from: &Resource, to: &Buffer) {
    match from {
        Resource::Buffer(view) => {
            let size = (view.range.end - view.range.start).min(to.size_bytes());
            let region = vk::BufferCopy::default().src_offset(view.range.start).size(size);
            // SAFETY: recording; the region lies inside both buffers, which outlive the submission.
            unsafe { raw.cmd_copy_buffer(commands, view.buffer.raw, to.raw, &[region]) };
        }
        Resource::Image(view) => {
            let region = vk::BufferImageCopy::default()
                .image_subresource(subresource(view))
                .image_extent(vk::Extent3D { width: view.width(), height: view.height(), depth: 1 });
            let layout = Access::CopySource.info().layout;
            // SAFETY: recording; the image is in that layout by its barrier, and whoever made `to` sized it for the
            // view's texels; both outlive the submission.
            unsafe { raw.cmd_copy_image_to_buffer(commands, view.image.raw, layout, to.raw, &[region]) };
        }
        Resource::Sampler(_) => {}
    }
}

/// Records one piece of work between its barriers, submits it and waits. What a copy writes for the host is made
/// visible to it.
fn once(
    device: &Arc<Device>,
    what: &str,
    uses: &[Use],
    body: impl FnOnce(&ash::Device, vk::CommandBuffer),
) -> Result<(), Error> {
    let mut commands = Commands::new(device, what)?;
    commands.begin()?;
    commands.synchronise(what, uses)?;
    body(&device.raw, commands.buffer);
    let to_host: Vec<Use> = uses
        .iter()
        .filter(|u| matches!(&u.resource, Resource::Buffer(view) if view.buffer.is_readback()))
        .map(|u| Use { access: Access::HostRead, ..u.clone() })
        .collect();
    commands.synchronise(what, &to_host)?;
    commands.submit_and_wait().map(|_| ())
}

/// A copy takes one aspect: of depth and stencil, depth.
fn copied_aspect(aspect: vk::ImageAspectFlags) -> vk::ImageAspectFlags {
    if aspect.contains(vk::ImageAspectFlags::DEPTH) { vk::ImageAspectFlags::DEPTH } else { aspect }
}

/// Bytes of one texel of the formats that targets use.
fn texel_bytes(image: &Image) -> Result<u64, Error> {
    match image.desc().format {
        vk::Format::R16_UINT => Ok(2),
        vk::Format::R8G8B8A8_UNORM
        | vk::Format::R8G8B8A8_SRGB
        | vk::Format::R32_SFLOAT
        | vk::Format::R32_UINT
        | vk::Format::D32_SFLOAT
        | vk::Format::D32_SFLOAT_S8_UINT => Ok(4),
        vk::Format::R16G16B16A16_SFLOAT => Ok(8),
        vk::Format::R32G32B32A32_SFLOAT => Ok(16),
        other => Err(Error::Allocation {
            object: image.name().to_owned(),
            reason: format!("reading it back: the size of a texel of {other:?} is not known"),
        }),
    }
}
