//! The barriers before a pass, derived from its uses and from the state of each piece of each resource.

use ash::vk;

use super::access::{AccessInfo, derive};
use super::bindings::{Resource, Use};
use super::device::Device;
use super::error::Error;
use super::image::subresource_range;

/// Reused lists of barriers, so that a frame allocates none.
#[derive(Default)]
pub(crate) struct Barriers {
    images: Vec<vk::ImageMemoryBarrier2<'static>>,
    buffers: Vec<vk::BufferMemoryBarrier2<'static>>,
}

impl Barriers {
    /// Derives the barriers of `uses` and moves the states on.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] for a read of what no pass, upload or clear has written.
    pub fn collect(&mut self, pass: &str, uses: &[Use]) -> Result<(), Error> {
        self.images.clear();
        self.buffers.clear();
        for one in uses {
            let info = one.access.info();
            let unwritten = match &one.resource {
                Resource::Buffer(_) => self.buffer(one, info),
                Resource::Image(_) => self.image(one, info),
                Resource::Sampler(_) => false,
            };
            if unwritten {
                return Err(Error::ReadBeforeWrite { pass: pass.to_owned(), resource: one.resource.name().to_owned() });
            }
        }
        Ok(())
    }

    fn buffer(&mut self, one: &Use, info: AccessInfo) -> bool {
        let Resource::Buffer(view) = &one.resource else { return false };
        let mut unwritten = false;
        let mut needed: Option<vk::BufferMemoryBarrier2<'static>> = None;
        view.buffer.with_states(view.range.clone(), |state| {
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
        });
        self.buffers.extend(needed);
        unwritten
    }

    fn image(&mut self, one: &Use, info: AccessInfo) -> bool {
        let Resource::Image(view) = &one.resource else { return false };
        let image = &view.image;
        image.with_states(view.layers.clone(), |states| {
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
        })
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
