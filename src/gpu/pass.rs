//! A pass: name, section of the paper, shaders, reads, writes, blend and depth state, constants, extent. It is built
//! once; a frame records it through one envelope.

use std::sync::Arc;

use ash::vk;

use super::bindings::{Bindings, Resource, Use};
use super::buffer::{Buffer, BufferView};
use super::device::Device;
use super::indirect::Clamp;
use super::pass_builder::PassDesc;
use super::pass_info::{PassInfo, PassKind};
use super::pipeline::Pipeline;
use super::render_pass::{Framebuffer, RenderPass};
use super::shader::Compiler;
use super::transfer;
use super::work::Declared;

pub use super::pass_builder::PassBuilder;
pub use super::rebind::RebindBuilder;

/// A built pass of the device. Cloning shares it.
#[derive(Clone)]
pub struct Pass {
    /// Row of the pass table.
    pub(super) info: Arc<PassInfo>,
    /// Pipelines, descriptors and commands, shared by its clones.
    pub(crate) inner: Arc<Inner>,
}

pub(crate) struct Inner {
    /// The device of all its objects.
    pub device: Arc<Device>,
    /// `None` for a copy.
    pub pipeline: Option<Arc<Pipeline>>,
    /// The pipeline of the draws that count into the stencil, where there are such.
    pub counting: Option<Arc<Pipeline>>,
    /// Descriptor set; absent where no shader names a resource.
    pub bindings: Option<Arc<Bindings>>,
    /// Every access, in the order of declaration.
    pub uses: Vec<Use>,
    /// Commands of the pass.
    pub body: Body,
    /// From one element of the vertex buffer to the next; 0 without one.
    pub stride_bytes: u32,
    /// The description that it was built from.
    pub desc: PassDesc,
    /// Work that the description fixes.
    pub declared: Declared,
    /// Bytes of the attributes of one element of the vertex buffer.
    pub element_bytes: u64,
}

pub(crate) enum Body {
    Graphics {
        /// Render pass of the targets, with their load operations and layouts.
        render_pass: Arc<RenderPass>,
        /// Views of the targets.
        framebuffer: Framebuffer,
        /// Width and height of all targets, pixels.
        extent: vk::Extent2D,
        /// Clear value of each target, in their order; unused of targets that are loaded.
        clears: Vec<vk::ClearValue>,
        /// Vertex buffer; `None` where the shader makes or fetches its vertices itself.
        vertices: Option<BufferView>,
        /// Index buffer of 32-bit indices, for indexed draws.
        indices: Option<BufferView>,
        /// Kernel that clamps the parameters of an indirect draw.
        indirect: Option<Box<Clamp>>,
        /// Kernel that clamps the indices for a device that does not take all.
        clamped_indices: Option<Box<Clamp>>,
        /// Elements that draws may fetch.
        bounds: DrawBounds,
    },
    Compute {
        /// Size of a workgroup, and the order of workgroups.
        workgroup: Workgroup,
        /// Kernel that clamps the parameters of an indirect dispatch.
        indirect: Option<Box<Clamp>>,
    },
    Copy {
        /// Image or byte range that is read.
        from: Resource,
        /// Buffer that is written from its start on.
        to: Arc<Buffer>,
    },
}

/// The workgroups of a compute pass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Workgroup {
    /// Threads along x, y and z.
    pub size: [u32; 3],
    /// The shader numbers its threads by rows of workgroups (`common/elements.glsl`).
    pub lies_in_rows: bool,
}

impl Body {
    /// The kernel that clamps the parameters of the commands, where they lie on the device.
    pub fn parameters(&self) -> Option<&Clamp> {
        match self {
            Body::Graphics { indirect, .. } | Body::Compute { indirect, .. } => indirect.as_deref(),
            Body::Copy { .. } => None,
        }
    }

    /// The kernels before the commands.
    pub fn clamps(&self) -> impl Iterator<Item = &Clamp> {
        let indices = match self {
            Body::Graphics { clamped_indices, .. } => clamped_indices.as_deref(),
            Body::Compute { .. } | Body::Copy { .. } => None,
        };
        self.parameters().into_iter().chain(indices)
    }
}

/// Elements in the buffers that the draws of a pass fetch from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawBounds {
    /// Vertices; `u64::MAX` where none are fetched.
    pub vertices: u64,
    /// Instances; `u64::MAX` where nothing is fetched for each.
    pub instances: u64,
    /// Indices; `None` without an index buffer.
    pub indices: Option<u64>,
}

impl Pass {
    /// Describes a pass that draws with a vertex and a fragment shader, and perhaps a
    /// [geometry](PassBuilder::geometry) shader between them.
    pub fn graphics(name: &'static str, section: &'static str, vertex: &str, fragment: &str) -> PassBuilder {
        PassBuilder::new(name, section, PassKind::Graphics, vec![vertex.to_owned(), fragment.to_owned()])
    }

    /// Describes a pass that dispatches a compute shader.
    pub fn compute(name: &'static str, section: &'static str, shader: &str) -> PassBuilder {
        PassBuilder::new(name, section, PassKind::Compute, vec![shader.to_owned()])
    }

    /// A pass that copies `from`, a view of an image or a buffer, into `to`, texels tightly packed. A buffer that the
    /// host reads back is made visible to it. [`Frame::copy`](super::Frame::copy) refuses one that does not fit.
    pub fn copy(name: &'static str, section: &'static str, from: impl Into<Resource>, to: &Arc<Buffer>) -> Pass {
        let from = from.into();
        let uses = transfer::copy_uses(&from, to).to_vec();
        let info = PassInfo::without_shaders(name, section, PassKind::Transfer, &[from.name()], &[to.name()]);
        let declared = Declared::copy(&from);
        let inner = Inner {
            device: to.device().clone(),
            pipeline: None,
            counting: None,
            bindings: None,
            uses,
            body: Body::Copy { from, to: to.clone() },
            stride_bytes: 0,
            desc: PassDesc::new(name, section, PassKind::Transfer, Vec::new()),
            declared,
            element_bytes: 0,
        };
        Pass { info, inner: Arc::new(inner) }
    }

    /// The row of the pass table.
    pub fn info(&self) -> &Arc<PassInfo> {
        &self.info
    }

    /// Several passes that are one to the paper: recorded one after the other, with their barriers between them, under one
    /// name, and described together, by the kind of the first. The compiler is naga only where all of them run naga's
    /// binaries.
    pub fn steps<const N: usize>(steps: [Pass; N]) -> [Pass; N] {
        let Some(mut whole) = steps.first().map(|first| PassInfo::clone(first.info())) else { return steps };
        let add = |names: &mut Vec<String>, more: &[String]| {
            names.extend(more.iter().filter(|name| !names.contains(name)).cloned().collect::<Vec<_>>());
        };
        for step in &steps[1..] {
            let info = step.info();
            add(&mut whole.shaders, &info.shaders);
            add(&mut whole.reads, &info.reads);
            add(&mut whole.writes, &info.writes);
            let blends: Vec<_> = info.blend.iter().copied().filter(|state| !whole.blend.contains(state)).collect();
            whole.blend.extend(blends);
            whole.depth = whole.depth.or(info.depth);
            whole.counting = whole.counting.or(info.counting);
            whole
                .binaries
                .extend(info.binaries.iter().filter(|b| !whole.binaries.contains(b)).cloned().collect::<Vec<_>>());
            if let (Some(all), Some(more)) = (&mut whole.executables, &info.executables) {
                all.extend(more.iter().cloned());
            }
            if whole.compiler != info.compiler {
                whole.compiler = Some(Compiler::Glslang);
            }
        }
        let whole = Arc::new(whole);
        steps.map(|step| Pass { info: whole.clone(), ..step })
    }

    /// The same pass, with the same pipeline, bound to other resources.
    pub fn rebind(&self) -> RebindBuilder {
        RebindBuilder::new(self)
    }
}

impl DrawBounds {
    /// The bounds of the draws that `desc` describes, with elements of `stride_bytes` in its vertex buffer.
    pub fn new(desc: &PassDesc, stride_bytes: u32) -> Self {
        let elements = |view: &BufferView| match stride_bytes {
            0 => u64::MAX,
            stride => view.len_bytes() / u64::from(stride),
        };
        let fetched = desc.vertices.as_ref().map_or(u64::MAX, elements);
        let (vertices, instances) = match desc.vertex_rate {
            vk::VertexInputRate::INSTANCE => (u64::MAX, fetched),
            _ => (fetched, u64::MAX),
        };
        let indices = desc.indices.as_ref().map(|view| view.len_bytes() / size_of::<u32>() as u64);
        DrawBounds { vertices, instances, indices }
    }

    /// The first of a draw's counts that is beyond what is bound, in words.
    pub fn problem(&self, draw: DrawCounts) -> Option<String> {
        let beyond = |what, end: u64, bound: u64| {
            (end > bound).then(|| format!("draws {what} up to {end}, and the bound buffer holds {bound}"))
        };
        match self.indices {
            None if draw.indices > 0 => Some("draws indices, and no index buffer is bound".to_owned()),
            bound => beyond("vertices", draw.vertices, self.vertices)
                .or_else(|| beyond("instances", draw.instances, self.instances))
                .or_else(|| beyond("indices", draw.indices, bound.unwrap_or(0))),
        }
    }
}

/// Elements up to which a draw fetches.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct DrawCounts {
    /// Vertices that are bound; any number where none are needed.
    pub vertices: u64,
    /// Instances that are bound.
    pub instances: u64,
    /// Indices that are bound.
    pub indices: u64,
}
