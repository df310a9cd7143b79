//! Parameters of indirect draws and dispatches, kept inside what is bound and what the device takes.

use std::sync::Arc;

use ash::vk;

use super::buffer::{Buffer, BufferDesc};
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

enum Limits {
    Draw(DrawLimits),
    Dispatch(DispatchLimits),
}

/// The kernel before an indirect draw or dispatch: the host does not see the parameters, and Vulkan does not check them.
pub(crate) struct Clamp {
    /// The kernel, bound to the arguments.
    pub pass: Pass,
    limits: Limits,
    /// A `VkDrawIndexedIndirectCommand` or a `VkDispatchIndirectCommand` that may be used as it is.
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
        Self::of(shaders, desc, pass, Limits::Draw(limits), bytes)
    }

    /// For the dispatches that `desc` describes; `None` where none is indirect.
    pub fn of_dispatch(shaders: &ShaderLibrary, desc: &PassDesc) -> Result<Option<Self>, Error> {
        let [x, y, z] = shaders.device().physical().limits.max_compute_work_group_count;
        let pass = Pass::compute(desc.name, desc.section, "common/clamp-dispatch.comp").constants::<DispatchLimits>();
        let bytes = size_of::<vk::DispatchIndirectCommand>();
        Self::of(shaders, desc, pass, Limits::Dispatch(DispatchLimits { x, y, z }), bytes)
    }

    fn of(
        shaders: &ShaderLibrary,
        desc: &PassDesc,
        pass: PassBuilder,
        limits: Limits,
        bytes: usize,
    ) -> Result<Option<Self>, Error> {
        let Some(wanted) = &desc.indirect else { return Ok(None) };
        let usage = vk::BufferUsageFlags::INDIRECT_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
        let clamped = BufferDesc::new(wanted.buffer.name(), bytes as u64).usage(usage);
        let clamped = Buffer::new(shaders.device(), clamped)?;
        let pass = pass.with("Wanted", wanted).with("Clamped", &clamped).build(shaders)?;
        Ok(Some(Clamp { pass, limits, clamped }))
    }

    /// The kernel's one workgroup, its constants set.
    pub fn dispatch(&self, dispatch: &mut Dispatch<'_>) {
        match &self.limits {
            Limits::Draw(limits) => dispatch.constants(limits),
            Limits::Dispatch(limits) => dispatch.constants(limits),
        }
        .threads(1, 1, 1);
    }
}
