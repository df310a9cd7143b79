//! Limits of the device that stages and their descriptors keep to. Drivers may fail beyond them, or draw anything.

use ash::vk;

use super::access::Stages;
use super::device::Device;
use super::error::Error;
use super::physical::Feature;
use super::program::Slot;
use super::shader::ShaderModule;
use crate::shader_build::{BindingKind, Location, Stage};

/// A count beside the device's limit of it.
type Counted = (&'static str, u64, u32);

/// # Errors
/// [`Error::Limit`] of the first that is beyond its limit.
fn check(object: impl Fn() -> String, counts: impl IntoIterator<Item = Counted>) -> Result<(), Error> {
    match counts.into_iter().find(|&(_, wanted, limit)| wanted > limit.into()) {
        None => Ok(()),
        Some((what, wanted, limit)) => Err(Error::Limit { object: object(), what, wanted, limit: limit.into() }),
    }
}

/// Interface, workgroup and output of one stage.
pub(super) fn stage(device: &Device, pass: &str, module: &ShaderModule) -> Result<(), Error> {
    let limits = &device.physical().limits;
    let interface = &module.interface;
    let ends = |places: &[Location]| {
        places.iter().map(|place| u64::from(place.location) + u64::from(place.count)).max().unwrap_or(0)
    };
    let (inputs, outputs) = (ends(&interface.inputs), ends(&interface.outputs));
    let components = |places: &[Location], built_ins: u64| {
        let end = |place: &Location| {
            let last = u64::from(place.location) + u64::from(place.count.max(1)) - 1;
            4 * last + u64::from(place.format.components)
        };
        places.iter().map(end).max().unwrap_or(0).saturating_add(built_ins)
    };
    let [taken_built_ins, given_built_ins] = interface.built_in_components;
    let (all_inputs, all_outputs) =
        (components(&interface.inputs, taken_built_ins), components(&interface.outputs, given_built_ins));
    // Limits of varyings are told in components, four of which make up a location. Built-ins have none, and count as well.
    let taken = |limit: u32| {
        [
            ("count of locations that a stage takes from another", inputs, limit / 4),
            ("count of components that a stage takes, built-ins among them,", all_inputs, limit),
        ]
    };
    let given = |limit: u32| {
        [
            ("count of locations that a stage gives to another", outputs, limit / 4),
            ("count of components that a stage gives, built-ins among them,", all_outputs, limit),
        ]
    };
    let mut counts: Vec<Counted> = Vec::new();
    match interface.stage {
        Stage::Vertex => {
            counts.push(("count of locations of vertex attributes", inputs, limits.max_vertex_input_attributes));
            counts.extend(given(limits.max_vertex_output_components));
        }
        Stage::Geometry => {
            let vertices = u64::from(interface.emitted_vertices.unwrap_or(0));
            if vertices == 0 {
                let problem = format!("its geometry shader {} emits no vertices", module.name);
                return Err(Error::Pass { pass: pass.to_owned(), problem });
            }
            let components = |place: &Location| u64::from(place.count) * u64::from(place.format.components);
            // With its place: of the block of built-ins no more is written by any shader of ours.
            let of_vertex = 4 + interface.outputs.iter().map(components).sum::<u64>();
            let invocations = u64::from(interface.invocations.unwrap_or(1));
            counts.extend(taken(limits.max_geometry_input_components));
            counts.extend(given(limits.max_geometry_output_components));
            counts.extend([
                ("count of vertices of a geometry stage", vertices, limits.max_geometry_output_vertices),
                (
                    "count of components of a geometry stage's vertices",
                    vertices * of_vertex,
                    limits.max_geometry_total_output_components,
                ),
                ("count of invocations of a geometry stage", invocations, limits.max_geometry_shader_invocations),
            ]);
        }
        Stage::Fragment => {
            counts.extend(taken(limits.max_fragment_input_components));
            counts.push(("count of locations of colours", outputs, limits.max_fragment_output_attachments));
        }
        Stage::Compute => {
            let size = interface.local_size.unwrap_or([1; 3]);
            let along = |(threads, limit)| ("threads of a workgroup along one axis", u64::from(threads), limit);
            counts.extend(size.into_iter().zip(limits.max_compute_work_group_size).map(along));
            let threads: u64 = size.into_iter().map(u64::from).product();
            counts.extend([
                ("threads of a workgroup", threads, limits.max_compute_work_group_invocations),
                ("bytes that a workgroup shares", interface.shared_bytes, limits.max_compute_shared_memory_size),
            ]);
        }
    }
    check(|| format!("pass {pass} (shader {})", module.name), counts)
}

/// Descriptors of each stage and in all, and none that is written by a stage that may not write.
pub(super) fn descriptors(device: &Device, pass: &str, slots: &[Slot]) -> Result<(), Error> {
    let limits = &device.physical().limits;
    type OfKind = fn(&BindingKind) -> bool;
    let kinds: [(&str, OfKind, u32, u32); 5] = [
        (
            "uniform buffers",
            |kind| matches!(kind, BindingKind::UniformBuffer),
            limits.max_per_stage_descriptor_uniform_buffers,
            limits.max_descriptor_set_uniform_buffers,
        ),
        (
            "storage buffers",
            |kind| matches!(kind, BindingKind::StorageBuffer { .. }),
            limits.max_per_stage_descriptor_storage_buffers,
            limits.max_descriptor_set_storage_buffers,
        ),
        (
            "sampled images",
            |kind| matches!(kind, BindingKind::SampledImage | BindingKind::CombinedImageSampler),
            limits.max_per_stage_descriptor_sampled_images,
            limits.max_descriptor_set_sampled_images,
        ),
        (
            "storage images",
            |kind| matches!(kind, BindingKind::StorageImage { .. }),
            limits.max_per_stage_descriptor_storage_images,
            limits.max_descriptor_set_storage_images,
        ),
        (
            "samplers",
            |kind| matches!(kind, BindingKind::Sampler | BindingKind::CombinedImageSampler),
            limits.max_per_stage_descriptor_samplers,
            limits.max_descriptor_set_samplers,
        ),
    ];
    for (name, is_of_kind, of_stage, in_all) in kinds {
        let count = |stages: Stages| {
            slots.iter().filter(|slot| slot.stages.contains(stages) && is_of_kind(&slot.kind)).count() as u64
        };
        let stages = Stages::EACH.map(|stage| ("count of descriptors of one stage", count(stage), of_stage));
        let all = ("count of descriptors", count(Stages::NONE), in_all);
        check(|| format!("pass {pass} ({name})"), stages.into_iter().chain([all]))?;
    }
    for stage in Stages::EACH {
        resources(device, pass, slots, stage, 0)?;
        let may_write = match stage {
            Stages::COMPUTE => true,
            Stages::FRAGMENT => device.physical().has(Feature::FragmentStores),
            _ => false,
        };
        if let (false, Some(slot)) = (may_write, slots.iter().find(|slot| slot.is_written_by(stage))) {
            let problem =
                format!("its stage {stage:?} declares {} without readonly, which the device does not take", slot.name);
            return Err(Error::Pass { pass: pass.to_owned(), problem });
        }
    }
    Ok(())
}

/// Colour attachments count as resources of the fragment stage, and those that it writes beside what it stores.
pub(super) fn attachments(
    device: &Device,
    pass: &str,
    slots: &[Slot],
    fragment: &ShaderModule,
    colors: usize,
) -> Result<(), Error> {
    resources(device, pass, slots, Stages::FRAGMENT, colors)?;
    let stored = slots.iter().filter(|slot| slot.is_written_by(Stages::FRAGMENT)).count() as u64;
    let drawn: u64 = fragment.interface.outputs.iter().map(|output| u64::from(output.count)).sum();
    let limit = device.physical().limits.max_fragment_combined_output_resources;
    let what = "count of colours, storage buffers and storage images that the fragment stage writes";
    check(|| format!("pass {pass}"), [(what, stored + drawn, limit)])
}

fn resources(device: &Device, pass: &str, slots: &[Slot], stage: Stages, colors: usize) -> Result<(), Error> {
    let wanted = slots.iter().filter(|slot| slot.stages.contains(stage)).count() + colors;
    let limit = device.physical().limits.max_per_stage_resources;
    check(|| format!("pass {pass}"), [("count of descriptors and colours of one stage", wanted as u64, limit)])
}

/// The extent that a pass draws over, which is that of its viewport too.
pub(super) fn extent(device: &Device, pass: &str, extent: vk::Extent2D) -> Result<(), Error> {
    let limits = &device.physical().limits;
    let [across, down] = limits.max_viewport_dimensions;
    let counts = [
        ("width in pixels", extent.width.into(), limits.max_framebuffer_width.min(across)),
        ("height in pixels", extent.height.into(), limits.max_framebuffer_height.min(down)),
    ];
    check(|| format!("pass {pass}"), counts)
}
