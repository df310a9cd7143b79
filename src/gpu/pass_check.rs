//! The checks of a pass when it is built: stages against each other, attachments against the fragment stage, buffers
//! and images against their use, everything against the device's limits. Vulkan leaves all of it to the caller.

use std::sync::Arc;

use ash::vk;

use super::access::{Access, Stages};
use super::bindings::{Resource, Use};
use super::buffer::BufferView;
use super::device::Device;
use super::error::Error;
use super::format::format_info;
use super::image::ImageView;
use super::pass::Workgroup;
use super::pass_builder::PassDesc;
use super::pass_info::PassKind;
use super::physical::Feature;
use super::pipeline::{Pipeline, Topology};
use super::program::{Program, Slot};
use super::render_pass::{Blend, Load, Targets};
use super::shader::ShaderModule;
use super::stage_limits;
use crate::shader_build::{BindingKind, Location, Scalar};

/// The stages are those of the pass's kind, and each takes what the one before it gives.
pub(super) fn stages(device: &Device, desc: &PassDesc, modules: &[Arc<ShaderModule>]) -> Result<(), Error> {
    let stages: Vec<Stages> = modules.iter().map(|m| m.stage()).collect();
    let fits = match desc.kind {
        PassKind::Compute => stages == [Stages::COMPUTE],
        _ => {
            stages == [Stages::VERTEX, Stages::FRAGMENT]
                || stages == [Stages::VERTEX, Stages::GEOMETRY, Stages::FRAGMENT]
        }
    };
    if !fits {
        let kind = desc.kind.as_str();
        return Err(desc.problem(format!("{} are not the stages of a {kind} pass", desc.shaders.join(", "))));
    }
    let draws = !desc.targets.colors.is_empty()
        || desc.targets.depth.is_some()
        || desc.targets.extent.is_some()
        || desc.vertices.is_some()
        || desc.indices.is_some()
        || desc.counting.is_some();
    if desc.kind == PassKind::Compute && draws {
        return Err(desc.problem("a compute pass has neither attachments nor vertices"));
    }
    let topology_vertices = match desc.topology {
        Topology::Points => 1,
        Topology::Lines => 2,
        Topology::Triangles | Topology::TriangleStrip => 3,
    };
    // A geometry stage gives points of one pixel: no device is opened with the feature that lets it say more.
    let before_raster = modules.iter().rfind(|m| m.stage() != Stages::FRAGMENT);
    if let (Some(module), Topology::Points) = (before_raster, desc.topology)
        && module.stage() == Stages::VERTEX
        && !module.interface.writes_point_size
    {
        return Err(desc.problem(format!("draws points, and shader {} writes no gl_PointSize", module.name)));
    }
    for module in modules.iter().filter(|m| m.stage() == Stages::GEOMETRY) {
        if module.interface.primitive_vertices != Some(topology_vertices) {
            let topology = desc.topology;
            return Err(desc.problem(format!("shader {} does not take {topology:?}", module.name)));
        }
    }
    linked(device, desc, modules)
}

/// Every input of a stage is an output of the one before it, of the same type and wide enough.
fn linked(device: &Device, desc: &PassDesc, modules: &[Arc<ShaderModule>]) -> Result<(), Error> {
    let may_narrow = device.physical().has(Feature::Maintenance4);
    for pair in modules.windows(2) {
        for input in &pair[1].interface.inputs {
            let fed = |at: u32| {
                pair[0].interface.outputs.iter().any(|output| {
                    let (given, taken) = (output.format, input.format);
                    takes(output, at)
                        && given.scalar == taken.scalar
                        && (given.components == taken.components || (may_narrow && given.components > taken.components))
                })
            };
            if !(input.location..input.location.saturating_add(input.count)).all(fed) {
                let (from, to) = (&pair[0].name, &pair[1].name);
                return Err(desc.problem(format!("shader {to} takes {}, which {from} does not give it", input.name)));
            }
        }
    }
    Ok(())
}

fn takes(place: &Location, at: u32) -> bool {
    place.location <= at && at - place.location < place.count
}

/// The attachments suit the device, and the fragment stage writes each with values of its type.
pub(super) fn targets(device: &Arc<Device>, desc: &PassDesc, program: &Program) -> Result<(), Error> {
    attachments(device, desc)?;
    let Some(fragment) = program.modules.last() else { return Ok(()) };
    stage_limits::attachments(device, desc.name, &program.slots, fragment, desc.targets.colors.len())?;
    outputs(desc, fragment, &desc.targets)
}

/// Every attachment is written with values of its type, a masked one with those or none.
fn outputs(desc: &PassDesc, fragment: &ShaderModule, targets: &Targets) -> Result<(), Error> {
    for (at, (target, blend)) in (0..).zip(&targets.colors) {
        let output = fragment.interface.outputs.iter().find(|output| takes(output, at));
        let given = output.map(|output| output.format.scalar);
        if given != scalar_of(&target.view) && (given.is_some() || *blend != Blend::Masked) {
            let (shader, image) = (&fragment.name, target.view.image().name());
            return Err(desc.problem(format!("shader {shader} writes no value of its type to target {at}, {image}")));
        }
    }
    Ok(())
}

fn scalar_of(view: &ImageView) -> Option<Scalar> {
    format_info(view.image().desc().format).map(|info| info.scalar)
}

/// The attachments may be such, and the device may blend into them.
pub(super) fn attachments(device: &Arc<Device>, desc: &PassDesc) -> Result<(), Error> {
    desc.targets.check(desc.name)?;
    let _ = extent(device, desc)?;
    let limit = device.physical().limits.max_color_attachments;
    check_limit(desc, "count of colour attachments", desc.targets.colors.len() as u64, limit)?;
    let check = |view: &Arc<ImageView>, usage, aspect| {
        Resource::from(view).check_device(device, desc.name)?;
        let image = view.image();
        let name = image.name();
        if !image.desc().usage.contains(usage) || !image.aspect().contains(aspect) || view.aspect != image.aspect() {
            return Err(desc.problem(format!("image {name} was not made to be this attachment: {usage:?}")));
        }
        if view.layer_count() != 1 {
            return Err(desc.problem(format!("draws into all {} layers of {name}; give one", view.layer_count())));
        }
        Ok(())
    };
    for (target, blend) in &desc.targets.colors {
        check(&target.view, vk::ImageUsageFlags::COLOR_ATTACHMENT, vk::ImageAspectFlags::COLOR)?;
        let format = target.view.image().desc().format;
        let features = device.format_features(format);
        let is_blended = !matches!(blend, Blend::Replace | Blend::Masked);
        if is_blended && !features.contains(vk::FormatFeatureFlags::COLOR_ATTACHMENT_BLEND) {
            let name = target.view.image().name();
            return Err(desc.problem(format!("this device does not blend into {format:?}, which {name} has")));
        }
    }
    if let Some((target, test)) = &desc.targets.depth {
        let aspect = if test.has_stencil() {
            vk::ImageAspectFlags::DEPTH | vk::ImageAspectFlags::STENCIL
        } else {
            vk::ImageAspectFlags::DEPTH
        };
        check(&target.view, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT, aspect)?;
    }
    Ok(())
}

/// The second fragment stage lives with the layouts and the vertex stage of the first.
pub(super) fn counting(
    device: &Arc<Device>,
    desc: &PassDesc,
    program: &Program,
    modules: &[Arc<ShaderModule>],
    targets: &Targets,
) -> Result<(), Error> {
    stages(device, desc, modules)?;
    let mut alone = PassDesc { targets: targets.clone(), ..desc.clone() };
    if let (Some((own, test)), Some((target, counting))) = (&desc.targets.depth, &mut alone.targets.depth) {
        if test.access() == Access::DepthReadOnly && counting.access() != Access::DepthReadOnly {
            let name = own.view.image().name();
            return Err(desc.problem(format!("its counting draws write depth {name}, which it declares read only")));
        }
        // The render pass is the pass's own, which loads as its own test may.
        target.load = Load::Keep;
    }
    attachments(device, &alone)?;
    let Some(fragment) = modules.last() else { return Ok(()) };
    stage_limits::stage(device, desc.name, fragment)?;
    stage_limits::attachments(device, desc.name, &program.slots, fragment, targets.colors.len())?;
    outputs(desc, fragment, targets)?;
    for binding in &fragment.interface.bindings {
        let block_bytes = binding.block.as_ref().map(|block| block.size_bytes);
        let known = |slot: &Slot| {
            slot.binding == binding.binding
                && (&slot.name, slot.kind, slot.image) == (&binding.name, binding.kind, binding.image)
                && slot.block_bytes >= block_bytes
                && slot.stages.contains(Stages::FRAGMENT)
        };
        if binding.set != 0 || binding.count != 1 || !program.slots.iter().any(known) {
            let (name, shader) = (&binding.name, &fragment.name);
            return Err(desc.problem(format!("shader {shader} reads {name}, which the pass's own does not read so")));
        }
    }
    if let Some(block) = &fragment.interface.push_constants
        && (block.size_bytes > program.push_bytes || !program.push_stages.contains(vk::ShaderStageFlags::FRAGMENT))
    {
        return Err(desc.problem(format!("shader {} takes push constants that the pass's own does not", fragment.name)));
    }
    Ok(())
}

/// An image that is joined with a linear sampler is of a format that the device filters, and no sampler is taken for one that
/// compares.
pub(super) fn filters(device: &Device, desc: &PassDesc, pipeline: &Pipeline) -> Result<(), Error> {
    let bound = |kind: BindingKind, binding: Option<u32>| {
        let slots = pipeline.program.slots.iter();
        let slots = slots.filter(move |slot| slot.kind == kind && binding.is_none_or(|at| slot.binding == at));
        slots.filter_map(|slot| desc.resources.iter().find(|(name, _)| *name == slot.name))
    };
    for sampling in &pipeline.samplings {
        for (filter, sampler) in bound(BindingKind::Sampler, sampling.sampler) {
            if sampling.compares {
                return Err(desc.problem(format!("compares with texels through {filter}, which no sampler does")));
            }
            if !matches!(sampler, Resource::Sampler(sampler) if sampler.is_linear) {
                continue;
            }
            for (name, texture) in bound(BindingKind::SampledImage, sampling.texture) {
                let Resource::Image(view) = texture else { continue };
                let format = view.image().desc().format;
                if !device.format_features(format).contains(vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR) {
                    let problem = format!("reads {name} through {filter}, and this device does not filter {format:?}");
                    return Err(desc.problem(format!("{problem}; give a sampler of the nearest texel")));
                }
            }
        }
    }
    Ok(())
}

/// All is of this device, and nothing that is written is touched a second time in the same pass.
pub(super) fn uses(device: &Arc<Device>, pass: &str, uses: &[Use]) -> Result<(), Error> {
    for (i, a) in uses.iter().enumerate() {
        a.resource.check_device(device, pass)?;
        for b in &uses[..i] {
            let (one, other) = (a.access.info(), b.access.info());
            let conflict = match (&a.resource, &b.resource) {
                (Resource::Image(x), Resource::Image(y)) => {
                    Arc::ptr_eq(&x.image, &y.image)
                        && x.layers.start < y.layers.end
                        && y.layers.start < x.layers.end
                        && (one.layout != other.layout || one.writes || other.writes)
                }
                (Resource::Buffer(x), Resource::Buffer(y)) => {
                    Arc::ptr_eq(&x.buffer, &y.buffer)
                        && x.range.start < y.range.end
                        && y.range.start < x.range.end
                        && (one.writes || other.writes)
                }
                _ => false,
            };
            if conflict {
                let kind = if matches!(a.resource, Resource::Image(_)) { "image" } else { "buffer" };
                let problem = format!("uses {kind} {} in two ways at once", a.resource.name());
                return Err(Error::Pass { pass: pass.to_owned(), problem });
            }
        }
    }
    Ok(())
}

/// The workgroups of the compute stage.
pub(super) fn workgroup(desc: &PassDesc, program: &Program) -> Result<Workgroup, Error> {
    let interface = program.modules.first().map(|module| &module.interface);
    let Some((interface, size)) = interface.and_then(|i| i.local_size.map(|size| (i, size))) else {
        return Err(desc.problem("its shader does not say how large a workgroup is"));
    };
    if size.contains(&0) {
        return Err(desc.problem("its workgroup has no threads"));
    }
    Ok(Workgroup { size, lies_in_rows: interface.lies_in_rows })
}

/// The extent that the pass draws over.
pub(super) fn extent(device: &Device, desc: &PassDesc) -> Result<vk::Extent2D, Error> {
    let extent = desc.targets.extent().ok_or_else(|| desc.problem("it has neither attachments nor an extent"))?;
    stage_limits::extent(device, desc.name, extent)?;
    if extent.width == 0 || extent.height == 0 { Err(desc.problem("its extent is empty")) } else { Ok(extent) }
}

/// The buffers that draws fetch from were made for it.
pub(super) fn fetches(device: &Device, desc: &PassDesc, stride_bytes: u32) -> Result<(), Error> {
    let made_for = |view: &Option<BufferView>, usage, kind: &str| match view {
        Some(view) if !view.buffer.usage().contains(usage) => {
            Err(desc.problem(format!("{} is no {kind} buffer", view.buffer.name())))
        }
        _ => Ok(()),
    };
    made_for(&desc.vertices, vk::BufferUsageFlags::VERTEX_BUFFER, "vertex")?;
    made_for(&desc.indices, vk::BufferUsageFlags::INDEX_BUFFER, "index")?;
    if let (Some(vertices), Some(_), true) = (&desc.vertices, &desc.indices, stride_bytes > 0) {
        // Indices beyond the vertices fetch nothing; those within them must be values that the device takes.
        let last = (vertices.len_bytes() / u64::from(stride_bytes)).saturating_sub(1);
        check_limit(desc, "index of a vertex", last, device.physical().largest_index())?;
    }
    parameters(desc, size_of::<vk::DrawIndexedIndirectCommand>())?;
    if desc.indirect.is_some() && desc.indices.is_none() {
        return Err(desc.problem("draws indices by an indirect buffer, and no index buffer is bound"));
    }
    Ok(())
}

/// The buffer that indirect commands take their `wanted` bytes of parameters from was made for it.
pub(super) fn parameters(desc: &PassDesc, wanted: usize) -> Result<(), Error> {
    let Some(parameters) = &desc.indirect else { return Ok(()) };
    let is_indirect = parameters.buffer.usage().contains(vk::BufferUsageFlags::INDIRECT_BUFFER);
    if parameters.len_bytes() < wanted as u64 || !is_indirect {
        let name = parameters.buffer.name();
        return Err(desc.problem(format!("{name} is no indirect buffer of {wanted} bytes")));
    }
    Ok(())
}

fn check_limit(desc: &PassDesc, what: &'static str, wanted: u64, limit: u32) -> Result<(), Error> {
    if wanted <= u64::from(limit) {
        return Ok(());
    }
    Err(Error::Limit { object: format!("pass {}", desc.name), what, wanted, limit: limit.into() })
}
