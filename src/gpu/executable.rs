//! A pass as the driver's compiler made it: registers, spills, occupancy, instructions, as far as the device tells
//! (`VK_KHR_pipeline_executable_properties`).

use std::sync::Arc;

use ash::{khr, vk};

use super::device::Device;
use super::error::{Context, Error};
use super::messages::text;
use super::pipeline::Pipeline;

const ASKING: &str = "asking what the driver made of pass";

/// A value that the driver states.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExecutableStatistic {
    /// The driver's name for it.
    pub name: String,
    /// The value, as text: the driver decides on its type.
    pub value: String,
}

/// One compiled stage, or several as one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Executable {
    /// The driver's name for it.
    pub name: String,
    /// The driver's words on it.
    pub description: String,
    /// Threads that run in step; 0 where the driver tells none.
    pub subgroup_size: u32,
    /// Registers, spills, occupancy and the like.
    pub statistics: Vec<ExecutableStatistic>,
    /// Texts by their names: the machine's instructions, and what came before them.
    pub texts: Vec<(String, String)>,
}

/// The compiled stages of a pipeline; `None` where the device tells nothing or was not opened as
/// [profiled](super::PhysicalDevice::profiled).
///
/// # Errors
/// Any error of Vulkan.
pub(super) fn executables(
    device: &Arc<Device>,
    pass: &str,
    pipeline: &Pipeline,
) -> Result<Option<Vec<Executable>>, Error> {
    if !device.physical().keeps_executables() {
        return Ok(None);
    }
    let calls = khr::pipeline_executable_properties::Device::new(&device.instance().raw, &device.raw);
    let info = vk::PipelineInfoKHR::default().pipeline(pipeline.raw);
    // SAFETY: the pipeline is alive, and the device was opened with the extension and its feature.
    let found = unsafe { calls.get_pipeline_executable_properties(&info) }.context(ASKING, pass)?;
    let mut executables = Vec::with_capacity(found.len());
    for (index, properties) in found.iter().enumerate() {
        let info = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline.raw).executable_index(index as u32);
        // SAFETY: as above; the pipeline was created to keep statistics, and has this executable.
        let statistics = unsafe { calls.get_pipeline_executable_statistics(&info) }.context(ASKING, pass)?;
        let statistics = statistics.iter().map(|one| ExecutableStatistic { name: text(&one.name), value: value(one) });
        executables.push(Executable {
            name: text(&properties.name),
            description: text(&properties.description),
            subgroup_size: properties.subgroup_size,
            statistics: statistics.collect(),
            texts: representations(device, pass, &calls, &info)?,
        });
    }
    Ok(Some(executables))
}

/// The texts among the representations. They are asked for twice: their sizes first.
fn representations(
    device: &Device,
    pass: &str,
    calls: &khr::pipeline_executable_properties::Device,
    info: &vk::PipelineExecutableInfoKHR<'_>,
) -> Result<Vec<(String, String)>, Error> {
    // SAFETY: as in `executables`; the pipeline was created to keep representations.
    let sizes = unsafe { calls.get_pipeline_executable_internal_representations(info) }.context(ASKING, pass)?;
    let mut bytes: Vec<Vec<u8>> = sizes.iter().map(|one| vec![0; one.data_size]).collect();
    let mut filled: Vec<_> = bytes
        .iter_mut()
        .map(|bytes| {
            let mut one = vk::PipelineExecutableInternalRepresentationKHR::default();
            (one.data_size, one.p_data) = (bytes.len(), bytes.as_mut_ptr().cast());
            one
        })
        .collect();
    let mut count = filled.len() as u32;
    // SAFETY: as above; each structure has room for the size that the driver stated, and there are `count` of them.
    unsafe {
        (calls.fp().get_pipeline_executable_internal_representations_khr)(
            device.raw.handle(),
            info,
            &mut count,
            filled.as_mut_ptr(),
        )
    }
    .result()
    .context(ASKING, pass)?;
    let named: Vec<(String, bool)> =
        filled.iter().take(count as usize).map(|one| (text(&one.name), one.is_text == vk::TRUE)).collect();
    let texts = named.into_iter().zip(bytes).filter(|((_, is_text), _)| *is_text).map(|((name, _), bytes)| {
        let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
        (name, String::from_utf8_lossy(&bytes[..end]).into_owned())
    });
    Ok(texts.collect())
}

fn value(statistic: &vk::PipelineExecutableStatisticKHR<'_>) -> String {
    use vk::PipelineExecutableStatisticFormatKHR as Format;
    // SAFETY: the format says which member of the union the driver wrote.
    unsafe {
        match statistic.format {
            Format::BOOL32 => (statistic.value.b32 == vk::TRUE).to_string(),
            Format::INT64 => statistic.value.i64.to_string(),
            Format::UINT64 => statistic.value.u64.to_string(),
            Format::FLOAT64 => statistic.value.f64.to_string(),
            _ => String::new(),
        }
    }
}
