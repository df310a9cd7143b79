//! Semaphores and fences of presents.

use std::sync::Arc;

use ash::vk;

use super::super::device::Device;
use super::super::error::{Context, Error};
use super::super::live::Kind;

/// Nanoseconds after which a present that ought to be over is given up.
const PATIENCE_NS: u64 = 1_000_000_000;

/// A binary semaphore.
pub(super) struct Semaphore {
    /// The handle; null once it is leaked.
    pub raw: vk::Semaphore,
    device: Arc<Device>,
}

impl Semaphore {
    pub fn new(device: &Arc<Device>, name: &str) -> Result<Self, Error> {
        // SAFETY: the device is alive.
        let raw = unsafe { device.raw.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) }
            .context("creating semaphore", name)?;
        device.live().add(Kind::Semaphore);
        device.name(raw, name);
        Ok(Semaphore { raw, device: device.clone() })
    }

    /// Keeps it from being destroyed.
    pub fn leak(&mut self) {
        self.raw = vk::Semaphore::null();
    }
}

impl Drop for Semaphore {
    fn drop(&mut self) {
        // SAFETY: the swapchain drops its semaphores after its wait for the device; a null handle is ignored.
        unsafe { self.device.raw.destroy_semaphore(self.raw, None) };
        if self.raw != vk::Semaphore::null() {
            self.device.live().remove(Kind::Semaphore);
        }
    }
}

/// A fence that a present signals.
pub(super) struct Fence {
    /// The handle; null once it is leaked.
    pub raw: vk::Fence,
    device: Arc<Device>,
}

impl Fence {
    pub fn new(device: &Arc<Device>, name: &str) -> Result<Self, Error> {
        // SAFETY: the device is alive.
        let raw = unsafe { device.raw.create_fence(&vk::FenceCreateInfo::default(), None) }
            .context("creating fence", name)?;
        device.live().add(Kind::Fence);
        device.name(raw, name);
        Ok(Fence { raw, device: device.clone() })
    }

    /// Waits for the present that was given it.
    pub fn wait_and_reset(&self) -> Result<(), Error> {
        let raw = &self.device.raw;
        // SAFETY: the fence is alive, and by its caller given to a present; it is not pending once it is signalled.
        unsafe {
            raw.wait_for_fences(&[self.raw], true, PATIENCE_NS).context("waiting for", "a present")?;
            raw.reset_fences(&[self.raw]).context("resetting", "a fence of a present")
        }
    }

    /// Keeps it from being destroyed.
    pub fn leak(&mut self) {
        self.raw = vk::Fence::null();
    }
}

/// Waits for the presents that were given these fences of the device, for all together as long as for one. True when each is
/// over, or the device is lost and does nothing any more.
pub(super) fn are_over(device: &Device, fences: &[&Fence]) -> bool {
    if fences.is_empty() {
        return true;
    }
    let raw: Vec<vk::Fence> = fences.iter().map(|fence| fence.raw).collect();
    // SAFETY: there is one at least; they are borrowed, and so alive; their swapchain made them on this device, and leaks none
    // before it has waited.
    let waited = unsafe { device.raw.wait_for_fences(&raw, true, PATIENCE_NS) };
    matches!(waited, Ok(()) | Err(vk::Result::ERROR_DEVICE_LOST))
}

impl Drop for Fence {
    fn drop(&mut self) {
        // SAFETY: the swapchain waits for the present that was given it before it drops, or leaks it; a null handle is
        // ignored.
        unsafe { self.device.raw.destroy_fence(self.raw, None) };
        if self.raw != vk::Fence::null() {
            self.device.live().remove(Kind::Fence);
        }
    }
}
