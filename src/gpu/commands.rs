//! One command buffer with its fence: begun, submitted, waited for.

use std::sync::Arc;

use ash::vk;

use super::device::Device;
use super::error::{Context, Error};
use super::live::Kind;

/// A command pool of one buffer.
pub(crate) struct Commands {
    pub device: Arc<Device>,
    pool: vk::CommandPool,
    pub buffer: vk::CommandBuffer,
    fence: vk::Fence,
}

impl Commands {
    pub fn new(device: &Arc<Device>, name: &str) -> Result<Self, Error> {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.queue_family);
        // SAFETY: the device is alive.
        let pool = unsafe { device.raw.create_command_pool(&info, None) }.context("creating command pool", name)?;
        device.live().add(Kind::CommandPool);
        let mut commands =
            Commands { device: device.clone(), pool, buffer: vk::CommandBuffer::null(), fence: vk::Fence::null() };
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(1);
        // SAFETY: the pool is alive.
        let buffers =
            unsafe { device.raw.allocate_command_buffers(&info) }.context("allocating command buffer", name)?;
        commands.buffer = buffers[0];
        device.name(commands.buffer, name);
        // SAFETY: the device is alive.
        commands.fence = unsafe { device.raw.create_fence(&vk::FenceCreateInfo::default(), None) }
            .context("creating fence", name)?;
        device.live().add(Kind::Fence);
        Ok(commands)
    }

    /// Throws away what was recorded and begins anew; nothing is in flight.
    pub fn begin(&mut self) -> Result<(), Error> {
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: `submit_and_wait` waits, so the pool's one buffer is never pending here.
        unsafe {
            self.device
                .raw
                .reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .context("resetting", "a command pool")?;
            self.device.raw.begin_command_buffer(self.buffer, &info).context("beginning", "a command buffer")
        }
    }

    /// Ends recording, submits and returns once the device has finished.
    pub fn submit_and_wait(&mut self) -> Result<(), Error> {
        let raw = &self.device.raw;
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(self.buffer)];
        let submits = [vk::SubmitInfo2::default().command_buffer_infos(&buffers)];
        // SAFETY: the buffer is recording; the queue is used by one recorder at a time; the fence is unsignalled.
        unsafe {
            raw.end_command_buffer(self.buffer).context("ending", "a command buffer")?;
            raw.queue_submit2(self.device.queue, &submits, self.fence).context("submitting", "a command buffer")?;
            raw.wait_for_fences(&[self.fence], true, u64::MAX).context("waiting for", "a submission")?;
            raw.reset_fences(&[self.fence]).context("resetting", "a fence")
        }
    }
}

impl Drop for Commands {
    fn drop(&mut self) {
        // SAFETY: every submission was waited for, or the device is lost and executes nothing any more.
        unsafe {
            if self.fence != vk::Fence::null() {
                self.device.raw.destroy_fence(self.fence, None);
                self.device.live().remove(Kind::Fence);
            }
            self.device.raw.destroy_command_pool(self.pool, None);
        }
        self.device.live().remove(Kind::CommandPool);
    }
}
