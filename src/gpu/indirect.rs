//! Parameters of indirect draws and dispatches, and values of indices, kept inside what is bound and what the device takes.

use std::sync::Arc;

use ash::vk;

use super::buffer::{Buffer, BufferDesc, BufferView};
use super::draw::Dispatch;
use super::error::Error;
use super::pass::{DrawBounds, Pass};
use super::pass_builder::{PassBuilder, PassDesc};
use super::shader::ShaderLibrary;

crate::host_block! {
    /// `common/clamp-draw.comp`
    struct DrawLimits {
        /// Indices in the bound buffer.
        index_count: u32,
        /// Instances in the bound buffer.
        instance_count: u32,
    }
}

crate::host_block! {
    /// `common/clamp-dispatch.comp`
    struct DispatchLimits {
        /// Workgroups that the device takes along x.
        x: u32,
        /// Along y.
        y: u32,
        /// Along z.
        z: u32,
    }
}

crate::host_block! {
    /// `common/clamp-indices.comp`
    struct IndexLimits {
        /// Indices in the bound buffer.
        index_count: u32,
        /// The largest that the device takes.
        largest: u32,
    }
}

enum Limits {
    Draw(DrawLimits),
    Dispatch(DispatchLimits),
    Indices(IndexLimits),
}

/// The kernel before a draw or a dispatch whose parameters or indices the host does not see, and Vulkan does not check.
pub(crate) struct Clamp {
    /// The kernel, bound to what it reads.
    pub pass: Pass,
    limits: Limits,
    /// A `VkDrawIndexedIndirectCommand`, a `VkDispatchIndirectCommand` or indices that may be used as they are.
    pub clamped: Arc<Buffer>,
}

impl Clamp {
    /// For the draws that `desc` describes; `None` where none is indirect.
    pub fn of_draw(shaders: &ShaderLibrary, desc: &PassDesc, bounds: DrawBounds) -> Result<Option<Self>, Error> {
        let at_most = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
        let limits =
            DrawLimits { index_count: at_most(bounds.indices.unwrap_or(0)), instance_count: at_most(bounds.instances) };
        let pass = Pass::compute(desc.name, desc.section, "common/clamp-draw.comp").constants::<DrawLimits>();
        let bytes = size_of::<vk::DrawIndexedIndirectCommand>();
        Self::of_parameters(shaders, desc, pass, Limits::Draw(limits), bytes)
    }

    /// For the dispatches that `desc` describes; `None` where none is indirect.
    pub fn of_dispatch(shaders: &ShaderLibrary, desc: &PassDesc) -> Result<Option<Self>, Error> {
        let [x, y, z] = shaders.device().physical().limits.max_compute_work_group_count;
        let pass = Pass::compute(desc.name, desc.section, "common/clamp-dispatch.comp").constants::<DispatchLimits>();
        let bytes = size_of::<vk::DispatchIndirectCommand>();
        Self::of_parameters(shaders, desc, pass, Limits::Dispatch(DispatchLimits { x, y, z }), bytes)
    }

    /// For the indices that `desc` names; `None` where it names none, or the device takes all 32-bit indices.
    pub fn of_indices(shaders: &ShaderLibrary, desc: &PassDesc) -> Result<Option<Self>, Error> {
        let physical = shaders.device().physical();
        let Some(indices) = desc.indices.as_ref().filter(|_| !physical.has_full_indices()) else { return Ok(None) };
        let index_count = u32::try_from(indices.len_bytes() / size_of::<u32>() as u64).unwrap_or(u32::MAX);
        let limits = Limits::Indices(IndexLimits { index_count, largest: physical.largest_index() });
        let pass = Pass::compute(desc.name, desc.section, "common/clamp-indices.comp").constants::<IndexLimits>();
        Self::of(shaders, pass, limits, indices, vk::BufferUsageFlags::INDEX_BUFFER, indices.len_bytes()).map(Some)
    }

    fn of_parameters(
        shaders: &ShaderLibrary,
        desc: &PassDesc,
        pass: PassBuilder,
        limits: Limits,
        bytes: usize,
    ) -> Result<Option<Self>, Error> {
        let Some(wanted) = &desc.indirect else { return Ok(None) };
        Self::of(shaders, pass, limits, wanted, vk::BufferUsageFlags::INDIRECT_BUFFER, bytes as u64).map(Some)
    }

    fn of(
        shaders: &ShaderLibrary,
        pass: PassBuilder,
        limits: Limits,
        wanted: &BufferView,
        usage: vk::BufferUsageFlags,
        bytes: u64,
    ) -> Result<Self, Error> {
        let usage = usage | vk::BufferUsageFlags::STORAGE_BUFFER;
        let clamped = Buffer::new(shaders.device(), BufferDesc::new(wanted.buffer.name(), bytes).usage(usage))?;
        let pass = pass.with("Wanted", wanted).with("Clamped", &clamped).build(shaders)?;
        Ok(Clamp { pass, limits, clamped })
    }

    /// The kernel's threads, its constants set.
    pub fn dispatch(&self, dispatch: &mut Dispatch<'_>) {
        match &self.limits {
            Limits::Draw(limits) => dispatch.constants(limits).threads(1, 1, 1),
            Limits::Dispatch(limits) => dispatch.constants(limits).threads(1, 1, 1),
            Limits::Indices(limits) => dispatch.constants(limits).elements(limits.index_count),
        };
    }
}
