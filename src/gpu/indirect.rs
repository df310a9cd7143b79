//! Parameters of an indirect draw, kept inside what the draw has bound.

use std::sync::Arc;

use ash::vk;

use super::buffer::{Buffer, BufferDesc};
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

/// The kernel before an indirect draw: the host does not see the parameters, and Vulkan does not check them.
pub(crate) struct ClampDraw {
    /// The kernel, bound to the arguments.
    pub pass: Pass,
    limits: DrawLimits,
    /// A `VkDrawIndexedIndirectCommand` that the draw may use as it is.
    pub clamped: Arc<Buffer>,
}

impl ClampDraw {
    /// For the draws that `desc` describes; `None` where none is indirect.
    pub fn new(shaders: &ShaderLibrary, desc: &PassDesc, bounds: DrawBounds) -> Result<Option<Self>, Error> {
        let Some(wanted) = &desc.indirect else { return Ok(None) };
        let usage = vk::BufferUsageFlags::INDIRECT_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
        let bytes = size_of::<vk::DrawIndexedIndirectCommand>() as u64;
        let clamped = Buffer::new(shaders.device(), BufferDesc::new(wanted.buffer.name(), bytes).usage(usage))?;
        let pass = Pass::compute(desc.name, desc.section, "common/clamp-draw.comp")
            .constants::<DrawLimits>()
            .with("Wanted", wanted)
            .with("Clamped", &clamped)
            .build(shaders)?;
        let at_most = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
        let limits =
            DrawLimits { index_count: at_most(bounds.indices.unwrap_or(0)), instance_count: at_most(bounds.instances) };
        Ok(Some(ClampDraw { pass, limits, clamped }))
    }

    /// The kernel's one workgroup, its constants set.
    pub fn dispatch(&self, dispatch: &mut super::Dispatch<'_>) {
        dispatch.constants(&self.limits).threads(1, 1, 1);
    }
}
