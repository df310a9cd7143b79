//! The devices that are there, what they can do, and which one to take.

use std::sync::Arc;

use ash::vk;

use super::error::{Context, Error};
use super::extensions::{self, Extension};
use super::instance::{Instance, version_text};
use super::messages::text;
use super::performance::{self, PerformanceCounter};
use super::portability;
use crate::named;

named! {
    /// The kinds of device, in the order of preference.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum DeviceType {
        Discrete = "discrete",
        Integrated = "integrated",
        Virtual = "virtual",
        Cpu = "cpu",
        Other = "other",
    }
}

named! {
    /// A capability that a paper may need and a device may lack.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Feature {
        /// `synchronization2` of Vulkan 1.3: every barrier is written with it.
        Synchronization2 = "synchronization2",
        /// `hostQueryReset` of Vulkan 1.2: the timestamps are reset on the host.
        HostQueryReset = "host-query-reset",
        /// Different blend states for the attachments of one pass.
        IndependentBlend = "independent-blend",
        /// Additive blending into one 32-bit float channel (caustics map).
        BlendR32Float = "blend-r32f",
        /// Blending into four 16-bit float channels (illumination map).
        BlendRgba16Float = "blend-rgba16f",
        /// Blending into four 32-bit float channels.
        BlendRgba32Float = "blend-rgba32f",
        /// Geometry stages.
        GeometryShader = "geometry-shader",
        /// Points larger than one pixel.
        LargePoints = "large-points",
        /// Storage writes in fragment stages.
        FragmentStores = "fragment-stores",
        /// Counting vertices, primitives and invocations.
        PipelineStatistics = "pipeline-statistics",
        /// Exact counts of samples passed.
        PreciseOcclusion = "precise-occlusion",
        /// Timestamps on the graphics and compute queue.
        Timestamps = "timestamps",
        /// The depth and stencil format with 32 bits of depth.
        DepthStencil32 = "depth-stencil-d32s8",
        /// `maintenance4` of Vulkan 1.3: a stage may write what the next does not read.
        Maintenance4 = "maintenance4",
    }
}

/// The features that every paper needs: the layer itself is built on them.
pub const BASELINE: [Feature; 3] = [Feature::Synchronization2, Feature::HostQueryReset, Feature::IndependentBlend];

/// A Vulkan device as it is found, before it is opened.
pub struct PhysicalDevice {
    /// Handle.
    pub(crate) raw: vk::PhysicalDevice,
    /// Position in the loader's list.
    pub index: usize,
    /// The driver's name for the device.
    pub name: String,
    /// Discrete, integrated, virtual, CPU or other.
    pub device_type: DeviceType,
    /// Identifier that is the same in every process.
    pub uuid: [u8; 16],
    /// Name of the driver.
    pub driver_name: String,
    /// Version of the driver, in its maker's own words.
    pub driver_info: String,
    /// Vulkan version of the device, packed.
    pub api_version: u32,
    /// Limits that every size is checked against.
    pub limits: vk::PhysicalDeviceLimits,
    /// Memory types and heaps.
    pub memory: vk::PhysicalDeviceMemoryProperties,
    /// The family with graphics, compute and transfer, and its valid timestamp bits.
    pub queue: Option<(u32, u32)>,
    /// Features of whole Vulkan that a device of the portability subset lacks, none of which this layer uses; absent for a
    /// device of whole Vulkan.
    pub portability_lacks: Option<Vec<&'static str>>,
    features: Vec<Feature>,
    extensions: Vec<Extension>,
    performance_counters: Option<Vec<PerformanceCounter>>,
    /// Opened, it keeps what its compiler tells of pipelines.
    is_profiled: bool,
    /// `fullDrawIndexUint32`: every 32-bit index is one.
    pub(super) has_full_indices: bool,
    max_buffer_bytes: u64,
    /// The instance that it was found on.
    instance_id: u64,
}

impl PhysicalDevice {
    /// Every device of the instance, in the loader's order.
    ///
    /// # Errors
    /// [`Error::NoDevice`] when the loader cannot list them.
    pub fn enumerate(instance: &Arc<Instance>) -> Result<Vec<PhysicalDevice>, Error> {
        // SAFETY: the instance is alive; no other precondition.
        let handles = match unsafe { instance.raw.enumerate_physical_devices() } {
            // The loader's answer when no driver could be opened.
            Err(vk::Result::ERROR_INITIALIZATION_FAILED) => Vec::new(),
            other => other.before_a_device("listing", "the Vulkan devices")?,
        };
        handles.into_iter().enumerate().map(|(i, raw)| Self::describe(instance, i, raw)).collect()
    }

    /// True when the driver offers the extension of that name.
    pub(super) fn offers(&self, instance: &Instance, name: &std::ffi::CStr) -> bool {
        // SAFETY: `raw` comes from this instance: see `read_again`, which every user of a device goes through.
        let offered = unsafe { instance.raw.enumerate_device_extension_properties(self.raw) }.unwrap_or_default();
        offered.iter().any(|extension| extension.extension_name_as_c_str() == Ok(name))
    }

    /// True when a present can signal a fence when it has let go of its semaphore.
    pub(super) fn has_present_fences(&self, instance: &Instance) -> bool {
        let needed = ash::ext::surface_maintenance1::NAME.to_string_lossy();
        if !instance.extensions().iter().any(|enabled| *enabled == needed)
            || !self.offers(instance, ash::ext::swapchain_maintenance1::NAME)
        {
            return false;
        }
        let mut maintenance1 = vk::PhysicalDeviceSwapchainMaintenance1FeaturesEXT::default();
        let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut maintenance1);
        // SAFETY: `raw` comes from this instance, and the chained structure outlives the call.
        unsafe { instance.raw.get_physical_device_features2(self.raw, &mut features) };
        maintenance1.swapchain_maintenance1 == vk::TRUE
    }

    fn describe(instance: &Instance, index: usize, raw: vk::PhysicalDevice) -> Result<Self, Error> {
        let mut id = vk::PhysicalDeviceIDProperties::default();
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut v13 = vk::PhysicalDeviceVulkan13Properties::default();
        // SAFETY: `raw` comes from this instance.
        let (properties, memory, queues, core) = unsafe {
            (
                instance.raw.get_physical_device_properties(raw),
                instance.raw.get_physical_device_memory_properties(raw),
                instance.raw.get_physical_device_queue_family_properties(raw),
                instance.raw.get_physical_device_features(raw),
            )
        };
        // A device of an older Vulkan, which is listed and never opened, is asked for what its version has.
        let has = |version| properties.api_version >= version;
        let mut more = vk::PhysicalDeviceProperties2::default().push_next(&mut id);
        if has(vk::API_VERSION_1_2) {
            more = more.push_next(&mut driver);
        }
        if has(vk::API_VERSION_1_3) {
            more = more.push_next(&mut v13);
        }
        let (mut extensions, mut portability_lacks) = (Vec::new(), None);
        if has(vk::API_VERSION_1_1) {
            // SAFETY: `raw` comes from this instance, and the chained structures, which its version has, outlive the call.
            unsafe { instance.raw.get_physical_device_properties2(raw, &mut more) };
            extensions = extensions::supported(instance, raw)?;
            portability_lacks = portability::lacks(instance, raw)?;
        }
        let needed = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
        let queue = queues
            .iter()
            .position(|q| q.queue_flags.contains(needed))
            .map(|family| (family as u32, queues[family].timestamp_valid_bits));
        Ok(PhysicalDevice {
            raw,
            index,
            name: text(&properties.device_name),
            device_type: match properties.device_type {
                vk::PhysicalDeviceType::DISCRETE_GPU => DeviceType::Discrete,
                vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceType::Integrated,
                vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceType::Virtual,
                vk::PhysicalDeviceType::CPU => DeviceType::Cpu,
                _ => DeviceType::Other,
            },
            uuid: id.device_uuid,
            driver_name: text(&driver.driver_name),
            driver_info: text(&driver.driver_info),
            api_version: properties.api_version,
            limits: properties.limits,
            memory,
            queue,
            portability_lacks,
            performance_counters: performance::counters(instance, raw, &extensions, queue)?,
            extensions,
            is_profiled: false,
            features: supported_features(instance, raw, properties.api_version, queue),
            has_full_indices: core.full_draw_index_uint32 == vk::TRUE,
            max_buffer_bytes: v13.max_buffer_size,
            instance_id: instance.id(),
        })
    }

    /// The device as it is found now, with the features that are left to it: whatever became of the description, limits
    /// and features are the device's own.
    pub(crate) fn read_again(self, instance: &Instance) -> Result<Self, Error> {
        if self.instance_id != instance.id() {
            return Err(Error::NoDevice { reason: format!("{} belongs to another instance", self.name) });
        }
        let mut again = Self::describe(instance, self.index, self.raw)?;
        again.features.retain(|feature| self.features.contains(feature));
        again.is_profiled = self.is_profiled;
        Ok(again)
    }

    pub(crate) fn has_full_indices(&self) -> bool {
        self.has_full_indices
    }

    /// The largest index that a draw may use.
    pub(crate) fn largest_index(&self) -> u32 {
        if self.has_full_indices { u32::MAX - 1 } else { self.limits.max_draw_indexed_index_value }
    }

    /// The largest size of a buffer, in bytes.
    pub fn max_buffer_bytes(&self) -> u64 {
        self.max_buffer_bytes
    }

    /// True when the device has `feature`.
    pub fn has(&self, feature: Feature) -> bool {
        self.features.contains(&feature)
    }

    /// True when the device has `extension`; it is then opened with it.
    pub fn has_extension(&self, extension: Extension) -> bool {
        self.extensions.contains(&extension)
    }

    /// The device's own counters; absent where it has none.
    pub fn performance_counters(&self) -> Option<&[PerformanceCounter]> {
        self.performance_counters.as_deref()
    }

    /// The device with pipelines that keep what its compiler tells of them, where it does.
    pub fn profiled(mut self) -> Self {
        self.is_profiled = true;
        self
    }

    pub(crate) fn keeps_executables(&self) -> bool {
        self.is_profiled && self.has_extension(Extension::ExecutableProperties)
    }

    /// The device as if it lacked `feature`: opened, it does not enable it. The fallbacks for less capable devices can be
    /// tried on a more capable one.
    pub fn without(mut self, feature: Feature) -> Self {
        self.features.retain(|f| *f != feature);
        self
    }

    /// Names of those of `needed`, and of the layer's own baseline, that the device lacks; empty when it is capable.
    pub fn lacks(&self, needed: &[Feature]) -> Vec<&'static str> {
        let mut missing = Vec::new();
        if self.api_version < vk::API_VERSION_1_3 {
            missing.push("Vulkan 1.3");
        }
        if self.queue.is_none() {
            missing.push("a queue with graphics and compute");
        }
        missing.extend(BASELINE.iter().chain(needed).filter(|&&f| !self.has(f)).map(|f| f.as_str()));
        missing.dedup();
        missing
    }

    /// The device's UUID in the usual grouping.
    pub fn uuid_text(&self) -> String {
        let hex: Vec<String> = self.uuid.iter().map(|b| format!("{b:02x}")).collect();
        [&hex[0..4], &hex[4..6], &hex[6..8], &hex[8..10], &hex[10..16]].map(|g| g.concat()).join("-")
    }

    /// `major.minor.patch` of the Vulkan version it offers.
    pub fn api_version_text(&self) -> String {
        version_text(self.api_version)
    }
}

fn supported_features(
    instance: &Instance,
    raw: vk::PhysicalDevice,
    api_version: u32,
    queue: Option<(u32, u32)>,
) -> Vec<Feature> {
    if api_version < vk::API_VERSION_1_3 {
        return Vec::new();
    }
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut v13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut v12).push_next(&mut v13);
    // SAFETY: `raw` comes from this instance, and the chained structures outlive the call.
    unsafe { instance.raw.get_physical_device_features2(raw, &mut features) };
    let core = features.features;
    let blends = |format| {
        // SAFETY: `raw` comes from this instance.
        let properties = unsafe { instance.raw.get_physical_device_format_properties(raw, format) };
        properties.optimal_tiling_features.contains(vk::FormatFeatureFlags::COLOR_ATTACHMENT_BLEND)
    };
    let has = |feature: &Feature| match feature {
        Feature::Synchronization2 => v13.synchronization2 == vk::TRUE,
        Feature::HostQueryReset => v12.host_query_reset == vk::TRUE,
        Feature::IndependentBlend => core.independent_blend == vk::TRUE,
        Feature::BlendR32Float => blends(vk::Format::R32_SFLOAT),
        Feature::BlendRgba16Float => blends(vk::Format::R16G16B16A16_SFLOAT),
        Feature::BlendRgba32Float => blends(vk::Format::R32G32B32A32_SFLOAT),
        Feature::GeometryShader => core.geometry_shader == vk::TRUE,
        Feature::LargePoints => core.large_points == vk::TRUE,
        Feature::FragmentStores => core.fragment_stores_and_atomics == vk::TRUE,
        Feature::PipelineStatistics => core.pipeline_statistics_query == vk::TRUE,
        Feature::PreciseOcclusion => core.occlusion_query_precise == vk::TRUE,
        Feature::DepthStencil32 => {
            let format = vk::Format::D32_SFLOAT_S8_UINT;
            // SAFETY: `raw` comes from this instance.
            let properties = unsafe { instance.raw.get_physical_device_format_properties(raw, format) };
            let needed = vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT | vk::FormatFeatureFlags::SAMPLED_IMAGE;
            properties.optimal_tiling_features.contains(needed)
        }
        Feature::Maintenance4 => v13.maintenance4 == vk::TRUE,
        Feature::Timestamps => queue.is_some_and(|(_, bits)| bits > 0),
    };
    Feature::ALL.into_iter().filter(|f| has(f)).collect()
}

/// Chooses a device: by index, UUID or part of the name when `wanted` is given, else the best of those that have all
/// of `needed`: discrete, then integrated, virtual, CPU.
///
/// # Errors
/// [`Error::NoDevice`], [`Error::UnknownDevice`], [`Error::AmbiguousDevice`] or [`Error::MissingFeature`].
pub fn choose(devices: Vec<PhysicalDevice>, wanted: Option<&str>, needed: &[Feature]) -> Result<PhysicalDevice, Error> {
    if devices.is_empty() {
        return Err(Error::NoDevice { reason: "no driver offers one".into() });
    }
    let Some(wanted) = wanted else {
        let lacking: Vec<String> =
            devices.iter().map(|d| format!("{} lacks {}", d.name, d.lacks(needed).join(", "))).collect();
        return devices
            .into_iter()
            .filter(|d| d.lacks(needed).is_empty())
            .min_by_key(|d| (d.device_type, d.index))
            .ok_or_else(|| Error::NoDevice { reason: lacking.join("; ") });
    };
    let present = listing(devices.iter());
    let matches = matching(&devices, wanted);
    match matches[..] {
        [] => Err(Error::UnknownDevice { wanted: wanted.into(), present }),
        [one] => {
            let missing = devices[one].lacks(needed);
            if missing.is_empty() {
                devices.into_iter().nth(one).ok_or(Error::UnknownDevice { wanted: wanted.into(), present })
            } else {
                Err(Error::MissingFeature { device: devices[one].name.clone(), missing: missing.join(", ") })
            }
        }
        _ => Err(Error::AmbiguousDevice {
            wanted: wanted.into(),
            matching: listing(matches.iter().map(|&i| &devices[i])),
        }),
    }
}

fn listing<'a>(devices: impl Iterator<Item = &'a PhysicalDevice>) -> String {
    devices.map(|d| format!("{}: {} ({})", d.index, d.name, d.uuid_text())).collect::<Vec<_>>().join("; ")
}

fn matching(devices: &[PhysicalDevice], wanted: &str) -> Vec<usize> {
    let plain = |text: &str| text.to_lowercase().replace('-', "");
    let positions = |test: &dyn Fn(&PhysicalDevice) -> bool| -> Vec<usize> {
        (0..devices.len()).filter(|&i| test(&devices[i])).collect()
    };
    if let Ok(index) = wanted.trim().parse::<usize>() {
        return positions(&|d| d.index == index);
    }
    if wanted.trim().is_empty() {
        return Vec::new();
    }
    let by_uuid = positions(&|d| plain(&d.uuid_text()) == plain(wanted));
    if !by_uuid.is_empty() {
        return by_uuid;
    }
    positions(&|d| d.name.to_lowercase().contains(&wanted.to_lowercase()))
}
