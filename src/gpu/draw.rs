//! The commands that the body of a pass issues: draws inside its render pass, or dispatches. Each is checked against
//! what is bound and what the device allows before it is recorded; the first that does not fit ends the pass with an
//! error, and nothing after it is recorded.

use std::any::TypeId;

use ash::vk;
use bytemuck::Pod;

use super::device::Device;
use super::error::Error;
use super::pass::{Body, DrawBounds, DrawCounts, Inner, Workgroup};
use super::pass_builder::PassDesc;
use super::work::Fetched;

/// The common part of draws and dispatches: the pass, its constants, and the first command that was refused.
struct BodyCommands<'a> {
    device: &'a Device,
    raw: vk::CommandBuffer,
    inner: &'a Inner,
    has_constants: bool,
    calls: u32,
    refused: Option<Error>,
}

impl<'a> BodyCommands<'a> {
    fn new(device: &'a Device, raw: vk::CommandBuffer, inner: &'a Inner) -> Self {
        BodyCommands { device, raw, inner, has_constants: false, calls: 0, refused: None }
    }

    fn desc(&self) -> &'a PassDesc {
        &self.inner.desc
    }

    fn refuse(&mut self, problem: impl Into<String>) {
        let error = self.desc().problem(problem);
        self.refused.get_or_insert(error);
    }

    fn constants<T: Pod>(&mut self, constants: &T) {
        let Some(pipeline) = &self.inner.pipeline else { return };
        match self.desc().constants {
            Some(declared) if declared.id == TypeId::of::<T>() => {}
            Some(declared) => {
                let given = std::any::type_name::<T>();
                return self.refuse(format!("its constants are {}, and {given} is given", declared.name));
            }
            None => return self.refuse("it has no constants, and some are given"),
        }
        let program = &pipeline.program;
        let bytes = bytemuck::bytes_of(constants);
        // The host struct may carry its alignment's tail; the block's own size is what the layout declares.
        let bytes = &bytes[..bytes.len().min(program.push_bytes as usize)];
        // SAFETY: recording; `T` is the declared struct, which the build of the pass checked against the block of every
        // stage; the range was declared in the layout.
        unsafe { self.device.raw.cmd_push_constants(self.raw, program.layout, program.push_stages, 0, bytes) };
        self.has_constants = true;
    }

    /// True when the next command may be recorded, which then counts as a call.
    fn is_ready(&mut self) -> bool {
        if self.desc().constants.is_some() && !self.has_constants {
            self.refuse("its constants are not set before it draws or dispatches");
        }
        self.calls += u32::from(self.refused.is_none());
        self.refused.is_none()
    }

    fn finish(self) -> Result<u32, Error> {
        self.refused.map_or(Ok(self.calls), Err)
    }
}

/// The draws of one pass.
pub struct Draw<'a> {
    commands: BodyCommands<'a>,
    bounds: DrawBounds,
    fetched: Fetched,
}

impl<'a> Draw<'a> {
    pub(super) fn new(device: &'a Device, raw: vk::CommandBuffer, inner: &'a Inner, bounds: DrawBounds) -> Self {
        Draw { commands: BodyCommands::new(device, raw, inner), bounds, fetched: Fetched::default() }
    }

    /// The number of draws and what they fetched, or the first error.
    pub(super) fn finish(self) -> Result<(u32, Fetched), Error> {
        Ok((self.commands.finish()?, self.fetched))
    }

    /// Sets the push constants of the draws to come: the struct that the pass declares.
    pub fn constants<T: Pod>(&mut self, constants: &T) -> &mut Self {
        self.commands.constants(constants);
        self
    }

    /// Binds the pass's counting pipeline for the draws to come, or its own.
    pub fn counting(&mut self, counting: bool) -> &mut Self {
        let inner = self.commands.inner;
        let pipeline = if counting { &inner.counting } else { &inner.pipeline };
        let Some(pipeline) = pipeline else {
            self.commands.refuse("it has no counting pipeline");
            return self;
        };
        let point = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: inside the pass's render pass; both pipelines were made for one that is compatible with it, of one program.
        unsafe { self.commands.device.raw.cmd_bind_pipeline(self.commands.raw, point, pipeline.raw) };
        self
    }

    /// Draws `count` vertices from `first` on without indices.
    pub fn vertices_from(&mut self, first: u32, count: u32) {
        self.draw(first, count, 1);
    }

    /// Draws `count` vertices without indices.
    pub fn vertices(&mut self, count: u32) {
        self.draw(0, count, 1);
    }

    /// Draws `count` instances of `vertices` vertices each, without indices.
    pub fn instances(&mut self, vertices: u32, count: u32) {
        self.draw(0, vertices, count);
    }

    fn draw(&mut self, first: u32, vertices: u32, instances: u32) {
        let end = u64::from(first) + u64::from(vertices);
        if self.is_ready(first, DrawCounts { vertices: end, instances: instances.into(), indices: 0 }) {
            let BodyCommands { device, raw, .. } = self.commands;
            // SAFETY: inside the pass's render pass, with pipeline, set and buffers bound and the constants set; vertices
            // and instances lie inside what is bound.
            unsafe { device.raw.cmd_draw(raw, vertices, instances, first, 0) };
        }
    }

    /// Draws `count` indices.
    pub fn indices(&mut self, count: u32) {
        self.indices_from(0, count);
    }

    /// Draws `count` indices from `first` on.
    pub fn indices_from(&mut self, first: u32, count: u32) {
        self.draw_indexed(first, count, 1);
    }

    /// Draws `count` instances of the first `indices` indices.
    pub fn indexed_instances(&mut self, indices: u32, count: u32) {
        self.draw_indexed(0, indices, count);
    }

    fn draw_indexed(&mut self, first: u32, indices: u32, instances: u32) {
        let end = u64::from(first) + u64::from(indices);
        // Vertices that indices name beyond the buffer are not fetched: robust buffer access is on.
        if self.is_ready(first, DrawCounts { vertices: 0, instances: instances.into(), indices: end }) {
            let BodyCommands { device, raw, .. } = self.commands;
            // SAFETY: as for `draw`; the indices lie inside the bound buffer.
            unsafe { device.raw.cmd_draw_indexed(raw, indices, instances, first, 0, 0) };
        }
    }

    /// Confines the draws to come to a rectangle of the attachments, in texels from the top left corner; what of it lies
    /// outside them is cut off.
    pub fn scissor(&mut self, (x, y): (u32, u32), (width, height): (u32, u32)) -> &mut Self {
        let Body::Graphics { extent, .. } = &self.commands.inner.body else { return self };
        let (x, y) = (x.min(extent.width), y.min(extent.height));
        let area = vk::Rect2D {
            offset: vk::Offset2D { x: x as i32, y: y as i32 },
            extent: vk::Extent2D { width: width.min(extent.width - x), height: height.min(extent.height - y) },
        };
        // SAFETY: inside the pass's render pass; the rectangle lies inside its extent, whose sides fit an `i32` by the
        // device's limits, and every pipeline of this layer has the scissor as its dynamic state.
        unsafe { self.commands.device.raw.cmd_set_scissor(self.commands.raw, 0, &[area]) };
        self
    }

    /// Draws what the pass's [indirect](super::pass::PassBuilder::indirect) buffer says.
    pub fn indices_indirect(&mut self) {
        let Body::Graphics { indirect: Some(clamp), .. } = &self.commands.inner.body else {
            self.commands.refuse("it has no indirect buffer");
            return;
        };
        self.fetched.is_indirect = true;
        if self.is_ready(0, DrawCounts { vertices: 0, instances: 1, indices: 0 }) {
            let stride = size_of::<vk::DrawIndexedIndirectCommand>() as u32;
            let BodyCommands { device, raw, .. } = self.commands;
            // SAFETY: as for `draw`; the buffer holds one command, which the kernel before the pass has kept inside what
            // is bound and which the pass's barrier made visible.
            unsafe { device.raw.cmd_draw_indexed_indirect(raw, clamp.clamped.raw, 0, 1, stride) };
        }
    }

    /// True when a draw from element `first` up to `counts` may be recorded.
    fn is_ready(&mut self, first: u32, counts: DrawCounts) -> bool {
        if let Some(problem) = self.bounds.problem(counts) {
            self.commands.refuse(problem);
        }
        let fetched = &mut self.fetched;
        let first = u64::from(first);
        fetched.vertices = fetched.vertices.max(counts.vertices.saturating_sub(first));
        fetched.instances = fetched.instances.max(counts.instances);
        fetched.indices = fetched.indices.max(counts.indices.saturating_sub(first));
        fetched.is_partial |= first > 0;
        self.commands.is_ready()
    }
}

/// The dispatches of one pass.
pub struct Dispatch<'a> {
    commands: BodyCommands<'a>,
    workgroup: Workgroup,
}

impl<'a> Dispatch<'a> {
    pub(super) fn new(device: &'a Device, raw: vk::CommandBuffer, inner: &'a Inner, workgroup: Workgroup) -> Self {
        Dispatch { commands: BodyCommands::new(device, raw, inner), workgroup }
    }

    /// The number of dispatches, or the first error.
    pub(super) fn finish(self) -> Result<u32, Error> {
        self.commands.finish()
    }

    /// Sets the push constants of the dispatches to come: the struct that the pass declares.
    pub fn constants<T: Pod>(&mut self, constants: &T) -> &mut Self {
        self.commands.constants(constants);
        self
    }

    /// Dispatches at least `count` threads, in as many rows of workgroups as the device asks for: the shader numbers them by
    /// `common/elements.glsl`. One that does not is held to a single row.
    pub fn elements(&mut self, count: u32) {
        self.layers_of_elements(count, 1);
    }

    /// As [`Dispatch::elements`], so many times along z.
    pub fn layers_of_elements(&mut self, count: u32, layers: u32) {
        let [along_x, along_y, along_z] = self.workgroup.size;
        let [most, ..] = self.commands.device.physical().limits.max_compute_work_group_count;
        let groups = count.div_ceil(along_x);
        let rows = if self.workgroup.lies_in_rows { groups.div_ceil(most).max(1) } else { 1 };
        let [x, y, z] =
            [(groups.div_ceil(rows), along_x), (rows, along_y), (layers, along_z)].map(|(n, by)| n.saturating_mul(by));
        self.threads(x, y, z);
    }

    /// Dispatches at least `x` x `y` x `z` threads, in whole workgroups.
    pub fn threads(&mut self, x: u32, y: u32, z: u32) {
        let [a, b, c] = self.workgroup.size;
        let groups = [x.div_ceil(a), y.div_ceil(b), z.div_ceil(c)];
        let limits = self.commands.device.physical().limits.max_compute_work_group_count;
        if let Some((&wanted, limit)) = groups.iter().zip(limits).find(|&(&wanted, limit)| wanted > limit) {
            let object = format!("pass {}", self.commands.desc().name);
            let what = "count of workgroups along one axis";
            let error = Error::Limit { object, what, wanted: wanted.into(), limit: limit.into() };
            self.commands.refused.get_or_insert(error);
        }
        if self.commands.is_ready() {
            let BodyCommands { device, raw, .. } = self.commands;
            // SAFETY: recording outside a render pass, with pipeline and set bound and the constants set; the device takes
            // so many workgroups.
            unsafe { device.raw.cmd_dispatch(raw, groups[0], groups[1], groups[2]) };
        }
    }

    /// Dispatches as many workgroups as the pass's [indirect](super::pass::PassBuilder::indirect) buffer says.
    pub fn groups_indirect(&mut self) {
        let Some(clamp) = self.commands.inner.body.parameters() else {
            self.commands.refuse("it has no indirect buffer");
            return;
        };
        if self.commands.is_ready() {
            let BodyCommands { device, raw, .. } = self.commands;
            // SAFETY: as for `threads`; the buffer holds one command, which the kernel before the pass has kept within the
            // device's limits and which the pass's barrier made visible.
            unsafe { device.raw.cmd_dispatch_indirect(raw, clamp.clamped.raw, 0) };
        }
    }
}
