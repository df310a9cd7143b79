//! A pass: name, section of the paper, shaders, reads, writes, blend and depth state, constants, extent. It is built
//! once; a frame records it through one envelope.

use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::bindings::{Bindings, Resource, Use};
use super::buffer::{Buffer, BufferView};
use super::device::Device;
use super::error::Error;
use super::image::ImageView;
use super::pass_info::{PassInfo, PassKind};
use super::physical::Feature;
use super::pipeline::{Pipeline, Topology, VertexLayout, check_constants};
use super::program::Program;
use super::render_pass::{Blend, DepthTest, Framebuffer, Load, RenderPass, Target, Targets};
use super::shader::{Compiler, ShaderLibrary};
use crate::shader_build::HostBlock;

/// A built pass of the device. Cloning shares it.
#[derive(Clone)]
pub struct Pass {
    info: Arc<PassInfo>,
    pub(crate) inner: Arc<Inner>,
}

pub(crate) struct Inner {
    pub device: Arc<Device>,
    /// `None` for a copy.
    pub pipeline: Option<Arc<Pipeline>>,
    /// The pipeline of the draws that count into the stencil, where there are such.
    pub counting: Option<Arc<Pipeline>>,
    pub bindings: Option<Arc<Bindings>>,
    pub uses: Vec<Use>,
    pub body: Body,
    desc: PassDesc,
}

pub(crate) enum Body {
    Graphics {
        render_pass: Arc<RenderPass>,
        framebuffer: Framebuffer,
        extent: vk::Extent2D,
        clears: Vec<vk::ClearValue>,
        vertices: Option<BufferView>,
        indices: Option<BufferView>,
        indirect: Option<BufferView>,
    },
    Compute,
    Copy {
        from: Resource,
        to: Arc<Buffer>,
    },
}

/// Everything that the builder was told; kept so that a pass can be rebound to other resources.
#[derive(Clone)]
struct PassDesc {
    name: &'static str,
    section: &'static str,
    shaders: Vec<String>,
    resources: Vec<(&'static str, Resource)>,
    targets: Targets,
    vertices: Option<BufferView>,
    vertex_rate: vk::VertexInputRate,
    indices: Option<BufferView>,
    indirect: Option<BufferView>,
    topology: Topology,
    counting: Option<(String, DepthTest)>,
}

type LayoutOf = fn(&str, &Program) -> Result<VertexLayout, Error>;
type CheckConstants = fn(&str, &Program) -> Result<(), Error>;

/// The description of a pass; [`PassBuilder::build`] makes it.
#[derive(Clone)]
pub struct PassBuilder {
    desc: PassDesc,
    vertex_layout: Option<LayoutOf>,
    check_constants: Option<CheckConstants>,
}

impl Pass {
    /// Describes a pass that draws with a vertex and a fragment shader, and perhaps a
    /// [geometry](PassBuilder::geometry) shader between them.
    pub fn graphics(name: &'static str, section: &'static str, vertex: &str, fragment: &str) -> PassBuilder {
        Self::builder(name, section, vec![vertex.to_owned(), fragment.to_owned()])
    }

    /// Describes a pass that dispatches a compute shader.
    pub fn compute(name: &'static str, section: &'static str, shader: &str) -> PassBuilder {
        Self::builder(name, section, vec![shader.to_owned()])
    }

    /// A pass that copies `from`, a view of an image or a buffer, into `to`, texels tightly packed. A buffer that the
    /// host reads back is made visible to it.
    pub fn copy(name: &'static str, section: &'static str, from: impl Into<Resource>, to: &Arc<Buffer>) -> Pass {
        let from = from.into();
        let uses = vec![
            Use { resource: from.clone(), access: Access::CopySource, discard: false },
            Use { resource: to.into(), access: Access::CopyDestination, discard: true },
        ];
        let info = Arc::new(PassInfo {
            name,
            section,
            kind: PassKind::Transfer,
            shaders: Vec::new(),
            reads: vec![from.name().to_owned()],
            writes: vec![to.name().to_owned()],
            blend: Vec::new(),
            depth: None,
            counting: None,
            compiler: None,
        });
        let desc = Self::builder(name, section, Vec::new()).desc;
        Pass {
            info,
            inner: Arc::new(Inner {
                device: to.device().clone(),
                pipeline: None,
                counting: None,
                bindings: None,
                uses,
                body: Body::Copy { from, to: to.clone() },
                desc,
            }),
        }
    }

    fn builder(name: &'static str, section: &'static str, shaders: Vec<String>) -> PassBuilder {
        PassBuilder {
            desc: PassDesc {
                name,
                section,
                shaders,
                resources: Vec::new(),
                targets: Targets::default(),
                vertices: None,
                vertex_rate: vk::VertexInputRate::VERTEX,
                indices: None,
                indirect: None,
                topology: Topology::default(),
                counting: None,
            },
            vertex_layout: None,
            check_constants: None,
        }
    }

    pub fn info(&self) -> &Arc<PassInfo> {
        &self.info
    }

    /// Threads of a workgroup, for a compute pass.
    pub(crate) fn local_size(&self) -> [u32; 3] {
        let module = self.inner.pipeline.as_ref().and_then(|p| p.program.modules.first());
        module.and_then(|m| m.interface.local_size).unwrap_or([1, 1, 1])
    }

    /// Several passes that are one to the paper: recorded one after the other, with their barriers between them, under one
    /// name, and described together. The compiler is naga only where all of them run naga's binaries.
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
            if whole.compiler != info.compiler {
                whole.compiler = Some(Compiler::Glslang);
            }
        }
        let whole = Arc::new(whole);
        steps.map(|step| Pass { info: whole.clone(), ..step })
    }

    /// The same pass, with the same pipeline, about other resources.
    pub fn rebind(&self) -> RebindBuilder {
        RebindBuilder { pass: self.clone(), desc: self.inner.desc.clone() }
    }
}

impl PassBuilder {
    /// A geometry shader between the vertex and the fragment shader. naga has no such stage, so glslang compiles all
    /// stages of the pass.
    pub fn geometry(mut self, geometry: &str) -> Self {
        self.desc.shaders.insert(1, geometry.to_owned());
        self
    }

    /// A resource that the shaders read or write, by the name they give it. Their binaries say how it is accessed.
    pub fn with(mut self, name: &'static str, resource: impl Into<Resource>) -> Self {
        self.desc.resources.push((name, resource.into()));
        self
    }

    /// The host struct of the push constants; the build of the pass checks it against the shaders.
    pub fn constants<T: HostBlock>(mut self) -> Self {
        self.check_constants = Some(check_constants::<T>);
        self
    }

    /// The vertex buffer, of `T`s; its fields feed the vertex stage's inputs of the same names.
    pub fn vertices<T: HostBlock>(mut self, buffer: &Arc<Buffer>) -> Self {
        self.desc.vertices = Some(buffer.view());
        self.vertex_layout = Some(VertexLayout::of::<T>);
        self
    }

    /// As [`PassBuilder::vertices`], with one `T` for each instance.
    pub fn instances<T: HostBlock>(mut self, buffer: &Arc<Buffer>) -> Self {
        self.desc.vertex_rate = vk::VertexInputRate::INSTANCE;
        self.vertices::<T>(buffer)
    }

    /// The index buffer, of 32-bit indices.
    pub fn indices(mut self, buffer: &Arc<Buffer>) -> Self {
        self.desc.indices = Some(buffer.view());
        self
    }

    /// The buffer that [`Draw::indices_indirect`](super::Draw::indices_indirect) takes its parameters from: a
    /// `VkDrawIndexedIndirectCommand` at its start.
    pub fn indirect(mut self, buffer: &Arc<Buffer>) -> Self {
        self.desc.indirect = Some(buffer.view());
        self
    }

    pub fn topology(mut self, topology: Topology) -> Self {
        self.desc.topology = topology;
        self
    }

    /// The next colour attachment.
    pub fn color(mut self, view: &Arc<ImageView>, load: Load, blend: Blend) -> Self {
        self.desc.targets.colors.push((Target { view: view.clone(), load }, blend));
        self
    }

    pub fn depth(mut self, view: &Arc<ImageView>, load: Load, test: DepthTest) -> Self {
        self.desc.targets.depth = Some((Target { view: view.clone(), load }, test));
        self
    }

    /// A second pipeline for draws that alternate with the pass's own inside its render pass: the same vertices, another
    /// fragment shader and depth state, colours masked. [`Draw::counting`](super::Draw::counting) chooses it.
    pub fn counting(mut self, fragment: &str, test: DepthTest) -> Self {
        self.desc.counting = Some((fragment.to_owned(), test));
        self
    }

    /// The extent of a pass that has no attachments.
    pub fn extent(mut self, width: u32, height: u32) -> Self {
        self.desc.targets.extent = Some((width, height));
        self
    }

    /// Makes modules, layouts, pipeline, descriptor set and framebuffer, checking every declared name against the
    /// shaders.
    ///
    /// # Errors
    /// [`Error::Pass`] or [`Error::Shader`] for a description that does not fit its shaders; [`Error::MissingFeature`] for a
    /// geometry stage on a device without; what Vulkan answers.
    pub fn build(self, shaders: &ShaderLibrary) -> Result<Pass, Error> {
        let device = shaders.device();
        let PassBuilder { desc, vertex_layout, check_constants } = self;
        let name = desc.name;
        let has_geometry = desc.shaders.iter().any(|s| s.ends_with(".geom"));
        if has_geometry && !device.physical().has(Feature::GeometryShader) {
            let missing = Feature::GeometryShader.as_str().to_owned();
            return Err(Error::MissingFeature { device: device.physical().name.clone(), missing });
        }
        let load = |shader: &str| {
            if has_geometry { shaders.module_by(shader, Compiler::Glslang) } else { shaders.module(shader) }
        };
        let modules = desc.shaders.iter().map(|s| load(s)).collect::<Result<Vec<_>, _>>()?;
        let program = Program::new(device, name, modules)?;
        match check_constants {
            Some(check) => check(name, &program)?,
            None if program.push_bytes > 0 => {
                return Err(Error::Pass {
                    pass: name.into(),
                    problem: "its shaders take push constants and none are declared".into(),
                });
            }
            None => {}
        }
        let is_compute = desc.shaders.iter().any(|s| s.ends_with(".comp"));
        if is_compute {
            let pipeline = Pipeline::compute(device, name, &program)?;
            return finish(device, desc, Pipelines { own: pipeline, counting: None }, None);
        }
        let mut layout = vertex_layout.unwrap_or(VertexLayout::none)(name, &program)?;
        layout.rate = desc.vertex_rate;
        let render_pass = RenderPass::new(device, name, &desc.targets)?;
        let targets = &desc.targets;
        let modules = &program.modules;
        let topology = desc.topology;
        let own = Pipeline::graphics(device, name, &program, modules, &render_pass, targets, &layout, topology)?;
        let counting = match &desc.counting {
            None => None,
            Some((fragment, test)) => {
                let mut modules = modules.clone();
                modules.pop();
                modules.push(load(fragment)?);
                let targets = targets.for_counting(*test);
                let made =
                    Pipeline::graphics(device, name, &program, &modules, &render_pass, &targets, &layout, topology)?;
                Some(made)
            }
        };
        finish(device, desc, Pipelines { own, counting }, Some(render_pass))
    }
}

/// The pipelines of a pass that draws or dispatches.
struct Pipelines {
    own: Arc<Pipeline>,
    counting: Option<Arc<Pipeline>>,
}

/// Rebinds a pass to other resources: same shaders, state and formats.
pub struct RebindBuilder {
    pass: Pass,
    desc: PassDesc,
}

impl RebindBuilder {
    /// Replaces the resource of that name.
    pub fn with(mut self, name: &'static str, resource: impl Into<Resource>) -> Self {
        let resource = resource.into();
        match self.desc.resources.iter_mut().find(|(n, _)| *n == name) {
            Some(slot) => slot.1 = resource,
            None => self.desc.resources.push((name, resource)),
        }
        self
    }

    /// Replaces the colour attachment at `index`; its format is the old one's.
    pub fn color(mut self, index: usize, view: &Arc<ImageView>, load: Load) -> Self {
        if let Some((target, _)) = self.desc.targets.colors.get_mut(index) {
            *target = Target { view: view.clone(), load };
        }
        self
    }

    /// Replaces the depth attachment; its format is the old one's.
    pub fn depth(mut self, view: &Arc<ImageView>, load: Load) -> Self {
        if let Some((target, _)) = &mut self.desc.targets.depth {
            *target = Target { view: view.clone(), load };
        }
        self
    }

    pub fn vertices(mut self, buffer: &Arc<Buffer>) -> Self {
        self.desc.vertices = Some(buffer.view());
        self
    }

    pub fn indices(mut self, buffer: &Arc<Buffer>) -> Self {
        self.desc.indices = Some(buffer.view());
        self
    }

    /// Makes the pass, sharing the pipeline of the first.
    ///
    /// # Errors
    /// As [`PassBuilder::build`].
    pub fn build(self, shaders: &ShaderLibrary) -> Result<Pass, Error> {
        let render_pass = match &self.pass.inner.body {
            Body::Compute | Body::Copy { .. } => None,
            // Load operations alone may differ, which keeps the new render pass compatible with the pipeline.
            Body::Graphics { .. } => Some(RenderPass::new(shaders.device(), self.desc.name, &self.desc.targets)?),
        };
        let Some(pipeline) = self.pass.inner.pipeline.clone() else {
            return Err(Error::Pass {
                pass: self.desc.name.into(),
                problem: "a copy has no descriptors to rebind".into(),
            });
        };
        let pipelines = Pipelines { own: pipeline, counting: self.pass.inner.counting.clone() };
        finish(shaders.device(), self.desc, pipelines, render_pass)
    }
}

fn finish(
    device: &Arc<Device>,
    desc: PassDesc,
    pipelines: Pipelines,
    render_pass: Option<Arc<RenderPass>>,
) -> Result<Pass, Error> {
    let Pipelines { own: pipeline, counting } = pipelines;
    let bindings = Bindings::new(device, desc.name, &pipeline.program, &desc.resources)?;
    let mut uses = bindings.as_ref().map(|b| b.uses.clone()).unwrap_or_default();
    let body = match render_pass {
        None => Body::Compute,
        Some(render_pass) => {
            add_fixed_function_uses(&desc, &mut uses);
            let extent = desc.targets.extent().ok_or_else(|| Error::Pass {
                pass: desc.name.into(),
                problem: "it has neither attachments nor an extent".into(),
            })?;
            Body::Graphics {
                framebuffer: Framebuffer::new(device, desc.name, &render_pass, &desc.targets, extent)?,
                render_pass,
                extent,
                clears: desc.targets.clear_values(),
                vertices: desc.vertices.clone(),
                indices: desc.indices.clone(),
                indirect: desc.indirect.clone(),
            }
        }
    };
    check_conflicts(desc.name, &uses)?;
    if let Some(parameters) = &desc.indirect {
        let wanted = size_of::<vk::DrawIndexedIndirectCommand>() as u64;
        let bytes = parameters.range.end - parameters.range.start;
        if bytes < wanted || !parameters.buffer.usage().contains(vk::BufferUsageFlags::INDIRECT_BUFFER) {
            let name = parameters.buffer.name();
            return Err(Error::Pass {
                pass: desc.name.into(),
                problem: format!("{name} is no indirect buffer of {wanted} bytes"),
            });
        }
    }
    let info = Arc::new(describe(&desc, &pipeline.program, &uses));
    let inner = Inner { device: device.clone(), pipeline: Some(pipeline), counting, bindings, uses, body, desc };
    Ok(Pass { info, inner: Arc::new(inner) })
}

fn add_fixed_function_uses(desc: &PassDesc, uses: &mut Vec<Use>) {
    let mut add = |resource: Resource, access, discard| uses.push(Use { resource, access, discard });
    if let Some(vertices) = &desc.vertices {
        add(vertices.into(), Access::VertexRead, false);
    }
    if let Some(indices) = &desc.indices {
        add(indices.into(), Access::IndexRead, false);
    }
    if let Some(parameters) = &desc.indirect {
        add(parameters.into(), Access::IndirectRead, false);
    }
    for (target, _) in &desc.targets.colors {
        add((&target.view).into(), Access::ColorTarget, target.load != Load::Keep);
    }
    if let Some((target, test)) = &desc.targets.depth {
        add((&target.view).into(), test.access(), target.load != Load::Keep);
    }
}

/// One pass cannot have one image in two layouts.
fn check_conflicts(pass: &str, uses: &[Use]) -> Result<(), Error> {
    for (i, a) in uses.iter().enumerate() {
        for b in &uses[..i] {
            if let (Resource::Image(x), Resource::Image(y)) = (&a.resource, &b.resource)
                && Arc::ptr_eq(&x.image, &y.image)
                && x.layers.start < y.layers.end
                && y.layers.start < x.layers.end
                && a.access.info().layout != b.access.info().layout
            {
                return Err(Error::Pass {
                    pass: pass.to_owned(),
                    problem: format!("uses image {} in two ways at once", x.image.name()),
                });
            }
        }
    }
    Ok(())
}

fn describe(desc: &PassDesc, program: &Program, uses: &[Use]) -> PassInfo {
    let names = |writes: bool| {
        let mut names: Vec<String> =
            uses.iter().filter(|u| u.access.info().writes == writes).map(|u| u.resource.name().to_owned()).collect();
        names.dedup();
        names
    };
    PassInfo {
        name: desc.name,
        section: desc.section,
        kind: if desc.shaders.iter().any(|s| s.ends_with(".comp")) { PassKind::Compute } else { PassKind::Graphics },
        shaders: desc.shaders.iter().chain(desc.counting.iter().map(|(shader, _)| shader)).cloned().collect(),
        reads: names(false),
        writes: names(true),
        blend: desc.targets.colors.iter().map(|(_, blend)| blend.as_str()).collect(),
        depth: desc.targets.depth.as_ref().map(|(_, test)| test.as_str()),
        counting: desc.counting.as_ref().map(|(_, test)| test.as_str()),
        compiler: Some(program.compiler()),
    }
}
