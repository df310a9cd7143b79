//! The description of a pass, and its building.

use std::any::TypeId;
use std::iter;
use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::bindings::{Bindings, Resource, Use};
use super::buffer::{Buffer, BufferView};
use super::error::Error;
use super::executable::executables;
use super::image::ImageView;
use super::indirect::Clamp;
use super::pass::{Body, DrawBounds, Inner, Pass};
use super::pass_check;
use super::pass_info::{PassInfo, PassKind, label};
use super::physical::Feature;
use super::pipeline::{Pipeline, Topology, VertexLayout, check_constants};
use super::pipeline_store::{PipelineState, RasterState};
use super::program::Program;
use super::render_pass::{Blend, DepthTest, Framebuffer, Load, RenderPass, Target, Targets};
use super::sample::Counts;
use super::shader::{Compiler, ShaderLibrary, ShaderModule};
use super::work::Declared;
use crate::shader_build::HostBlock;

/// Everything that the builder was told; kept so that a pass can be rebound to other resources.
#[derive(Clone)]
pub(crate) struct PassDesc {
    /// Name of the pass: its debug label and the record's.
    pub name: &'static str,
    /// Section of the paper; empty for what is ours.
    pub section: &'static str,
    /// Kind of the work.
    pub kind: PassKind,
    /// Paths under `shaders/`, in the order of the stages.
    pub shaders: Vec<String>,
    /// Resources by the names that the shaders give them.
    pub resources: Vec<(&'static str, Resource)>,
    /// Resources that the shaders may leave out.
    pub offered: Vec<(&'static str, Resource)>,
    /// The host struct of the push constants.
    pub constants: Option<Constants>,
    /// Attachments with their blend and depth states.
    pub targets: Targets,
    /// Vertex buffer; absent where vertices come from their index alone.
    pub vertices: Option<BufferView>,
    /// Step of the vertex buffer: a vertex or an instance.
    pub vertex_rate: vk::VertexInputRate,
    /// Index buffer of 32-bit indices.
    pub indices: Option<BufferView>,
    /// Arguments of an indirect draw or dispatch.
    pub indirect: Option<BufferView>,
    /// Primitives that vertices make up.
    pub topology: Topology,
    /// Fragment shader and depth state of the draws that alternate with the pass's own.
    pub counting: Option<(String, DepthTest)>,
    /// Names of resources that every recording touches whole.
    pub whole: Vec<&'static str>,
    /// Multiply-adds of a recording by its counters.
    pub multiply_adds: Option<Formula>,
}

/// Multiply-adds that follow from counters; `None` where one is absent.
pub(crate) type Formula = Arc<dyn Fn(&Counts) -> Option<u64> + Send + Sync>;

/// A declared type of push constants.
#[derive(Clone, Copy)]
pub(crate) struct Constants {
    /// The host struct of the constants.
    pub id: TypeId,
    /// Its type's name, for messages.
    pub name: &'static str,
    check: fn(&str, &[Arc<ShaderModule>]) -> Result<(), Error>,
}

impl PassDesc {
    pub fn new(name: &'static str, section: &'static str, kind: PassKind, shaders: Vec<String>) -> Self {
        PassDesc {
            name,
            section,
            kind,
            shaders,
            resources: Vec::new(),
            offered: Vec::new(),
            constants: None,
            targets: Targets::default(),
            vertices: None,
            vertex_rate: vk::VertexInputRate::VERTEX,
            indices: None,
            indirect: None,
            topology: Topology::default(),
            counting: None,
            whole: Vec::new(),
            multiply_adds: None,
        }
    }

    pub fn problem(&self, problem: impl Into<String>) -> Error {
        Error::Pass { pass: self.name.to_owned(), problem: problem.into() }
    }

    /// The accesses that no descriptor names: fetches and attachments.
    fn fixed_function_uses(&self, indices: Option<&BufferView>) -> Vec<Use> {
        let fetches = [(self.vertices.as_ref(), Access::VertexRead), (indices, Access::IndexRead)];
        let fetches = fetches
            .into_iter()
            .filter_map(|(view, access)| Some(Use { resource: view?.into(), access, discard: false }));
        let attachment = |target: &Target, access| Use {
            resource: (&target.view).into(),
            access,
            discard: target.load != Load::Keep,
        };
        let colors = self.targets.colors.iter().map(|(target, _)| attachment(target, Access::ColorTarget));
        let depth = self.targets.depth.iter().map(|(target, test)| attachment(target, test.access()));
        fetches.chain(colors).chain(depth).collect()
    }

    fn describe(&self, program: &Program, uses: &[Use]) -> PassInfo {
        let names = |writes: bool| {
            let of_kind = uses.iter().filter(|u| u.access.info().writes == writes);
            let mut names: Vec<String> = of_kind.map(|u| u.resource.name().to_owned()).collect();
            names.dedup();
            names
        };
        PassInfo {
            name: self.name,
            section: self.section,
            kind: self.kind,
            shaders: self.shaders.iter().chain(self.counting.iter().map(|(shader, _)| shader)).cloned().collect(),
            reads: names(false),
            writes: names(true),
            blend: self.targets.colors.iter().map(|(_, blend)| blend.as_str()).collect(),
            depth: self.targets.depth.as_ref().map(|(_, test)| test.as_str()),
            counting: self.counting.as_ref().map(|(_, test)| test.as_str()),
            compiler: Some(program.compiler()),
            binaries: program.modules.iter().map(|module| module.binary()).collect(),
            executables: None,
        }
    }
}

type LayoutOf = fn(&str, &Program) -> Result<VertexLayout, Error>;

/// The description of a pass; [`PassBuilder::build`] makes it.
#[derive(Clone)]
pub struct PassBuilder {
    desc: PassDesc,
    vertex_layout: Option<LayoutOf>,
}

impl PassBuilder {
    pub(super) fn new(name: &'static str, section: &'static str, kind: PassKind, shaders: Vec<String>) -> Self {
        PassBuilder { desc: PassDesc::new(name, section, kind, shaders), vertex_layout: None }
    }

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

    /// A resource that the shaders may read or not, by the name they give it: what a sibling pass reads through a shader
    /// that both have, so that a replacement of that shader may read it too.
    pub fn offer(mut self, name: &'static str, resource: impl Into<Resource>) -> Self {
        self.desc.offered.push((name, resource.into()));
        self
    }

    /// Declares that each recording reads every byte of the resources of these names, or writes every byte of those that
    /// the shaders write: their bytes are then certain.
    pub fn whole(mut self, names: &[&'static str]) -> Self {
        self.desc.whole.extend_from_slice(names);
        self
    }

    /// Declares how many multiply-adds of 32-bit floats a recording takes at least, by its counters.
    pub fn multiply_adds(mut self, formula: impl Fn(&Counts) -> Option<u64> + Send + Sync + 'static) -> Self {
        self.desc.multiply_adds = Some(Arc::new(formula));
        self
    }

    /// The host struct of the push constants; the build of the pass checks it against the shaders.
    pub fn constants<T: HostBlock + 'static>(mut self) -> Self {
        self.desc.constants = Some(Constants { id: TypeId::of::<T>(), name: T::NAME, check: check_constants::<T> });
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

    /// The buffer that [`Draw::indices_indirect`](super::Draw::indices_indirect) or
    /// [`Dispatch::groups_indirect`](super::Dispatch::groups_indirect) takes its parameters from: a
    /// `VkDrawIndexedIndirectCommand` or a `VkDispatchIndirectCommand` at its start, in a storage buffer. A kernel of the
    /// pass's own keeps it inside the index buffer, or within the device's limits, first.
    pub fn indirect(mut self, buffer: &Arc<Buffer>) -> Self {
        self.desc.indirect = Some(buffer.view());
        self
    }

    /// The kind of primitive that is drawn.
    pub fn topology(mut self, topology: Topology) -> Self {
        self.desc.topology = topology;
        self
    }

    /// Draws no triangle that shows this side; the front is the one that its corners come round counter-clockwise on.
    pub fn cull(mut self, culled: vk::CullModeFlags) -> Self {
        self.desc.targets.culled = culled;
        self
    }

    /// The next colour attachment.
    pub fn color(mut self, view: &Arc<ImageView>, load: Load, blend: Blend) -> Self {
        self.desc.targets.colors.push((Target { view: view.clone(), load }, blend));
        self
    }

    /// The depth (and stencil) attachment.
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

    /// Makes descriptor set and framebuffer, and modules, layouts and pipeline where the library keeps none, checking every declared name against the
    /// shaders and every resource against its use.
    ///
    /// # Errors
    /// [`Error::Pass`] or [`Error::Shader`] for a description that does not fit its shaders or its resources;
    /// [`Error::Limit`] for what is beyond the device; [`Error::MissingFeature`] for a geometry stage on a device without;
    /// [`Error::Foreign`] for a resource of another device; any error of Vulkan.
    pub fn build(self, shaders: &ShaderLibrary) -> Result<Pass, Error> {
        let device = shaders.device();
        let PassBuilder { desc, vertex_layout } = self;
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
        pass_check::stages(device, &desc, &modules)?;
        let program = shaders.pipelines.program(device, name, &modules)?;
        let mut desc = desc;
        let wanted = desc.offered.drain(..).filter(|(name, _)| program.slots.iter().any(|slot| slot.name == *name));
        desc.resources.extend(wanted);
        match desc.constants {
            Some(constants) => (constants.check)(name, &program.modules)?,
            None if program.push_bytes > 0 => {
                return Err(desc.problem("its shaders take push constants and none are declared"));
            }
            None => {}
        }
        // Named while nobody else has it: passes share it, and may be at work on another thread.
        let named = |pipeline: Arc<Pipeline>| {
            device.name(pipeline.raw, &label(name, desc.section));
            pipeline
        };
        let state = |modules: &[Arc<ShaderModule>], raster| PipelineState {
            label: (name, desc.section),
            shaders: modules.iter().map(|module| module.name.clone()).collect(),
            raster,
        };
        if desc.kind == PassKind::Compute {
            let make = || Pipeline::compute(device, name, &program).map(named);
            let own = shaders.pipelines.pipeline(&program, state(&program.modules, None), make)?;
            return finish(shaders, desc, Pipelines { own, counting: None, stride_bytes: 0, element_bytes: 0 }, None);
        }
        pass_check::targets(device, &desc, &program)?;
        let mut layout = vertex_layout.unwrap_or(VertexLayout::none)(name, &program)?;
        layout.rate = desc.vertex_rate;
        layout.check_limits(device, name)?;
        let render_pass = RenderPass::new(device, name, &desc.targets)?;
        let targets = &desc.targets;
        let modules = &program.modules;
        let topology = desc.topology;
        let raster = Some(RasterState::new(targets, &layout, topology));
        let own = shaders.pipelines.pipeline(&program, state(modules, raster), || {
            Pipeline::graphics(device, name, &program, modules, &render_pass, targets, &layout, topology).map(named)
        })?;
        let counting = match &desc.counting {
            None => None,
            Some((fragment, test)) => {
                let mut modules = modules.clone();
                modules.pop();
                modules.push(load(fragment)?);
                let targets = targets.for_counting(*test);
                pass_check::counting(device, &desc, &program, &modules, &targets)?;
                if let Some(constants) = desc.constants {
                    (constants.check)(name, &modules)?;
                }
                let raster = Some(RasterState::new(&targets, &layout, topology));
                Some(shaders.pipelines.pipeline(&program, state(&modules, raster), || {
                    Pipeline::graphics(device, name, &program, &modules, &render_pass, &targets, &layout, topology)
                        .map(named)
                })?)
            }
        };
        let pipelines =
            Pipelines { own, counting, stride_bytes: layout.stride_bytes, element_bytes: layout.element_bytes() };
        finish(shaders, desc, pipelines, Some(render_pass))
    }
}

/// The pipelines of a pass that draws or dispatches.
pub(super) struct Pipelines {
    /// Pipeline of the pass's own draws.
    pub own: Arc<Pipeline>,
    /// Pipeline of the draws that alternate with them.
    pub counting: Option<Arc<Pipeline>>,
    /// From one element of the vertex buffer to the next; 0 without one.
    pub stride_bytes: u32,
    /// Bytes of the attributes of one element.
    pub element_bytes: u64,
}

/// Binds the resources of `desc` to pipelines that were made for it.
pub(super) fn finish(
    shaders: &ShaderLibrary,
    desc: PassDesc,
    pipelines: Pipelines,
    render_pass: Option<Arc<RenderPass>>,
) -> Result<Pass, Error> {
    let Pipelines { own: pipeline, counting, stride_bytes, element_bytes } = pipelines;
    if let Some(name) = desc.whole.iter().find(|name| !pipeline.program.slots.iter().any(|slot| slot.name == **name)) {
        return Err(desc.problem(format!("it declares {name} whole, which its shaders do not name")));
    }
    let declared = Declared::new(&desc, &pipeline.program.slots, element_bytes);
    let device = shaders.device();
    let bindings = Bindings::new(device, desc.name, &pipeline.program, &desc.resources)?;
    for pipeline in iter::once(&pipeline).chain(&counting) {
        pass_check::filters(device, &desc, pipeline)?;
    }
    let mut uses = bindings.as_ref().map(|b| b.uses.clone()).unwrap_or_default();
    let clamped_indices = Clamp::of_indices(shaders, &desc)?;
    let indices = clamped_indices.as_ref().map(|clamp| clamp.clamped.view()).or_else(|| desc.indices.clone());
    uses.extend(desc.fixed_function_uses(indices.as_ref()));
    pass_check::uses(device, desc.name, &uses)?;
    let body = match render_pass {
        None => {
            let workgroup = pass_check::workgroup(&desc, &pipeline.program)?;
            pass_check::parameters(&desc, size_of::<vk::DispatchIndirectCommand>())?;
            Body::Compute { workgroup, indirect: Clamp::of_dispatch(shaders, &desc)?.map(Box::new) }
        }
        Some(render_pass) => {
            let extent = pass_check::extent(device, &desc)?;
            pass_check::fetches(device, &desc, stride_bytes)?;
            let bounds = DrawBounds::new(&desc, stride_bytes);
            let indirect = Clamp::of_draw(shaders, &desc, bounds)?;
            Body::Graphics {
                framebuffer: Framebuffer::new(device, desc.name, &render_pass, &desc.targets, extent)?,
                render_pass,
                extent,
                clears: desc.targets.clear_values(),
                vertices: desc.vertices.clone(),
                indices,
                indirect: indirect.map(Box::new),
                clamped_indices: clamped_indices.map(Box::new),
                bounds,
            }
        }
    };
    if let Some(clamp) = body.parameters() {
        uses.push(Use { resource: (&clamp.clamped).into(), access: Access::IndirectRead, discard: false });
    }
    let mut info = desc.describe(&pipeline.program, &uses);
    info.executables = executables(device, desc.name, &pipeline)?;
    let info = Arc::new(info);
    let device = device.clone();
    let inner = Inner {
        device,
        pipeline: Some(pipeline),
        counting,
        bindings,
        uses,
        body,
        stride_bytes,
        element_bytes,
        desc,
        declared,
    };
    Ok(Pass { info, inner: Arc::new(inner) })
}
