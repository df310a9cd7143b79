//! The commands that the body of a pass issues: draws inside its render pass, or dispatches.

use ash::vk;
use bytemuck::Pod;

use super::device::Device;
use super::pass::{Body, Inner};

/// The draws of one pass.
pub struct Draw<'a> {
    pub(super) device: &'a Device,
    pub(super) commands: vk::CommandBuffer,
    pub(super) inner: &'a Inner,
    pub(super) calls: u32,
}

impl Draw<'_> {
    /// Sets the push constants of the draws to come.
    pub fn constants<T: Pod>(&mut self, constants: &T) -> &mut Self {
        push(self.device, self.commands, self.inner, bytemuck::bytes_of(constants));
        self
    }

    /// Binds the pass's counting pipeline for the draws to come, or its own.
    pub fn counting(&mut self, counting: bool) -> &mut Self {
        let pipeline = if counting { &self.inner.counting } else { &self.inner.pipeline };
        if let Some(pipeline) = pipeline {
            let point = vk::PipelineBindPoint::GRAPHICS;
            // SAFETY: inside the pass's render pass; both pipelines were made for it and share one layout.
            unsafe { self.device.raw.cmd_bind_pipeline(self.commands, point, pipeline.raw) };
        }
        self
    }

    /// Draws `count` vertices from `first` on without indices.
    pub fn vertices_from(&mut self, first: u32, count: u32) -> &mut Self {
        self.calls += 1;
        // SAFETY: as for [`Draw::vertices`].
        unsafe { self.device.raw.cmd_draw(self.commands, count, 1, first, 0) };
        self
    }

    /// Draws `count` vertices without indices.
    pub fn vertices(&mut self, count: u32) -> &mut Self {
        self.calls += 1;
        // SAFETY: inside the pass's render pass, with its pipeline and buffers bound.
        unsafe { self.device.raw.cmd_draw(self.commands, count, 1, 0, 0) };
        self
    }

    /// Draws `count` instances of `vertices` vertices each, without indices.
    pub fn instances(&mut self, vertices: u32, count: u32) -> &mut Self {
        self.calls += 1;
        // SAFETY: as for [`Draw::vertices`].
        unsafe { self.device.raw.cmd_draw(self.commands, vertices, count, 0, 0) };
        self
    }

    /// Draws `count` indices.
    pub fn indices(&mut self, count: u32) -> &mut Self {
        self.calls += 1;
        // SAFETY: as above; the index buffer was checked when it was filled.
        unsafe { self.device.raw.cmd_draw_indexed(self.commands, count, 1, 0, 0, 0) };
        self
    }

    /// Draws what the pass's [indirect](super::pass::PassBuilder::indirect) buffer says; nothing without one.
    pub fn indices_indirect(&mut self) -> &mut Self {
        let Body::Graphics { indirect: Some(view), .. } = &self.inner.body else { return self };
        self.calls += 1;
        let stride = size_of::<vk::DrawIndexedIndirectCommand>() as u32;
        // SAFETY: as above; the build of the pass checked that the buffer holds one command and may be used so, and its
        // barrier made the command visible.
        unsafe {
            self.device.raw.cmd_draw_indexed_indirect(self.commands, view.buffer.raw, view.range.start, 1, stride)
        };
        self
    }
}

/// The dispatches of one pass.
pub struct Dispatch<'a> {
    pub(super) device: &'a Device,
    pub(super) commands: vk::CommandBuffer,
    pub(super) inner: &'a Inner,
    pub(super) local_size: [u32; 3],
    pub(super) calls: u32,
}

impl Dispatch<'_> {
    /// Sets the push constants of the dispatches to come.
    pub fn constants<T: Pod>(&mut self, constants: &T) -> &mut Self {
        push(self.device, self.commands, self.inner, bytemuck::bytes_of(constants));
        self
    }

    /// Dispatches at least `x` x `y` x `z` threads, in whole workgroups.
    pub fn threads(&mut self, x: u32, y: u32, z: u32) -> &mut Self {
        self.calls += 1;
        let [a, b, c] = self.local_size;
        // SAFETY: recording outside a render pass with the pass's pipeline bound.
        unsafe { self.device.raw.cmd_dispatch(self.commands, x.div_ceil(a), y.div_ceil(b), z.div_ceil(c)) };
        self
    }
}

fn push(device: &Device, commands: vk::CommandBuffer, inner: &Inner, bytes: &[u8]) {
    let Some(pipeline) = &inner.pipeline else { return };
    let program = &pipeline.program;
    // The host struct may carry its alignment's tail; the block's own size is what the layout declares.
    let bytes = &bytes[..bytes.len().min(program.push_bytes as usize)];
    // SAFETY: the build of the pass checked the struct against the block; the range was declared in the layout.
    unsafe { device.raw.cmd_push_constants(commands, program.layout, program.push_stages, 0, bytes) };
}
