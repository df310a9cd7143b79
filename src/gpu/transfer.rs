//! Moving data between host and device outside frames: uploads at start, readbacks at the end.

use std::sync::Arc;

use ash::vk;
use bytemuck::Pod;

use super::access::Access;
use super::bindings::{Resource, Use};
use super::buffer::{Buffer, BufferDesc, BufferView, Location};
use super::commands::Commands;
use super::device::Device;
use super::error::Error;
use super::format::format_info;
use super::image::{Image, ImageView};
use super::pass_check;

/// Makes a device buffer that holds `bytes`.
///
/// # Errors
/// As [`Buffer::new`]; any error of Vulkan.
pub fn upload(
    device: &Arc<Device>,
    name: &str,
    usage: vk::BufferUsageFlags,
    bytes: &[u8],
) -> Result<Arc<Buffer>, Error> {
    let fill = |at: u64, chunk: &mut [u8]| chunk.copy_from_slice(&bytes[at as usize..][..chunk.len()]);
    upload_chunks(device, name, usage, bytes.len() as u64, CHUNK_BYTES, fill)
}

/// Makes a device buffer of `count` values, each asked for once and in order: a list of them is nowhere in memory.
///
/// # Errors
/// As [`upload`].
pub fn upload_each<T: Pod>(
    device: &Arc<Device>,
    name: &str,
    usage: vk::BufferUsageFlags,
    count: usize,
    value: impl Fn(usize) -> T,
) -> Result<Arc<Buffer>, Error> {
    let value_bytes = size_of::<T>().max(1);
    let chunk_bytes = (CHUNK_BYTES / value_bytes as u64).max(1) * value_bytes as u64;
    // A multiple of what a copy begins at: every value of a buffer is one of four bytes.
    upload_chunks(device, name, usage, (count * value_bytes) as u64, chunk_bytes, |at, chunk| {
        let first = at as usize / value_bytes;
        for (place, bytes) in (first..).zip(chunk.chunks_exact_mut(value_bytes)) {
            bytes.copy_from_slice(bytemuck::bytes_of(&value(place)));
        }
    })
}

/// Makes a device buffer through a small staging buffer, chunk by chunk; `fill` writes the bytes from the given one on.
fn upload_chunks(
    device: &Arc<Device>,
    name: &str,
    usage: vk::BufferUsageFlags,
    size_bytes: u64,
    chunk_bytes: u64,
    fill: impl Fn(u64, &mut [u8]),
) -> Result<Arc<Buffer>, Error> {
    let buffer = Buffer::new(device, BufferDesc::new(name, size_bytes).usage(usage))?;
    let desc = BufferDesc::new(format!("{name} staging"), chunk_bytes.min(buffer.size_bytes()));
    let staging = Buffer::new(device, desc.location(Location::Upload))?;
    let mut bytes = vec![0; staging.size_bytes() as usize];
    for first in (0..buffer.size_bytes()).step_by(bytes.len()) {
        let end = buffer.size_bytes().min(first + bytes.len() as u64);
        let chunk = &mut bytes[..(end - first) as usize];
        // A buffer has at least four bytes; those that nothing was given for are zero.
        fill(first, &mut chunk[..(size_bytes.min(end) - first) as usize]);
        staging.write(0, chunk)?;
        let (from, to) = (staging.range(0..end - first)?, buffer.range(first..end)?);
        let uses = [
            Use { resource: (&from).into(), access: Access::CopySource, discard: false },
            Use { resource: (&to).into(), access: Access::CopyDestination, discard: true },
        ];
        let region = vk::BufferCopy::default().dst_offset(first).size(end - first);
        once(device, "upload", &uses, |raw, commands| {
            // SAFETY: recording; the region lies inside both buffers, as their ranges do; both outlive the submission.
            unsafe { raw.cmd_copy_buffer(commands, staging.raw, buffer.raw, &[region]) };
        })?;
    }
    Ok(buffer)
}

/// Writes `bytes` to the start of a device buffer.
///
/// # Errors
/// [`Error::Pass`] for more than it holds; any error of Vulkan.
pub fn update(buffer: &Arc<Buffer>, bytes: &[u8]) -> Result<(), Error> {
    let device = &buffer.device;
    let name = format!("{} staging", buffer.name());
    let staging = Buffer::new(device, BufferDesc::new(name, bytes.len() as u64).location(Location::Upload))?;
    // A buffer has at least four bytes, and all of them are copied.
    staging.write(0, &[0; 4])?;
    staging.write(0, bytes)?;
    check_copy("upload", &(&staging).into(), buffer)?;
    let uses = copy_uses(&(&staging).into(), buffer);
    once(device, "upload", &uses, |raw, commands| record_copy(raw, commands, &uses[0].resource, buffer))
}

/// Copies buffers, each into one of its own size at least, in one submission.
///
/// # Errors
/// [`Error::ReadBeforeWrite`] when nothing has written a source; any error of Vulkan.
pub fn copy_buffers(device: &Arc<Device>, pairs: &[(&Arc<Buffer>, &Arc<Buffer>)]) -> Result<(), Error> {
    let uses: Vec<Use> = pairs.iter().flat_map(|&(from, to)| copy_uses(&from.into(), to)).collect();
    for &(from, to) in pairs {
        check_copy("copy", &from.into(), to)?;
    }
    once(device, "copy", &uses, |raw, commands| {
        for (from, to) in pairs {
            record_copy(raw, commands, &Resource::from(*from), to);
        }
    })
}

/// Bytes of the staging buffer that buffers and images are uploaded through; of an image one row at least.
const CHUNK_BYTES: u64 = 8 << 20;

/// Fills the upper left `width` x `height` texels of a view of one layer, through a small staging buffer, chunk by chunk.
/// `fill` writes rows, tightly packed, from the given one on into the bytes it is handed.
///
/// # Errors
/// [`Error::Pass`] for an image of depth; [`Error::Limit`] when the rectangle is larger than the view; any error of
/// Vulkan.
pub fn upload_rows(
    device: &Arc<Device>,
    view: &Arc<ImageView>,
    (width, height): (u32, u32),
    mut fill: impl FnMut(u32, &mut [u8]),
) -> Result<(), Error> {
    check_upload(view)?;
    check_rectangle("upload", view, (0, width), (0, height))?;
    let row_bytes = u64::from(width) * texel_bytes(view.image());
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

/// Writes the first texels of a staging buffer, tightly packed, to the rectangle of that size at column `column` and row `row`
/// of `to`, a view of one layer. The rest of `to` keeps what it holds.
///
/// # Errors
/// [`Error::Pass`] for an image of depth; [`Error::Limit`] when the rectangle leaves the view or the buffer holds less; any
/// error of Vulkan.
pub fn upload_rectangle(
    staging: &Arc<Buffer>,
    to: &Arc<ImageView>,
    (column, row): (u32, u32),
    (width, height): (u32, u32),
) -> Result<(), Error> {
    check_upload(to)?;
    check_rectangle("upload", to, (column, width), (row, height))?;
    let bytes = u64::from(width) * u64::from(height) * texel_bytes(to.image());
    let from = staging.range(0..bytes)?;
    let uses = [
        Use { resource: (&from).into(), access: Access::CopySource, discard: false },
        Use { resource: to.into(), access: Access::CopyDestination, discard: false },
    ];
    let region = vk::BufferImageCopy::default()
        .image_subresource(subresource(to))
        .image_offset(vk::Offset3D { x: column as i32, y: row as i32, z: 0 })
        .image_extent(vk::Extent3D { width, height, depth: 1 });
    let layout = Access::CopyDestination.info().layout;
    once(&staging.device, "upload", &uses, |raw, commands| {
        // SAFETY: recording; the rectangle lies inside the view, which is in that layout by its barrier, and the buffer holds
        // its texels by its range; both outlive the submission.
        unsafe { raw.cmd_copy_buffer_to_image(commands, staging.raw, to.image.raw, layout, &[region]) };
    })
}

/// Copies the upper left `width` x `height` texels of `from` to column `column` and row `row` of `to`, views of one layer of
/// one format. The rest of `to` keeps what it holds.
///
/// # Errors
/// [`Error::Limit`] when the rectangle is larger than a view; any error of Vulkan.
pub fn copy_rectangle(
    device: &Arc<Device>,
    from: &Arc<ImageView>,
    to: &Arc<ImageView>,
    (column, row): (u32, u32),
    (width, height): (u32, u32),
) -> Result<(), Error> {
    check_rectangle("copy", from, (0, width), (0, height))?;
    check_rectangle("copy", to, (column, width), (row, height))?;
    if from.image().desc().format != to.image().desc().format {
        let problem = format!("{} and {} differ in format", from.image().name(), to.image().name());
        return Err(Error::Pass { pass: "copy".into(), problem });
    }
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

/// Depth comes from draws, which keep it inside 0 to 1, as Vulkan wants of copied bytes too.
fn check_upload(view: &Arc<ImageView>) -> Result<(), Error> {
    if !view.image().aspect().contains(vk::ImageAspectFlags::DEPTH) {
        return Ok(());
    }
    let name = view.image().name();
    let problem = format!("{name} holds depth, which passes fill: bytes from the host may lie outside 0 to 1");
    Err(Error::Pass { pass: "upload".into(), problem })
}

/// The rectangle, given as first and count of columns and rows, is no empty one and lies inside a view of one layer.
fn check_rectangle(pass: &str, view: &Arc<ImageView>, columns: (u32, u32), rows: (u32, u32)) -> Result<(), Error> {
    let name = view.image().name();
    if columns.1 == 0 || rows.1 == 0 || view.layer_count() != 1 {
        let problem = format!("{name}: it copies rectangles that are not empty, of one layer at a time");
        return Err(Error::Pass { pass: pass.to_owned(), problem });
    }
    let sides = [("column of a copy", columns, view.width()), ("row of a copy", rows, view.height())];
    for (what, (first, count), limit) in sides {
        let wanted = u64::from(first) + u64::from(count);
        if wanted > limit.into() {
            return Err(Error::Limit { object: name.to_owned(), what, wanted, limit: limit.into() });
        }
    }
    Ok(())
}

/// The uses of a copy of all of `from` to the start of `to`.
pub(crate) fn copy_uses(from: &Resource, to: &Arc<Buffer>) -> [Use; 2] {
    let written = BufferView { range: 0..copied_bytes(from).clamp(1, to.size_bytes()), ..to.view() };
    [
        Use { resource: from.clone(), access: Access::CopySource, discard: false },
        Use { resource: (&written).into(), access: Access::CopyDestination, discard: true },
    ]
}

/// Bytes of a copy of all of it, texels tightly packed.
pub(crate) fn copied_bytes(from: &Resource) -> u64 {
    match from {
        Resource::Buffer(view) => view.len_bytes(),
        Resource::Image(view) => view.texel_count() * texel_bytes(view.image()),
        Resource::Sampler(_) => 0,
    }
}

/// # Errors
/// [`Error::Pass`] for a source that is larger than `to`, or that has no contents.
pub(crate) fn check_copy(pass: &str, from: &Resource, to: &Arc<Buffer>) -> Result<(), Error> {
    let bytes = copied_bytes(from);
    if bytes > 0 && bytes <= to.size_bytes() {
        return Ok(());
    }
    let problem = format!("copies {bytes} bytes of {} to {}, which has {}", from.name(), to.name(), to.size_bytes());
    Err(Error::Pass { pass: pass.to_owned(), problem })
}

/// # Errors
/// [`Error::Pass`] for a resource that was not made for copies, or one that is written and used twice;
/// [`Error::Foreign`].
pub(crate) fn check_uses(device: &Arc<Device>, pass: &str, uses: &[Use]) -> Result<(), Error> {
    for one in uses {
        let is_source = one.access == Access::CopySource;
        let fits = match &one.resource {
            Resource::Buffer(view) if is_source => view.buffer.usage().contains(vk::BufferUsageFlags::TRANSFER_SRC),
            Resource::Buffer(view) => view.buffer.usage().contains(vk::BufferUsageFlags::TRANSFER_DST),
            Resource::Image(view) if is_source => view.image.desc().usage.contains(vk::ImageUsageFlags::TRANSFER_SRC),
            Resource::Image(view) => view.image.desc().usage.contains(vk::ImageUsageFlags::TRANSFER_DST),
            Resource::Sampler(_) => false,
        };
        if !fits {
            let problem = format!("{} was not made to be copied so", one.resource.name());
            return Err(Error::Pass { pass: pass.to_owned(), problem });
        }
    }
    pass_check::uses(device, pass, uses)
}

pub(super) fn subresource(view: &ImageView) -> vk::ImageSubresourceLayers {
    vk::ImageSubresourceLayers::default()
        .aspect_mask(copied_aspect(view.image.aspect()))
        .base_array_layer(view.layers.start)
        .layer_count(view.layers.end - view.layers.start)
}

/// Reads a buffer back.
///
/// # Errors
/// [`Error::ReadBeforeWrite`] when no pass has written it; any error of Vulkan.
pub fn read_buffer(device: &Arc<Device>, buffer: &Arc<Buffer>) -> Result<Vec<u8>, Error> {
    read(device, buffer.into(), buffer.size_bytes())
}

/// Reads the texels of a view back: layers or slices, then rows, then columns, tightly packed.
///
/// # Errors
/// [`Error::ReadBeforeWrite`] when no pass has written it; any error of Vulkan.
pub fn read_image(device: &Arc<Device>, view: &Arc<ImageView>) -> Result<Vec<u8>, Error> {
    read(device, view.into(), view.texel_count() * texel_bytes(view.image()))
}

fn read(device: &Arc<Device>, from: Resource, size_bytes: u64) -> Result<Vec<u8>, Error> {
    let desc = BufferDesc::new(format!("{} readback", from.name()), size_bytes).location(Location::Readback);
    let target = Buffer::new(device, desc)?;
    let uses = copy_uses(&from, &target);
    check_copy("readback", &from, &target)?;
    once(device, "readback", &uses, |raw, commands| record_copy(raw, commands, &uses[0].resource, &target))?;
    target.read(size_bytes, <[u8]>::to_vec)
}

/// Records a copy of all of `from` to the start of `to`, texels tightly packed. The barriers are the caller's.
pub(crate) fn record_copy(raw: &ash::Device, commands: vk::CommandBuffer, from: &Resource, to: &Buffer) {
    match from {
        Resource::Buffer(view) => {
            let region = vk::BufferCopy::default().src_offset(view.range.start).size(view.len_bytes());
            // SAFETY: recording; the region lies inside both buffers by `check_copy`; the submission keeps both.
            unsafe { raw.cmd_copy_buffer(commands, view.buffer.raw, to.raw, &[region]) };
        }
        Resource::Image(view) => {
            let region = vk::BufferImageCopy::default()
                .image_subresource(subresource(view))
                .image_extent(vk::Extent3D { width: view.width(), height: view.height(), depth: view.depth() });
            let layout = Access::CopySource.info().layout;
            // SAFETY: recording; the image is in that layout by its barrier, and `to` holds the view's texels by
            // `check_copy`; the submission keeps both.
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
    check_uses(device, what, uses)?;
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

/// Bytes of one texel. Every image's format is known.
fn texel_bytes(image: &Image) -> u64 {
    format_info(image.desc().format).map_or(0, |info| info.texel_bytes)
}
