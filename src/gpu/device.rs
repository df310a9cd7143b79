//! The logical device: one queue, the allocator, the names of its objects.

use std::ffi::CString;
use std::mem::ManuallyDrop;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard};

use ash::{ext, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};

use super::error::{Context, Error};
use super::extensions::Extension;
use super::instance::Instance;
use super::live::{Kind, LiveObjects};
use super::memory;
use super::physical::{Feature, PhysicalDevice};

/// An open device with its one graphics, compute and transfer queue.
pub struct Device {
    // The allocator frees its blocks through the raw device, so `drop` below takes it first.
    allocator: ManuallyDrop<Mutex<Allocator>>,
    /// Handle with the calls of the device.
    pub(crate) raw: ash::Device,
    queue: Mutex<vk::Queue>,
    /// Index of the family that its queue is of.
    pub(crate) queue_family: u32,
    /// Calls that name objects and label commands; absent where the instance has none.
    pub(crate) debug: Option<ext::debug_utils::Device>,
    /// The calls of swapchains, where it was opened for them.
    #[cfg(feature = "window")]
    pub(super) presenting: Option<super::surface::Presenting>,
    /// Every extension that was asked for.
    extensions: Vec<String>,
    /// Description of the device as it was found when it was opened.
    pub(super) physical: PhysicalDevice,
    instance: Arc<Instance>,
    /// Set while its profiling lock is held, which it has once.
    pub(super) is_profiling: AtomicBool,
}

impl Device {
    /// Opens `physical` with every feature of [`Feature`] that it has.
    ///
    /// # Errors
    /// [`Error::MissingFeature`] when the baseline is not there, [`Error::NoDevice`] for a device of another instance, or
    /// any error of Vulkan.
    pub fn open(instance: &Arc<Instance>, physical: PhysicalDevice) -> Result<Arc<Self>, Error> {
        Self::open_for(instance, physical, false)
    }

    /// As [`Device::open`], for swapchains.
    ///
    /// # Errors
    /// Those of [`Device::open`]; [`Error::Unsupported`] where the instance was not made for a display, or the device has no
    /// swapchains.
    #[cfg(feature = "window")]
    pub fn open_presenting(instance: &Arc<Instance>, physical: PhysicalDevice) -> Result<Arc<Self>, Error> {
        Self::open_for(instance, physical, true)
    }

    fn open_for(instance: &Arc<Instance>, physical: PhysicalDevice, presents: bool) -> Result<Arc<Self>, Error> {
        let physical = physical.read_again(instance)?;
        let missing = physical.lacks(&[]);
        let (Some((queue_family, _)), true) = (physical.queue, missing.is_empty()) else {
            return Err(Error::MissingFeature { device: physical.name, missing: missing.join(", ") });
        };
        if presents {
            check_presenting(instance, &physical)?;
        }
        let on = |feature: Feature| physical.has(feature);
        let core = vk::PhysicalDeviceFeatures::default()
            .independent_blend(on(Feature::IndependentBlend))
            .geometry_shader(on(Feature::GeometryShader))
            .large_points(on(Feature::LargePoints))
            .fragment_stores_and_atomics(on(Feature::FragmentStores))
            .pipeline_statistics_query(on(Feature::PipelineStatistics))
            .occlusion_query_precise(on(Feature::PreciseOcclusion))
            // Accesses of shaders and vertex fetches stay inside the bound buffers; every device has it.
            .robust_buffer_access(true)
            .full_draw_index_uint32(physical.has_full_indices());
        let mut v12 = vk::PhysicalDeviceVulkan12Features::default().host_query_reset(true);
        let mut v13 = vk::PhysicalDeviceVulkan13Features::default()
            .synchronization2(true)
            .maintenance4(on(Feature::Maintenance4));
        let priorities = [1.0];
        let queues =
            [vk::DeviceQueueCreateInfo::default().queue_family_index(queue_family).queue_priorities(&priorities)];
        // A device of the subset wants to be told that its user knows.
        let mut enabled = Vec::new();
        enabled.extend(physical.portability_lacks.is_some().then_some(ash::khr::portability_subset::NAME));
        let mut has_present_fences = false;
        if presents {
            enabled.push(ash::khr::swapchain::NAME);
            has_present_fences = physical.has_present_fences(instance);
            enabled.extend(has_present_fences.then_some(ext::swapchain_maintenance1::NAME));
        }
        enabled.extend(Extension::ALL.into_iter().filter(|one| physical.has_extension(*one)).map(Extension::name));
        let mut boundary = vk::PhysicalDeviceFrameBoundaryFeaturesEXT::default().frame_boundary(true);
        let mut executable =
            vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
        let mut query = vk::PhysicalDevicePerformanceQueryFeaturesKHR::default().performance_counter_query_pools(true);
        let mut maintenance1 =
            vk::PhysicalDeviceSwapchainMaintenance1FeaturesEXT::default().swapchain_maintenance1(true);
        let names: Vec<_> = enabled.iter().map(|name| name.as_ptr()).collect();
        let mut info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_features(&core)
            .enabled_extension_names(&names)
            .push_next(&mut v12)
            .push_next(&mut v13);
        if has_present_fences {
            info = info.push_next(&mut maintenance1);
        }
        if physical.has_extension(Extension::FrameBoundary) {
            info = info.push_next(&mut boundary);
        }
        if physical.has_extension(Extension::ExecutableProperties) {
            info = info.push_next(&mut executable);
        }
        if physical.has_extension(Extension::PerformanceQuery) {
            info = info.push_next(&mut query);
        }
        // SAFETY: `physical` belongs to `instance`; the structures outlive the call; the features were asked for.
        let raw = unsafe { instance.raw.create_device(physical.raw, &info, None) }
            .before_a_device("opening", &physical.name)?;
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.raw.clone(),
            device: raw.clone(),
            physical_device: physical.raw,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: memory::block_sizes(&physical.memory),
        });
        let allocator = match allocator {
            Ok(allocator) => allocator,
            Err(error) => {
                // SAFETY: the device was just created and has no children.
                unsafe { raw.destroy_device(None) };
                return Err(Error::Allocation { object: physical.name, reason: error.to_string() });
            }
        };
        // SAFETY: one queue of this family was asked for above.
        let queue = unsafe { raw.get_device_queue(queue_family, 0) };
        let debug = instance.has_debug_utils().then(|| ext::debug_utils::Device::new(&instance.raw, &raw));
        #[cfg(feature = "window")]
        let presenting = presents.then(|| super::surface::Presenting::new(instance, &raw, has_present_fences));
        instance.live().add(Kind::Device);
        Ok(Arc::new(Device {
            allocator: ManuallyDrop::new(Mutex::new(allocator)),
            raw,
            queue: Mutex::new(queue),
            queue_family,
            debug,
            #[cfg(feature = "window")]
            presenting,
            extensions: enabled.iter().map(|name| name.to_string_lossy().into_owned()).collect(),
            physical,
            instance: instance.clone(),
            is_profiling: AtomicBool::new(false),
        }))
    }

    /// Properties, limits and features of the device.
    pub fn physical(&self) -> &PhysicalDevice {
        &self.physical
    }

    /// The instance that the device was opened on.
    pub fn instance(&self) -> &Arc<Instance> {
        &self.instance
    }

    /// Every extension that was asked for.
    pub fn extensions(&self) -> &[String] {
        &self.extensions
    }

    /// The counts of live objects and memory.
    pub fn live(&self) -> &Arc<LiveObjects> {
        self.instance.live()
    }

    /// Waits until the device has nothing to do.
    ///
    /// # Errors
    /// [`Error::Vulkan`] when the device is lost.
    pub fn wait_idle(&self) -> Result<(), Error> {
        self.raw_wait_idle().context("waiting for device", &self.physical.name)
    }

    pub(crate) fn raw_wait_idle(&self) -> Result<(), vk::Result> {
        let _queue = self.queue();
        // SAFETY: the call wants all queues for itself: the device has one, and its lock is held.
        unsafe { self.raw.device_wait_idle() }
    }

    /// The queue, for one thread at a time.
    pub(crate) fn queue(&self) -> MutexGuard<'_, vk::Queue> {
        self.queue.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Uses of a format that the device has for images.
    pub(crate) fn format_features(&self, format: vk::Format) -> vk::FormatFeatureFlags {
        // SAFETY: the physical device is this device's own.
        let properties = unsafe { self.instance.raw.get_physical_device_format_properties(self.physical.raw, format) };
        properties.optimal_tiling_features
    }

    /// # Errors
    /// [`Error::Foreign`] where `object` is not of this device but of `other`.
    pub(crate) fn check_own(self: &Arc<Self>, other: &Arc<Self>, pass: &str, object: &str) -> Result<(), Error> {
        if Arc::ptr_eq(self, other) {
            return Ok(());
        }
        Err(Error::Foreign { pass: pass.to_owned(), object: object.to_owned() })
    }

    pub(crate) fn allocator(&self) -> MutexGuard<'_, Allocator> {
        self.allocator.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Gives a handle the name that validation messages and profilers show.
    pub(crate) fn name<H: vk::Handle>(&self, handle: H, name: &str) {
        if let Some(debug) = &self.debug {
            let name = c_text(name);
            let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
            // SAFETY: the handle is a live child of this device. A failure to name costs a name, nothing else.
            let _ = unsafe { debug.set_debug_utils_object_name(&info) };
        }
    }
}

/// # Errors
/// [`Error::Unsupported`] where the instance was made without surfaces, or the device has no swapchains.
fn check_presenting(instance: &Instance, physical: &PhysicalDevice) -> Result<(), Error> {
    let surface = ash::khr::surface::NAME.to_string_lossy();
    let problem = if !instance.extensions().iter().any(|enabled| *enabled == surface) {
        "presenting: its instance was not made for a display"
    } else if !physical.offers(instance, ash::khr::swapchain::NAME) {
        "swapchains"
    } else {
        return Ok(());
    };
    Err(Error::Unsupported { object: physical.name.clone(), problem: problem.to_owned() })
}

/// The text as Vulkan takes it, without the zeros that would end it.
pub(crate) fn c_text(text: &str) -> CString {
    let bytes: Vec<u8> = text.bytes().filter(|&b| b != 0).collect();
    CString::new(bytes).unwrap_or_default()
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: every child holds an `Arc` of this device and waits for its own submissions before it drops, so none is
        // left and nothing executes; the allocator goes before the device it frees through, and is not touched again.
        unsafe {
            ManuallyDrop::drop(&mut self.allocator);
            self.raw.destroy_device(None);
        }
        self.instance.live().remove(Kind::Device);
    }
}
