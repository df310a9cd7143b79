//! The swapchain: images of a window, shown one after the other. What is drawn is an ordinary image of this layer, and
//! presenting copies its bytes, so that the format's own sRGB encoding never touches them.

mod plan;
mod sync;

use std::mem;
use std::sync::Arc;

use ash::vk;

pub use plan::PresentMode;
use plan::{Plan, plan};
use sync::{Fence, Semaphore};

use super::access::Access;
use super::bindings::Use;
use super::commands::Commands;
use super::device::Device;
use super::error::{Context, Error};
use super::image::ImageView;
use super::live::Kind;
use super::surface::{Presenting, Surface};
use super::transfer;

/// Nanoseconds that a frame waits for an image. A hidden window may get none, and must not hold its user up.
const PATIENCE_NS: u64 = 100_000_000;

/// The end of one attempt to show a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presented {
    /// It is on its way to the screen.
    Shown,
    /// As `Shown`; a swapchain made anew may fit the surface better, or do no better.
    Suboptimal,
    /// It may not be seen: the window has changed, and the swapchain must be made anew.
    Stale,
    /// No image is free: try again later.
    Busy,
    /// The surface is lost, and must be made anew with the swapchain.
    SurfaceLost,
}

/// Size and turn of a surface, which a swapchain is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    extent: vk::Extent2D,
    transform: vk::SurfaceTransformFlagsKHR,
}

/// An image of the swapchain.
struct Slot {
    image: vk::Image,
    /// Signalled when the picture is copied into it.
    copied: Semaphore,
    /// Signalled when its last present has let go of `copied`; absent where the device has no such fences.
    released: Option<Fence>,
    /// A present was given the fence, which was not waited for since.
    is_pending: bool,
}

impl Slot {
    /// Keeps its semaphore and its fence from being destroyed.
    fn leak(&mut self) {
        self.copied.leak();
        if let Some(fence) = &mut self.released {
            fence.leak();
        }
    }
}

/// The images of a window.
pub struct Swapchain {
    raw: vk::SwapchainKHR,
    slots: Vec<Slot>,
    acquired: Semaphore,
    /// An image was acquired, and its semaphore never waited for.
    is_broken: bool,
    commands: Commands,
    plan: Plan,
    device: Arc<Device>,
    surface: Arc<Surface>,
}

impl Swapchain {
    /// The swapchain of `surface`, of `window` pixels where the display lets the window choose; `None` for a window
    /// without any, as a minimised one. `old` is taken over where it is of the same device and surface, and gone
    /// afterwards.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where the surface has no image that a picture can be copied into, or not this way of
    /// presenting, or another swapchain than `old`; any error of Vulkan.
    pub fn new(
        device: &Arc<Device>,
        surface: &Arc<Surface>,
        window: (u32, u32),
        mode: PresentMode,
        old: Option<Swapchain>,
    ) -> Result<Option<Self>, Error> {
        let presenting = presenting(device)?;
        let physical = device.physical().raw;
        if !Arc::ptr_eq(surface.instance(), device.instance()) {
            return Err(Error::Foreign { pass: "present".into(), object: "the surface".into() });
        }
        // Vulkan takes over what was made of the same parents alone; any other goes before, and lets go of its window.
        let old = old.filter(|old| Arc::ptr_eq(&old.device, device) && Arc::ptr_eq(&old.surface, surface));
        let mut current = surface.lock();
        let family = device.queue_family;
        // SAFETY: surface and device belong to the same living instance, as checked, and the family is the device's.
        let presents = unsafe { surface.calls.get_physical_device_surface_support(physical, family, surface.raw) }
            .context("asking about the surface of", "the window")?;
        if !presents {
            let problem = format!("presenting to it from {}", device.physical().name);
            return Err(Error::Unsupported { object: "the window".into(), problem });
        }
        let (capabilities, formats, modes);
        // SAFETY: surface and device belong to the same living instance, as checked.
        unsafe {
            let asking = "asking about the surface of";
            capabilities = surface
                .calls
                .get_physical_device_surface_capabilities(physical, surface.raw)
                .context(asking, "the window")?;
            formats = surface
                .calls
                .get_physical_device_surface_formats(physical, surface.raw)
                .context(asking, "the window")?;
            modes = surface
                .calls
                .get_physical_device_surface_present_modes(physical, surface.raw)
                .context(asking, "the window")?;
        }
        let Some(plan) = plan(&capabilities, &formats, &modes, mode, window)? else { return Ok(None) };
        // What may fail comes before there is a swapchain, which would be nobody's then.
        let (acquired, commands) = (Semaphore::new(device, "acquired")?, Commands::new(device, "present")?);
        let old_raw = old.as_ref().map_or_else(vk::SwapchainKHR::null, |old| old.raw);
        if *current != old_raw {
            let problem = "a second swapchain at a time: give the first as the old one, or drop it".into();
            return Err(Error::Unsupported { object: "the window".into(), problem });
        }
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(surface.raw)
            .min_image_count(plan.image_count)
            .image_format(plan.format.format)
            .image_color_space(plan.format.color_space)
            .image_extent(plan.extent)
            .image_array_layers(1)
            .image_usage(vk::ImageUsageFlags::TRANSFER_DST)
            .image_sharing_mode(vk::SharingMode::EXCLUSIVE)
            .pre_transform(plan.transform)
            .composite_alpha(plan.alpha)
            .present_mode(plan.mode.vulkan())
            .clipped(true)
            .old_swapchain(old_raw);
        // SAFETY: the plan is made of what the surface offers; the surface is held below, and locked for the call; `old`, if
        // any, is of the same device and surface, not retired before, and not used again; no other swapchain has the surface.
        let raw = unsafe { presenting.swapchains.create_swapchain(&info, None) }
            .context("creating the swapchain of", "the window")?;
        device.live().add(Kind::Swapchain);
        *current = raw;
        drop(current);
        drop(old);
        let mut swapchain = Swapchain {
            raw,
            slots: Vec::new(),
            acquired,
            is_broken: false,
            commands,
            plan,
            device: device.clone(),
            surface: surface.clone(),
        };
        // SAFETY: the swapchain was just made on this device.
        let images = unsafe { presenting.swapchains.get_swapchain_images(raw) }
            .context("listing the images of", "the swapchain")?;
        for image in images {
            device.name(image, "swapchain");
            let copied = Semaphore::new(device, "copied")?;
            let released = presenting.has_fences.then(|| Fence::new(device, "released")).transpose()?;
            swapchain.slots.push(Slot { image, copied, released, is_pending: false });
        }
        Ok(Some(swapchain))
    }

    /// Width and height in pixels.
    pub fn extent(&self) -> (u32, u32) {
        (self.plan.extent.width, self.plan.extent.height)
    }

    /// The format of the pictures that it shows: the bytes on the screen are theirs.
    pub fn picture_format(&self) -> vk::Format {
        self.plan.picture_format
    }

    /// The way of presenting.
    pub fn mode(&self) -> PresentMode {
        self.plan.mode
    }

    /// Form that its surface has by now; where the window chooses the size, with the swapchain's own.
    ///
    /// # Errors
    /// Any error of Vulkan.
    pub fn surface_form(&self) -> Result<Form, Error> {
        let _alone = self.surface.lock();
        let (physical, surface) = (self.device.physical().raw, self.surface.raw);
        // SAFETY: surface and device are held, and belong to the same instance: there is no other swapchain by `new`.
        let capabilities = unsafe { self.surface.calls.get_physical_device_surface_capabilities(physical, surface) }
            .context("asking about the surface of", "the window")?;
        let extent = match capabilities.current_extent {
            vk::Extent2D { width: u32::MAX, height: u32::MAX } => self.plan.extent,
            current => current,
        };
        Ok(Form { extent, transform: capabilities.current_transform })
    }

    /// Shows a picture of the swapchain's extent and [format](Swapchain::picture_format), and waits until it is copied.
    ///
    /// # Errors
    /// [`Error::Pass`] for a picture of another format, of several layers, or not made to be copied from;
    /// [`Error::Foreign`]; [`Error::ReadBeforeWrite`]; [`Error::InUse`]; any error of Vulkan, as a lost device.
    pub fn present(&mut self, picture: &Arc<ImageView>) -> Result<Presented, Error> {
        if picture.image().desc().format != self.plan.picture_format {
            let problem = format!("{} is not of the swapchain's format", picture.image().name());
            return Err(Error::Pass { pass: "present".into(), problem });
        }
        if picture.layer_count() != 1 {
            let problem = format!("{} has {} layers; give one", picture.image().name(), picture.layer_count());
            return Err(Error::Pass { pass: "present".into(), problem });
        }
        if (picture.width(), picture.height()) != self.extent() || self.is_broken {
            return Ok(Presented::Stale);
        }
        let device = self.device.clone();
        let presenting = presenting(&device)?;
        // Whatever is wrong with the picture is found before an image is acquired, which could not be given back.
        let source = [Use { resource: picture.into(), access: Access::CopySource, discard: false }];
        transfer::check_uses(&device, "present", &source)?;
        self.commands.begin()?;
        self.commands.synchronise("present", &source).inspect_err(|_| self.commands.abandon())?;
        // SAFETY: the semaphore is unsignalled: the submission of the last acquired image has waited for it, or the
        // swapchain is broken and does not come here.
        let acquired = unsafe {
            presenting.swapchains.acquire_next_image(self.raw, PATIENCE_NS, self.acquired.raw, vk::Fence::null())
        };
        if acquired.is_err() {
            self.commands.abandon();
        }
        let (index, is_suboptimal) = match acquired {
            Ok(acquired) => acquired,
            Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => return Ok(Presented::Busy),
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => return Ok(Presented::Stale),
            Err(vk::Result::ERROR_SURFACE_LOST_KHR) => return Ok(Presented::SurfaceLost),
            Err(other) => return Err(Error::vulkan("acquiring an image of", "the swapchain", other)),
        };
        // Until the submission has waited for the semaphore, nothing else may be acquired with it.
        self.is_broken = true;
        self.copy(index as usize, picture)?;
        self.is_broken = false;
        let slot = &mut self.slots[index as usize];
        let (waits, swapchains, indices) = ([slot.copied.raw], [self.raw], [index]);
        let fences: Vec<vk::Fence> = slot.released.iter().map(|fence| fence.raw).collect();
        let mut released = vk::SwapchainPresentFenceInfoEXT::default().fences(&fences);
        let mut info =
            vk::PresentInfoKHR::default().wait_semaphores(&waits).swapchains(&swapchains).image_indices(&indices);
        if !fences.is_empty() {
            info = info.push_next(&mut released);
        }
        // SAFETY: the image was acquired, and is in the layout of presents by `copy`, which signals the semaphore; the fence
        // is unsignalled and not pending by `copy`; the queue is locked for the call.
        let presented = unsafe { presenting.swapchains.queue_present(*device.queue(), &info) };
        // What ran out of memory did nothing: the semaphore stays signalled, and the image acquired.
        let is_queued =
            !matches!(presented, Err(vk::Result::ERROR_OUT_OF_HOST_MEMORY | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY));
        self.is_broken = !is_queued;
        slot.is_pending = is_queued && slot.released.is_some();
        match presented {
            Ok(false) if !is_suboptimal => Ok(Presented::Shown),
            Ok(_) => Ok(Presented::Suboptimal),
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => Ok(Presented::Stale),
            Err(vk::Result::ERROR_SURFACE_LOST_KHR) => Ok(Presented::SurfaceLost),
            Err(other) => Err(Error::vulkan("presenting to", "the window", other)),
        }
    }

    /// Copies the picture, whose barrier is recorded, into the acquired image at `index`, and signals its semaphore.
    fn copy(&mut self, index: usize, picture: &Arc<ImageView>) -> Result<(), Error> {
        let slot = &mut self.slots[index];
        if let Some(fence) = slot.released.as_ref().filter(|_| slot.is_pending) {
            // Its present is over, or the image would not have been acquired again.
            fence.wait_and_reset().inspect_err(|_| self.commands.abandon())?;
            slot.is_pending = false;
        }
        let commands = &mut self.commands;
        let from = transfer::subresource(picture);
        let layers = vk::ImageSubresourceLayers::default().aspect_mask(vk::ImageAspectFlags::COLOR).layer_count(1);
        let extent = vk::Extent3D { width: picture.width(), height: picture.height(), depth: 1 };
        let region = vk::ImageCopy::default().src_subresource(from).dst_subresource(layers).extent(extent);
        let layout = Access::CopySource.info().layout;
        let written = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        let raw = &self.device.raw;
        // SAFETY: recording since `present`; the picture is in that layout by its barrier there, and kept until the
        // submission has finished; the image is the swapchain's own, acquired, of the picture's extent and of a format of as
        // many bytes.
        unsafe {
            barrier(raw, commands.buffer, slot.image, vk::ImageLayout::UNDEFINED, written);
            raw.cmd_copy_image(commands.buffer, picture.image().raw, layout, slot.image, written, &[region]);
            barrier(raw, commands.buffer, slot.image, written, vk::ImageLayout::PRESENT_SRC_KHR);
        }
        let semaphore = |raw, stages| vk::SemaphoreSubmitInfo::default().semaphore(raw).stage_mask(stages);
        let waits = [semaphore(self.acquired.raw, vk::PipelineStageFlags2::ALL_TRANSFER)];
        let signals = [semaphore(slot.copied.raw, vk::PipelineStageFlags2::ALL_COMMANDS)];
        // SAFETY: the acquisition signals the one semaphore; the other is unsignalled: the image's last present has waited
        // for it, or it would not have been acquired again.
        unsafe { commands.submit_between(&waits, &signals) }?;
        Ok(())
    }
}

/// Moves the image from one layout to another, writes of copies before it made visible.
///
/// # Safety
/// `commands` is recording outside a render pass, and the image is alive and in the layout `from`.
unsafe fn barrier(
    raw: &ash::Device,
    commands: vk::CommandBuffer,
    image: vk::Image,
    from: vk::ImageLayout,
    to: vk::ImageLayout,
) {
    let is_first = from == vk::ImageLayout::UNDEFINED;
    let (written, none) = (vk::AccessFlags2::TRANSFER_WRITE, vk::AccessFlags2::NONE);
    let range =
        vk::ImageSubresourceRange::default().aspect_mask(vk::ImageAspectFlags::COLOR).level_count(1).layer_count(1);
    let barriers = [vk::ImageMemoryBarrier2::default()
        // The acquisition's semaphore is waited for at this stage, so the first barrier follows it.
        .src_stage_mask(vk::PipelineStageFlags2::ALL_TRANSFER)
        .src_access_mask(if is_first { none } else { written })
        .dst_stage_mask(if is_first { vk::PipelineStageFlags2::ALL_TRANSFER } else { vk::PipelineStageFlags2::NONE })
        .dst_access_mask(if is_first { written } else { none })
        .old_layout(from)
        .new_layout(to)
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .image(image)
        .subresource_range(range)];
    let info = vk::DependencyInfo::default().image_memory_barriers(&barriers);
    // SAFETY: as the caller promises.
    unsafe { raw.cmd_pipeline_barrier2(commands, &info) };
}

/// The calls of swapchains of a device that was opened for them.
fn presenting(device: &Device) -> Result<&Presenting, Error> {
    device.presenting.as_ref().ok_or_else(|| Error::Unsupported {
        object: "the swapchain".into(),
        problem: "presenting: the device was opened without it".into(),
    })
}

impl Swapchain {
    /// True when nothing that was submitted uses it any more: the device is lost, or it is idle and every present that was
    /// given a fence has let go.
    fn is_over(&mut self) -> bool {
        if !self.commands.is_idle() {
            return false;
        }
        match self.device.raw_wait_idle() {
            Ok(()) => {}
            Err(vk::Result::ERROR_DEVICE_LOST) => return true,
            Err(_) => return false,
        }
        let pending = self.slots.iter().filter(|slot| slot.is_pending).filter_map(|slot| slot.released.as_ref());
        sync::are_over(&self.device, &pending.collect::<Vec<_>>())
    }

    /// Has every image wait for a present that never lets go.
    #[cfg(test)]
    pub(super) fn hold(&mut self) -> Result<(), Error> {
        for slot in &mut self.slots {
            (slot.released, slot.is_pending) = (Some(Fence::new(&self.device, "released")?), true);
        }
        Ok(())
    }
}

impl Drop for Swapchain {
    fn drop(&mut self) {
        if !self.is_over() {
            // A copy may still write an image, or a present use one. Leaked on purpose, and with it what must outlive it.
            self.acquired.leak();
            self.slots.iter_mut().for_each(Slot::leak);
            mem::forget(self.surface.clone());
            mem::forget(self.device.clone());
            return;
        }
        let mut current = self.surface.lock();
        if let Some(presenting) = &self.device.presenting {
            // SAFETY: by `is_over` no copy and no present with a fence uses it, and on a device without such fences all that was
            // submitted is done; the surface is locked for the call, and nothing else has the swapchain.
            unsafe { presenting.swapchains.destroy_swapchain(self.raw, None) };
        }
        // One that took over from this one has the surface already.
        if *current == self.raw {
            *current = vk::SwapchainKHR::null();
        }
        self.device.live().remove(Kind::Swapchain);
    }
}
