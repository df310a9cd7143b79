//! Extensions that measuring can use and that no device must have: calibrated timestamps, frame boundaries, statistics of
//! pipelines, performance counters.

use std::ffi::CStr;
use std::sync::Arc;
use std::time::Instant;

use ash::{ext, khr, vk};

use super::device::Device;
use super::error::{Context, Error};
use super::instance::Instance;

/// An extension of a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extension {
    /// `VK_EXT_calibrated_timestamps` or its successor: the device's clock beside the host's.
    CalibratedTimestamps,
    /// `VK_EXT_frame_boundary`: captures know where a frame ends without a swapchain.
    FrameBoundary,
    /// `VK_KHR_pipeline_executable_properties`: what the driver's compiler made of a pipeline.
    ExecutableProperties,
    /// `VK_KHR_performance_query`: the device's own counters.
    PerformanceQuery,
}

impl Extension {
    /// Every one, in the order of the capability report.
    pub const ALL: [Extension; 4] = [
        Extension::CalibratedTimestamps,
        Extension::FrameBoundary,
        Extension::ExecutableProperties,
        Extension::PerformanceQuery,
    ];

    /// Vulkan's name.
    pub fn as_str(self) -> &'static str {
        // The names are ASCII.
        self.name().to_str().unwrap_or_default()
    }

    pub(super) fn name(self) -> &'static CStr {
        match self {
            Extension::CalibratedTimestamps => ext::calibrated_timestamps::NAME,
            Extension::FrameBoundary => c"VK_EXT_frame_boundary",
            Extension::ExecutableProperties => khr::pipeline_executable_properties::NAME,
            Extension::PerformanceQuery => khr::performance_query::NAME,
        }
    }
}

/// Those that a device has, features and all.
pub(super) fn supported(instance: &Instance, raw: vk::PhysicalDevice) -> Result<Vec<Extension>, Error> {
    // SAFETY: `raw` comes from this instance.
    let offered = unsafe { instance.raw.enumerate_device_extension_properties(raw) }
        .before_a_device("listing", "the extensions of a device")?;
    let is_offered = |one: &Extension| offered.iter().any(|e| e.extension_name_as_c_str() == Ok(one.name()));
    let mut listed: Vec<Extension> = Extension::ALL.into_iter().filter(is_offered).collect();
    let mut boundary = vk::PhysicalDeviceFrameBoundaryFeaturesEXT::default();
    let mut executable = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default();
    let mut query = vk::PhysicalDevicePerformanceQueryFeaturesKHR::default();
    let mut features = vk::PhysicalDeviceFeatures2::default();
    if listed.contains(&Extension::FrameBoundary) {
        features = features.push_next(&mut boundary);
    }
    if listed.contains(&Extension::ExecutableProperties) {
        features = features.push_next(&mut executable);
    }
    if listed.contains(&Extension::PerformanceQuery) {
        features = features.push_next(&mut query);
    }
    // SAFETY: as above; structures of offered extensions alone are chained, and outlive the call.
    unsafe { instance.raw.get_physical_device_features2(raw, &mut features) };
    let mut is_calibrated = false;
    if listed.contains(&Extension::CalibratedTimestamps) {
        let calls = ext::calibrated_timestamps::Instance::new(&instance.entry, &instance.raw);
        // SAFETY: as above; the device offers the extension.
        let domains = unsafe { calls.get_physical_device_calibrateable_time_domains(raw) }
            .before_a_device("listing", "the time domains of a device")?;
        is_calibrated = domains.contains(&vk::TimeDomainEXT::DEVICE);
    }
    listed.retain(|one| match one {
        Extension::CalibratedTimestamps => is_calibrated,
        Extension::FrameBoundary => boundary.frame_boundary == vk::TRUE,
        Extension::ExecutableProperties => executable.pipeline_executable_info == vk::TRUE,
        Extension::PerformanceQuery => query.performance_counter_query_pools == vk::TRUE,
    });
    Ok(listed)
}

/// The device's clock, read at a moment of the host's.
pub(crate) struct Calibration {
    calls: ext::calibrated_timestamps::Device,
}

impl Calibration {
    /// `None` for a device without the extension.
    pub fn new(device: &Arc<Device>) -> Option<Self> {
        let has = device.physical().has_extension(Extension::CalibratedTimestamps);
        has.then(|| Calibration { calls: ext::calibrated_timestamps::Device::new(&device.instance().raw, &device.raw) })
    }

    /// A timestamp of the device and the host's moment for it, in the middle of the call.
    ///
    /// # Errors
    /// Any error of Vulkan.
    pub fn now(&self) -> Result<(u64, Instant), Error> {
        let wanted = [vk::CalibratedTimestampInfoEXT::default().time_domain(vk::TimeDomainEXT::DEVICE)];
        let before = Instant::now();
        // SAFETY: the device, which its recorder keeps alive, was opened with the extension and has this domain.
        let (ticks, _) =
            unsafe { self.calls.get_calibrated_timestamps(&wanted) }.context("reading the clock of", "the device")?;
        // One was asked for.
        Ok((ticks[0], before + before.elapsed() / 2))
    }
}
