//! The barriers before a pass, derived from its uses and from the state of each piece of each resource.

use ash::vk;

use std::sync::Arc;

use super::access::{AccessInfo, derive};
use super::bindings::{Resource, Use};
use super::device::Device;
use super::error::Error;
use super::image::subresource_range;
use super::tracked::{Held, InUse, SubmissionId};

/// Reused lists of barriers, so that a frame allocates none.
#[derive(Default)]
pub(crate) struct Barriers {
    images: Vec<vk::ImageMemoryBarrier2<'static>>,
    buffers: Vec<vk::BufferMemoryBarrier2<'static>>,
}

impl Barriers {
    /// Derives the barriers of `uses` and moves the states on, as `submission` sees them; what it touches for the first
    /// time joins `held`.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] for a read of what no pass, upload or clear has written; [`Error::InUse`] for a resource
    /// of another unfinished submission; [`Error::Foreign`] for one of another device.
    pub fn collect(
        &mut self,
        device: &Arc<Device>,
        submission: SubmissionId,
        pass: &str,
        uses: &[Use],
        held: &mut Vec<Held>,
    ) -> Result<(), Error> {
        self.images.clear();
        self.buffers.clear();
        for one in uses {
            one.resource.check_device(device, pass)?;
            let info = one.access.info();
            let visited = match &one.resource {
                Resource::Buffer(_) => self.buffer(submission, one, info, held),
                Resource::Image(_) => self.image(submission, one, info, held),
                Resource::Sampler(_) => Ok(false),
            };
            let names = || (pass.to_owned(), one.resource.name().to_owned());
            match visited {
                Ok(false) => {}
                Ok(true) => {
                    let (pass, resource) = names();
                    return Err(Error::ReadBeforeWrite { pass, resource });
                }
                Err(InUse) => {
                    let (pass, resource) = names();
                    return Err(Error::InUse { pass, resource });
                }
            }
        }
        Ok(())
    }

    /// True for a read of what was not written.
    fn buffer(
        &mut self,
        submission: SubmissionId,
        one: &Use,
        info: AccessInfo,
        held: &mut Vec<Held>,
    ) -> Result<bool, InUse> {
        let Resource::Buffer(view) = &one.resource else { return Ok(false) };
        let mut unwritten = false;
        let mut needed: Option<vk::BufferMemoryBarrier2<'static>> = None;
        let is_first = view.buffer.with_states(submission, view.range.clone(), |state| {
            unwritten |= !info.writes && !state.is_written();
            let (barrier, after) = derive(state, info, one.discard, false);
            *state = after;
            if let Some(b) = barrier {
                let merged = needed.get_or_insert_with(|| {
                    vk::BufferMemoryBarrier2::default()
                        .buffer(view.buffer.raw)
                        .offset(view.range.start)
                        .size(view.range.end - view.range.start)
                        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                });
                merged.src_stage_mask |= b.src_stages;
                merged.src_access_mask |= b.src_access;
                merged.dst_stage_mask |= b.dst_stages;
                merged.dst_access_mask |= b.dst_access;
            }
        })?;
        if is_first {
            held.push(Held::Buffer(view.buffer.clone()));
        }
        self.buffers.extend(needed);
        Ok(unwritten)
    }

    /// True for a read of what was not written.
    fn image(
        &mut self,
        submission: SubmissionId,
        one: &Use,
        info: AccessInfo,
        held: &mut Vec<Held>,
    ) -> Result<bool, InUse> {
        let Resource::Image(view) = &one.resource else { return Ok(false) };
        let image = &view.image;
        let (unwritten, is_first) = image.with_states(submission, view.layers.clone(), |states| {
            let mut unwritten = false;
            for (layer, state) in (view.layers.start..).zip(states.iter_mut()) {
                // An attachment that keeps its old contents reads them.
                unwritten |= !state.is_written() && !one.discard && reads(info);
                let (barrier, after) = derive(state, info, one.discard, true);
                *state = after;
                let Some(b) = barrier else { continue };
                let barrier = vk::ImageMemoryBarrier2::default()
                    .src_stage_mask(b.src_stages)
                    .src_access_mask(b.src_access)
                    .dst_stage_mask(b.dst_stages)
                    .dst_access_mask(b.dst_access)
                    .old_layout(b.old_layout)
                    .new_layout(b.new_layout)
                    .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                    .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                    .image(image.raw)
                    .subresource_range(subresource_range(image.aspect(), &(layer..layer + 1)));
                self.push_image(barrier);
            }
            unwritten
        })?;
        if is_first {
            held.push(Held::Image(image.clone()));
        }
        Ok(unwritten)
    }

    /// Joins the barrier of the next layer to its neighbour's when they say the same.
    fn push_image(&mut self, barrier: vk::ImageMemoryBarrier2<'static>) {
        if let Some(last) = self.images.last_mut() {
            let range = &mut last.subresource_range;
            let same = last.image == barrier.image
                && last.src_stage_mask == barrier.src_stage_mask
                && last.src_access_mask == barrier.src_access_mask
                && last.dst_stage_mask == barrier.dst_stage_mask
                && last.dst_access_mask == barrier.dst_access_mask
                && last.old_layout == barrier.old_layout
                && last.new_layout == barrier.new_layout;
            if same && range.base_array_layer + range.layer_count == barrier.subresource_range.base_array_layer {
                range.layer_count += 1;
                return;
            }
        }
        self.images.push(barrier);
    }

    /// Records what was collected.
    pub fn record(&self, device: &Device, commands: vk::CommandBuffer) {
        if self.images.is_empty() && self.buffers.is_empty() {
            return;
        }
        let info =
            vk::DependencyInfo::default().image_memory_barriers(&self.images).buffer_memory_barriers(&self.buffers);
        // SAFETY: the command buffer is recording outside a render pass; the resources are kept by the frame.
        unsafe { device.raw.cmd_pipeline_barrier2(commands, &info) };
    }
}

/// True when an access needs the old contents: everything but a pure copy into the resource or a storage write, which
/// may be the first.
fn reads(info: AccessInfo) -> bool {
    let writes_alone = vk::AccessFlags2::TRANSFER_WRITE | vk::AccessFlags2::SHADER_STORAGE_WRITE;
    !info.access.intersects(writes_alone)
}

/// A barrier between everything before and everything after.
pub(crate) fn full(device: &Device, commands: vk::CommandBuffer) {
    let all = [vk::MemoryBarrier2::default()
        .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
        .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
        .dst_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
        .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)];
    let info = vk::DependencyInfo::default().memory_barriers(&all);
    // SAFETY: the command buffer is recording outside a render pass.
    unsafe { device.raw.cmd_pipeline_barrier2(commands, &info) };
}
