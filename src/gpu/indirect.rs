//! Parameters of indirect draws and dispatches, kept inside what is bound and what the device takes.

use std::sync::Arc;

use ash::vk;

use super::buffer::{Buffer, BufferDesc, BufferView};
use super::draw::Dispatch;
use super::error::Error;
use super::pass::{DrawBounds, Pass};
use super::pass_builder::PassDesc;
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
        let Some(wanted) = &desc.indirect else { return Ok(None) };
        let bytes = size_of::<vk::DrawIndexedIndirectCommand>() as u64;
        let clamped = Self::buffer(shaders, wanted, bytes)?;
        let pass = Pass::compute(desc.name, desc.section, "common/clamp-draw.comp")
            .constants::<DrawLimits>()
            .with("Wanted", wanted)
            .with("Clamped", &clamped)
            .build(shaders)?;
        let at_most = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
        let limits =
            DrawLimits { index_count: at_most(bounds.indices.unwrap_or(0)), instance_count: at_most(bounds.instances) };
        Ok(Some(Clamp { pass, limits: Limits::Draw(limits), clamped }))
    }

    /// For the dispatches that `desc` describes; `None` where none is indirect.
    pub fn of_dispatch(shaders: &ShaderLibrary, desc: &PassDesc) -> Result<Option<Self>, Error> {
        let Some(wanted) = &desc.indirect else { return Ok(None) };
        let bytes = size_of::<vk::DispatchIndirectCommand>() as u64;
        let clamped = Self::buffer(shaders, wanted, bytes)?;
        let pass = Pass::compute(desc.name, desc.section, "common/clamp-dispatch.comp")
            .constants::<DispatchLimits>()
            .with("Wanted", wanted)
            .with("Clamped", &clamped)
            .build(shaders)?;
        let [x, y, z] = shaders.device().physical().limits.max_compute_work_group_count;
        Ok(Some(Clamp { pass, limits: Limits::Dispatch(DispatchLimits { x, y, z }), clamped }))
    }

    fn buffer(shaders: &ShaderLibrary, wanted: &BufferView, bytes: u64) -> Result<Arc<Buffer>, Error> {
        let usage = vk::BufferUsageFlags::INDIRECT_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
        Buffer::new(shaders.device(), BufferDesc::new(wanted.buffer.name(), bytes).usage(usage))
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
