//! Pipelines: a program with its fixed-function state.

use std::sync::Arc;

use ash::vk;

use super::access::Stages;
use super::device::Device;
use super::error::{Context, Error};
use super::live::Kind;
use super::program::{Program, stage_infos};
use super::render_pass::{RenderPass, Targets};
use super::shader::ShaderModule;
use crate::shader_build::HostBlock;
use crate::shader_build::{Format, Sampling, Scalar};

/// One attribute of a vertex: location, format, byte offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attribute {
    /// Location in the vertex stage.
    pub location: u32,
    /// Format of the field.
    pub format: vk::Format,
    /// Offset in the vertex, in bytes.
    pub offset_bytes: u32,
    /// Size in bytes.
    pub bytes: u64,
}

/// The layout of the vertices of a pass in their buffer.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct VertexLayout {
    /// From one element to the next, in bytes.
    pub stride_bytes: u32,
    /// The buffer advances with each vertex or with each instance.
    pub rate: vk::VertexInputRate,
    /// Fields that the vertex stage reads.
    pub attributes: Vec<Attribute>,
}

impl VertexLayout {
    /// The layout of a pass without a vertex buffer.
    ///
    /// # Errors
    /// [`Error::Pass`] for a vertex stage that has inputs.
    pub(crate) fn none(pass: &str, program: &Program) -> Result<Self, Error> {
        let mut vertex_stages = program.modules.iter().filter(|m| m.stage() == Stages::VERTEX);
        match vertex_stages.find_map(|m| Some((m, m.interface.inputs.first()?))) {
            None => Ok(VertexLayout::default()),
            Some((module, input)) => Err(Error::Pass {
                pass: pass.to_owned(),
                problem: format!("shader {} fetches {} and no vertex buffer is declared", module.name, input.name),
            }),
        }
    }

    /// The layout of host struct `T`, its fields matched to the vertex stage's inputs by name.
    ///
    /// # Errors
    /// [`Error::Pass`] for an input that `T` has no field of the same name and size for.
    pub(crate) fn of<T: HostBlock>(pass: &str, program: &Program) -> Result<Self, Error> {
        let mut attributes = Vec::new();
        let inputs = program.modules.iter().filter(|m| m.stage() == Stages::VERTEX).flat_map(|m| &m.interface.inputs);
        for input in inputs {
            let format = vertex_format(input.format);
            let bytes = (4 * input.format.components) as usize;
            let fits = |offset: usize| offset.is_multiple_of(4) && offset + bytes <= size_of::<T>() && input.count == 1;
            let field = T::fields().iter().find(|(name, at, size)| *name == input.name && *size == bytes && fits(*at));
            let Some(&(_, offset, _)) = field else {
                return Err(Error::Pass {
                    pass: pass.to_owned(),
                    problem: format!("{} has no field {} of {bytes} bytes for its vertex stage", T::NAME, input.name),
                });
            };
            attributes.push(Attribute {
                location: input.location,
                format,
                offset_bytes: offset as u32,
                bytes: bytes as u64,
            });
        }
        Ok(VertexLayout { stride_bytes: size_of::<T>() as u32, rate: vk::VertexInputRate::VERTEX, attributes })
    }
}

impl VertexLayout {
    /// Bytes of the attributes of one element.
    pub(crate) fn element_bytes(&self) -> u64 {
        self.attributes.iter().map(|attribute| attribute.bytes).sum()
    }

    /// # Errors
    /// [`Error::Limit`] for more attributes or longer elements than the device fetches.
    pub(crate) fn check_limits(&self, device: &Device, pass: &str) -> Result<(), Error> {
        let limits = &device.physical().limits;
        let (count, stride) = (self.attributes.len() as u32, self.stride_bytes);
        let checks = [
            ("count of vertex attributes", count, limits.max_vertex_input_attributes),
            ("size in bytes of a vertex", stride, limits.max_vertex_input_binding_stride),
            ("size in bytes of a vertex", stride, limits.max_vertex_input_attribute_offset.saturating_add(4)),
        ];
        match checks.into_iter().find(|&(_, wanted, limit)| wanted > limit) {
            Some((what, wanted, limit)) => {
                Err(Error::Limit { object: format!("pass {pass}"), what, wanted: wanted.into(), limit: limit.into() })
            }
            None if stride % 4 != 0 => {
                Err(Error::Pass { pass: pass.to_owned(), problem: "its vertices are not of whole 32-bit words".into() })
            }
            None => Ok(()),
        }
    }
}

fn vertex_format(format: Format) -> vk::Format {
    use vk::Format as F;
    let table = match format.scalar {
        Scalar::Float => [F::R32_SFLOAT, F::R32G32_SFLOAT, F::R32G32B32_SFLOAT, F::R32G32B32A32_SFLOAT],
        Scalar::Int => [F::R32_SINT, F::R32G32_SINT, F::R32G32B32_SINT, F::R32G32B32A32_SINT],
        Scalar::Uint => [F::R32_UINT, F::R32G32_UINT, F::R32G32B32_UINT, F::R32G32B32A32_UINT],
    };
    table[(format.components.clamp(1, 4) - 1) as usize]
}

/// The kind of primitive that a pass draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Topology {
    /// Three vertices a triangle.
    #[default]
    Triangles,
    /// A triangle for each vertex from the third on.
    TriangleStrip,
    /// A point for each vertex.
    Points,
    /// Two vertices a line.
    Lines,
}

/// A pipeline with its program.
pub struct Pipeline {
    /// Handle.
    pub(crate) raw: vk::Pipeline,
    device: Arc<Device>,
    /// Stages, descriptor layout and push constants.
    pub program: Arc<Program>,
    /// Textures that its stages join with samplers.
    pub(crate) samplings: Vec<Sampling>,
}

impl Pipeline {
    /// `modules` are those of `program`, or others of a part of its interface.
    #[expect(clippy::too_many_arguments, reason = "the parts of a pipeline, named once, by the pass builder alone")]
    pub(crate) fn graphics(
        device: &Arc<Device>,
        pass: &str,
        program: &Arc<Program>,
        modules: &[Arc<ShaderModule>],
        render_pass: &Arc<RenderPass>,
        targets: &Targets,
        vertices: &VertexLayout,
        topology: Topology,
    ) -> Result<Arc<Self>, Error> {
        let stages = stage_infos(modules);
        let bindings = [vk::VertexInputBindingDescription {
            binding: 0,
            stride: vertices.stride_bytes,
            input_rate: vertices.rate,
        }];
        let attributes: Vec<_> = vertices
            .attributes
            .iter()
            .map(|a| vk::VertexInputAttributeDescription {
                location: a.location,
                binding: 0,
                format: a.format,
                offset: a.offset_bytes,
            })
            .collect();
        let mut vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
        if !attributes.is_empty() {
            vertex_input =
                vertex_input.vertex_binding_descriptions(&bindings).vertex_attribute_descriptions(&attributes);
        }
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(match topology {
            Topology::Triangles => vk::PrimitiveTopology::TRIANGLE_LIST,
            Topology::TriangleStrip => vk::PrimitiveTopology::TRIANGLE_STRIP,
            Topology::Points => vk::PrimitiveTopology::POINT_LIST,
            Topology::Lines => vk::PrimitiveTopology::LINE_LIST,
        });
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let rasterization = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(targets.culled)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .line_width(1.0);
        let multisample =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = targets.depth.as_ref().map(|(_, test)| test.state()).unwrap_or_default();
        let blends: Vec<_> = targets.colors.iter().map(|(_, blend)| blend.state()).collect();
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let dynamic = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .flags(flags(device))
            .stages(&stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&multisample)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(program.layout)
            .render_pass(render_pass.raw);
        // SAFETY: every state lives until the call returns; modules, layout and render pass are alive.
        let made = unsafe { device.raw.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
        Self::guard(device, pass, program, modules, made)
    }

    pub(crate) fn compute(device: &Arc<Device>, pass: &str, program: &Arc<Program>) -> Result<Arc<Self>, Error> {
        let stages = stage_infos(&program.modules);
        let [stage] = stages[..] else {
            return Err(Error::Pass { pass: pass.to_owned(), problem: "a compute pass has one shader".into() });
        };
        let info = vk::ComputePipelineCreateInfo::default().flags(flags(device)).stage(stage).layout(program.layout);
        // SAFETY: the module and the layout are alive.
        let made = unsafe { device.raw.create_compute_pipelines(vk::PipelineCache::null(), &[info], None) };
        Self::guard(device, pass, program, &program.modules, made)
    }

    fn guard(
        device: &Arc<Device>,
        pass: &str,
        program: &Arc<Program>,
        modules: &[Arc<ShaderModule>],
        made: Result<Vec<vk::Pipeline>, (Vec<vk::Pipeline>, vk::Result)>,
    ) -> Result<Arc<Self>, Error> {
        // A failed creation of one pipeline leaves a null handle, which needs no freeing.
        let raw = made.map_err(|(_, result)| result).context("creating the pipeline of pass", pass)?[0];
        device.live().add(Kind::Pipeline);
        device.name(raw, pass);
        let samplings = modules.iter().flat_map(|module| module.interface.samplings.iter().copied()).collect();
        Ok(Arc::new(Pipeline { raw, device: device.clone(), program: program.clone(), samplings }))
    }
}

/// A profiled device's driver keeps what it knows of the pipeline.
fn flags(device: &Device) -> vk::PipelineCreateFlags {
    if device.physical().keeps_executables() {
        vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR | vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR
    } else {
        vk::PipelineCreateFlags::empty()
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        // SAFETY: a frame keeps the passes that hold this pipeline until its fence.
        unsafe { self.device.raw.destroy_pipeline(self.raw, None) };
        self.device.live().remove(Kind::Pipeline);
    }
}

/// Checks a host struct against the push constants of the stages.
///
/// # Errors
/// [`Error::Pass`] naming the first field that differs.
pub(crate) fn check_constants<T: HostBlock>(pass: &str, modules: &[Arc<ShaderModule>]) -> Result<(), Error> {
    check_block(pass, modules, T::NAME, size_of::<T>(), T::fields())
}

fn check_block(
    pass: &str,
    modules: &[Arc<ShaderModule>],
    name: &str,
    size_bytes: usize,
    fields: &[(&str, usize, usize)],
) -> Result<(), Error> {
    let problem = |problem: String| Error::Pass { pass: pass.to_owned(), problem };
    let mut found = false;
    for module in modules {
        if let Some(block) = &module.interface.push_constants {
            found = true;
            block
                .check_layout(name, size_bytes, fields)
                .map_err(|e| problem(format!("push constants of shader {}: {e}", module.name)))?;
        }
    }
    if found { Ok(()) } else { Err(problem(format!("its shaders take no push constants, {name} is given"))) }
}
