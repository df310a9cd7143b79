//! Pipelines as a driver's compiler made them (`VK_KHR_pipeline_executable_properties`): an executable a stage.

use ash::vk;

use super::{list, next, state, write};
use crate::calls;

/// Notes the stages of new pipelines.
fn made(pipelines: &[vk::Pipeline], of: impl Iterator<Item = (vk::ShaderStageFlags, vk::PipelineCreateFlags)>) {
    let kept =
        vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR | vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR;
    let mut state = state();
    for (pipeline, (stages, flags)) in pipelines.iter().zip(of) {
        state.pipelines.insert(ash::vk::Handle::as_raw(*pipeline), (stages, flags.contains(kept)));
    }
}

pub unsafe extern "system" fn create_graphics(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'static>,
    allocator: *const vk::AllocationCallbacks<'static>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    // SAFETY: as in `extensions`.
    unsafe {
        let next: vk::PFN_vkCreateGraphicsPipelines = next("vkCreateGraphicsPipelines");
        let result = next(device, cache, count, infos, allocator, pipelines);
        if result == vk::Result::SUCCESS {
            let infos = std::slice::from_raw_parts(infos, count as usize);
            let stages = infos.iter().map(|info| {
                let stages = std::slice::from_raw_parts(info.p_stages, info.stage_count as usize);
                (stages.iter().fold(vk::ShaderStageFlags::empty(), |all, one| all | one.stage), info.flags)
            });
            made(std::slice::from_raw_parts(pipelines, count as usize), stages);
        }
        result
    }
}

pub unsafe extern "system" fn create_compute(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::ComputePipelineCreateInfo<'static>,
    allocator: *const vk::AllocationCallbacks<'static>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    // SAFETY: as in `extensions`.
    unsafe {
        let next: vk::PFN_vkCreateComputePipelines = next("vkCreateComputePipelines");
        let result = next(device, cache, count, infos, allocator, pipelines);
        if result == vk::Result::SUCCESS {
            let infos = std::slice::from_raw_parts(infos, count as usize);
            let stages = infos.iter().map(|info| (info.stage.stage, info.flags));
            made(std::slice::from_raw_parts(pipelines, count as usize), stages);
        }
        result
    }
}

/// Stages of a pipeline, one executable each.
fn stages(pipeline: vk::Pipeline, is_told: bool) -> Vec<vk::ShaderStageFlags> {
    let mut state = state();
    let known = state.pipelines.get(&ash::vk::Handle::as_raw(pipeline)).copied();
    state.check(known.is_some(), "executables of a pipeline that was not made");
    let (stages, is_kept) = known.unwrap_or_default();
    state.check(is_kept || !is_told, "what is known of a pipeline that was not made to keep it");
    let all = [
        vk::ShaderStageFlags::VERTEX,
        vk::ShaderStageFlags::GEOMETRY,
        vk::ShaderStageFlags::FRAGMENT,
        vk::ShaderStageFlags::COMPUTE,
    ];
    all.into_iter().filter(|stage| stages.contains(*stage)).collect()
}

pub unsafe extern "system" fn executables(
    _device: vk::Device,
    info: *const vk::PipelineInfoKHR<'_>,
    count: *mut u32,
    found: *mut vk::PipelineExecutablePropertiesKHR<'_>,
) -> vk::Result {
    if let Some(failure) = calls::counted("vkGetPipelineExecutablePropertiesKHR") {
        return failure;
    }
    // SAFETY: as in `extensions`.
    unsafe {
        let all = stages((*info).pipeline, false).into_iter().map(|stage| {
            let mut one =
                vk::PipelineExecutablePropertiesKHR { stages: stage, subgroup_size: 32, ..Default::default() };
            write(&mut one.name, &format!("played {stage:?}"));
            write(&mut one.description, "a stage as the tests' layer plays it");
            one
        });
        list(all.collect(), count, found)
    }
}

pub unsafe extern "system" fn statistics(
    _device: vk::Device,
    info: *const vk::PipelineExecutableInfoKHR<'_>,
    count: *mut u32,
    found: *mut vk::PipelineExecutableStatisticKHR<'_>,
) -> vk::Result {
    use vk::PipelineExecutableStatisticFormatKHR as Format;
    if let Some(failure) = calls::counted("vkGetPipelineExecutableStatisticsKHR") {
        return failure;
    }
    let one = |name: &str, format, value| {
        let mut one = vk::PipelineExecutableStatisticKHR { format, value, ..Default::default() };
        write(&mut one.name, name);
        one
    };
    // SAFETY: as in `extensions`.
    unsafe {
        let index = (*info).executable_index;
        let is_there = (index as usize) < stages((*info).pipeline, true).len();
        state().check(is_there, "statistics of a stage that there is not");
        let value = |set: &dyn Fn(&mut vk::PipelineExecutableStatisticValueKHR)| {
            let mut value = vk::PipelineExecutableStatisticValueKHR::default();
            set(&mut value);
            value
        };
        let all = vec![
            one("registers", Format::UINT64, value(&|value| value.u64 = 24 + u64::from(index))),
            one("spills", Format::INT64, value(&|value| value.i64 = -1)),
            one("occupancy", Format::FLOAT64, value(&|value| value.f64 = 0.75)),
            one("uses scratch", Format::BOOL32, value(&|value| value.b32 = vk::TRUE)),
        ];
        list(all, count, found)
    }
}

pub unsafe extern "system" fn representations(
    _device: vk::Device,
    _info: *const vk::PipelineExecutableInfoKHR<'_>,
    count: *mut u32,
    found: *mut vk::PipelineExecutableInternalRepresentationKHR<'_>,
) -> vk::Result {
    if let Some(failure) = calls::counted("vkGetPipelineExecutableInternalRepresentationsKHR") {
        return failure;
    }
    let all: [(&str, vk::Bool32, &[u8]); 2] =
        [("assembly", vk::TRUE, b"mov r0, r1\nexit\0"), ("binary", vk::FALSE, &[0xff, 0, 7])];
    // SAFETY: as in `extensions`.
    unsafe {
        if found.is_null() {
            *count = all.len() as u32;
            return vk::Result::SUCCESS;
        }
        for (index, (name, is_text, bytes)) in all.into_iter().enumerate().take(*count as usize) {
            let one = &mut *found.add(index);
            write(&mut one.name, name);
            one.is_text = is_text;
            if !one.p_data.is_null() {
                let room = one.data_size.min(bytes.len());
                std::ptr::copy_nonoverlapping(bytes.as_ptr(), one.p_data.cast(), room);
            }
            one.data_size = bytes.len();
        }
    }
    vk::Result::SUCCESS
}
