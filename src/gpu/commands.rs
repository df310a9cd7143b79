//! One command buffer with its fence: begun, submitted, waited for; and all that the device reads of it until then.

use std::mem;
use std::sync::Arc;
use std::time::Instant;

use ash::vk;

use super::barrier::Barriers;
use super::bindings::Use;
use super::device::Device;
use super::error::{Context, Error};
use super::extensions::Extension;
use super::live::Kind;
use super::pass::Pass;
use super::tracked::{Held, SubmissionId};

/// The life of what is recorded into the one command buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Nothing is recorded that will be submitted, and nothing executes.
    Idle,
    Recording,
    /// Submitted, and not known to have finished.
    InFlight,
}

/// A command pool of one buffer.
pub(crate) struct Commands {
    /// The device that it records for.
    pub device: Arc<Device>,
    pool: vk::CommandPool,
    /// The buffer that is recorded into.
    pub buffer: vk::CommandBuffer,
    fence: vk::Fence,
    /// The submission that it will be part of.
    pub submission: SubmissionId,
    /// Number of the frame that the next submission is the last of.
    pub ends_frame: Option<u64>,
    /// Number of the replay for the performance query that the next submission holds.
    pub counter_pass: Option<u32>,
    phase: Phase,
    barriers: Barriers,
    held: Vec<Held>,
    passes: Vec<Pass>,
}

impl Commands {
    pub fn new(device: &Arc<Device>, name: &str) -> Result<Self, Error> {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.queue_family);
        // SAFETY: the device is alive.
        let pool = unsafe { device.raw.create_command_pool(&info, None) }.context("creating command pool", name)?;
        device.live().add(Kind::CommandPool);
        let mut commands = Commands {
            device: device.clone(),
            pool,
            buffer: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            submission: SubmissionId::new(),
            ends_frame: None,
            counter_pass: None,
            phase: Phase::Idle,
            barriers: Barriers::default(),
            held: Vec::new(),
            passes: Vec::new(),
        };
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(1);
        // SAFETY: the pool is alive, and nobody else has it.
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

    /// Throws away what was recorded and not submitted, and begins anew.
    ///
    /// # Errors
    /// Any error of Vulkan, also where an earlier submission is still not known to have finished.
    pub fn begin(&mut self) -> Result<(), Error> {
        if self.phase == Phase::InFlight {
            self.settle().context("waiting for", "an earlier submission")?;
        }
        self.abandon();
        self.counter_pass = None;
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: nothing is in flight by `phase`, so neither the pool's one buffer nor the fence is pending; `&mut self`
        // is the only user of both.
        unsafe {
            let raw = &self.device.raw;
            raw.reset_fences(&[self.fence]).context("resetting", "a fence")?;
            raw.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .context("resetting", "a command pool")?;
            raw.begin_command_buffer(self.buffer, &info).context("beginning", "a command buffer")?;
        }
        self.submission = SubmissionId::new();
        self.phase = Phase::Recording;
        Ok(())
    }

    /// Takes hold of what `uses` touch and records the barriers before it, outside a render pass.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`], [`Error::InUse`], [`Error::Foreign`]; what was recorded cannot be submitted then.
    pub fn synchronise(&mut self, pass: &str, uses: &[Use]) -> Result<(), Error> {
        let Commands { device, barriers, held, submission, .. } = self;
        barriers.collect(device, *submission, pass, uses, held)?;
        barriers.record(device, self.buffer);
        Ok(())
    }

    /// Keeps a pass alive until the submission has finished.
    pub fn keep(&mut self, pass: &Pass) {
        self.passes.push(pass.clone());
    }

    /// Ends recording, submits and returns the moment when the device has finished. Only then do the tracked states
    /// become what the submission left.
    ///
    /// # Errors
    /// Any error of Vulkan. After a failed wait the resources stay held and alive until the device is known to be idle.
    pub fn submit_and_wait(&mut self) -> Result<Instant, Error> {
        // SAFETY: no semaphore is named.
        unsafe { self.submit_between(&[], &[]) }
    }

    /// As [`Commands::submit_and_wait`], after the semaphores of `waits` and before those of `signals`.
    ///
    /// # Errors
    /// Those of [`Commands::submit_and_wait`].
    ///
    /// # Safety
    /// The semaphores are alive until this returns; something that was submitted signals those of `waits`; those of
    /// `signals` are unsignalled, and nothing waits for them.
    pub unsafe fn submit_between(
        &mut self,
        waits: &[vk::SemaphoreSubmitInfo<'_>],
        signals: &[vk::SemaphoreSubmitInfo<'_>],
    ) -> Result<Instant, Error> {
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(self.buffer)];
        let mut boundary = vk::FrameBoundaryEXT::default().flags(vk::FrameBoundaryFlagsEXT::FRAME_END);
        let mut submit = vk::SubmitInfo2::default()
            .wait_semaphore_infos(waits)
            .command_buffer_infos(&buffers)
            .signal_semaphore_infos(signals);
        if let Some(frame) = self.ends_frame.take()
            && self.device.physical().has_extension(Extension::FrameBoundary)
        {
            boundary.frame_id = frame;
            submit = submit.push_next(&mut boundary);
        }
        let mut counted = vk::PerformanceQuerySubmitInfoKHR::default();
        if let Some(replay) = self.counter_pass.take() {
            counted.counter_pass_index = replay;
            submit = submit.push_next(&mut counted);
        }
        let submits = [submit];
        let raw = &self.device.raw;
        // SAFETY: the buffer is recording: every caller has begun it; nobody else has it.
        unsafe { raw.end_command_buffer(self.buffer) }.context("ending", "a command buffer")?;
        // SAFETY: the queue is locked for the call; the fence is unsignalled since `begin` and not pending; the caller
        // answers for the semaphores.
        unsafe { raw.queue_submit2(*self.device.queue(), &submits, self.fence) }
            .context("submitting", "a command buffer")?;
        self.phase = Phase::InFlight;
        // SAFETY: the fence is alive and was submitted.
        if let Err(result) = unsafe { self.device.raw.wait_for_fences(&[self.fence], true, u64::MAX) } {
            // The wait's own error is the one to report; until the device is idle everything stays as it is.
            let _ = self.settle();
            return Err(Error::vulkan("waiting for", "a submission", result));
        }
        let finished = Instant::now();
        self.release(true);
        Ok(finished)
    }

    /// Gives up what was recorded and not submitted: the tracked states are as they were before it.
    pub fn abandon(&mut self) {
        if self.phase != Phase::InFlight {
            self.release(false);
        }
    }

    /// True when nothing executes that was submitted here. Asks the device where a wait has failed before.
    pub fn is_idle(&mut self) -> bool {
        self.phase != Phase::InFlight || self.settle().is_ok()
    }

    /// After a failed wait: lets go when the device is idle, or lost, and executes nothing any more.
    fn settle(&mut self) -> Result<(), vk::Result> {
        match self.device.raw_wait_idle() {
            Ok(()) => self.release(true),
            Err(vk::Result::ERROR_DEVICE_LOST) => self.release(false),
            Err(other) => return Err(other),
        }
        Ok(())
    }

    fn release(&mut self, commit: bool) {
        self.phase = Phase::Idle;
        for held in self.held.drain(..) {
            held.release(self.submission, commit);
        }
        self.passes.clear();
    }
}

impl Drop for Commands {
    fn drop(&mut self) {
        if !self.is_idle() {
            // The device may still read all of it. Leaked on purpose, and the device with it.
            mem::forget(mem::take(&mut self.held));
            mem::forget(mem::take(&mut self.passes));
            mem::forget(self.device.clone());
            return;
        }
        self.abandon();
        // SAFETY: nothing is in flight: see above.
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
