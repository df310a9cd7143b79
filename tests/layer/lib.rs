//! A Vulkan layer for the tests: it makes calls fail, hides features, lowers limits, plays extensions, reads labels and
//! counts what is alive. The tests give its folder to the loader and say by environment variables what it does:
//!
//! | variable | meaning |
//! | --- | --- |
//! | `FUMAROLE_LAYER_FAIL` | `vkCreateFence@3:host`, `:device` or `:lost`: the third call of that name fails so; `@0`: every one |
//! | `FUMAROLE_LAYER_ROUNDS` | file with `ROUND vkCreateFence@3:host`: the same, counted anew and reported with each other text |
//! | `FUMAROLE_LAYER_ONLY` | `worker`: calls fail in programs with this argument alone |
//! | `FUMAROLE_LAYER_DISCRETE` | set: the device says that it is a GPU of its own |
//! | `FUMAROLE_LAYER_LACKS` | features by the names of `fumarole devices`, comma-separated |
//! | `FUMAROLE_LAYER_LENDS` | extensions that the layer plays: `performance-query`, `executable-properties`, `frame-boundary`, `present-fences` |
//! | `FUMAROLE_LAYER_LOCKED` | set: another process holds the profiling lock |
//! | `FUMAROLE_LAYER_LIMITS` | `max-push-constants-size=64,...`: the device's limits, where they are higher, and alignments, where they are lower |
//! | `FUMAROLE_LAYER_NAME` | the device's name |
//! | `FUMAROLE_LAYER_DROPS_BARRIERS` | set: barriers wait for nothing; images come into their layouts all the same |
//! | `FUMAROLE_LAYER_HEAPS` | `all` or bytes: memory beyond the device's heaps, or beyond so much, is refused |
//! | `FUMAROLE_LAYER_VULKAN` | `1.1`: the version of Vulkan that the device has, where it is higher |
//! | `FUMAROLE_LAYER_PRESENTS` | `acquire@3=out-of-date,present@5=surface-lost,...`: ends of calls to a window's swapchain |
//! | `FUMAROLE_LAYER_REPORT` | file that tells, when an instance is destroyed, of the calls, of labels and of what is alive |
//!
//! After a lost device, every submission and wait of the process fails the same way.

mod barriers;
mod calls;
mod heap;
mod labels;
mod lend;
mod mask;
mod presents;

use std::ffi::{CStr, c_char, c_void};
use std::mem::transmute;
use std::sync::atomic::{AtomicUsize, Ordering};

use ash::vk;

/// `VkNegotiateLayerInterface`.
#[repr(C)]
pub struct NegotiateLayerInterface {
    s_type: i32,
    next: *mut c_void,
    loader_layer_interface_version: u32,
    get_instance_proc_addr: Option<vk::PFN_vkGetInstanceProcAddr>,
    get_device_proc_addr: Option<vk::PFN_vkGetDeviceProcAddr>,
    get_physical_device_proc_addr: Option<vk::PFN_vkGetInstanceProcAddr>,
}

/// `VkLayerInstanceLink`; a device's link has the same first fields.
#[repr(C)]
struct Link {
    next: *mut Link,
    get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    get_device_proc_addr: *const c_void,
}

/// `VkLayerInstanceCreateInfo` and `VkLayerDeviceCreateInfo`.
#[repr(C)]
struct LinkInfo {
    s_type: vk::StructureType,
    next: *mut LinkInfo,
    function: i32,
    link: *mut Link,
}

const LAYER_LINK_INFO: i32 = 0;

/// Entries of the next layer or driver. A process of the tests has one instance and one device at a time.
static NEXT_INSTANCE_PROC: AtomicUsize = AtomicUsize::new(0);
static NEXT_DEVICE_PROC: AtomicUsize = AtomicUsize::new(0);

/// # Safety
/// Called by the loader with a structure of its own.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    // SAFETY: the loader's structure lives for the call.
    let interface = unsafe { &mut *interface };
    interface.loader_layer_interface_version = 2;
    interface.get_instance_proc_addr = Some(get_instance_proc_addr);
    interface.get_device_proc_addr = Some(get_device_proc_addr);
    interface.get_physical_device_proc_addr = None;
    vk::Result::SUCCESS
}

/// Takes this layer's link off the chain, for the next one to find its own.
unsafe fn take_link(mut info: *mut LinkInfo, s_type: vk::StructureType) -> Option<&'static Link> {
    // SAFETY: the loader's chain of structures lives for the call of the caller.
    unsafe {
        while let Some(found) = info.as_mut() {
            if found.s_type == s_type && found.function == LAYER_LINK_INFO {
                let link = found.link.as_ref()?;
                found.link = link.next;
                return Some(link);
            }
            info = found.next;
        }
    }
    None
}

unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
) -> vk::Result {
    if let Some(failure) = calls::counted("vkCreateInstance") {
        return failure;
    }
    // SAFETY: the loader's arguments go through unchanged but for the chain, which is for the layers to advance.
    unsafe {
        let chain = (*info).p_next.cast_mut().cast();
        let Some(link) = take_link(chain, vk::StructureType::LOADER_INSTANCE_CREATE_INFO) else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        NEXT_INSTANCE_PROC.store(link.get_instance_proc_addr as usize, Ordering::Release);
        let Some(create) = (link.get_instance_proc_addr)(vk::Instance::null(), c"vkCreateInstance".as_ptr()) else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        let create: vk::PFN_vkCreateInstance = transmute(create);
        let result = create(info, allocator, instance);
        if result == vk::Result::SUCCESS {
            calls::born("Instance");
            calls::resolve(&|name| next_instance_proc(*instance, name));
            mask::resolve(&|name| next_instance_proc(*instance, name));
            heap::resolve(&|name| next_instance_proc(*instance, name));
            lend::resolve(&|name| next_instance_proc(*instance, name));
            labels::resolve(&|name| next_instance_proc(*instance, name));
        }
        result
    }
}

unsafe extern "system" fn create_device(
    physical: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
) -> vk::Result {
    if let Some(failure) = calls::counted("vkCreateDevice") {
        return failure;
    }
    // SAFETY: as for the instance.
    unsafe {
        let chain = (*info).p_next.cast_mut().cast();
        let Some(link) = take_link(chain, vk::StructureType::LOADER_DEVICE_CREATE_INFO) else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        NEXT_DEVICE_PROC.store(link.get_device_proc_addr as usize, Ordering::Release);
        let Some(create) = (link.get_instance_proc_addr)(vk::Instance::null(), c"vkCreateDevice".as_ptr()) else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        let create: vk::PFN_vkCreateDevice = transmute(create);
        // The driver does not know the extension that the mask lends it.
        let mut masked = *info;
        let knows = masked.enabled_extension_count == 1;
        if mask::is_subset() {
            if !knows {
                return vk::Result::ERROR_EXTENSION_NOT_PRESENT;
            }
            masked.enabled_extension_count = 0;
        }
        let mut known = Vec::new();
        for index in 0..masked.enabled_extension_count as usize {
            let name = *masked.pp_enabled_extension_names.add(index);
            if !lend::is_lent(name) {
                known.push(name);
            }
        }
        (masked.enabled_extension_count, masked.pp_enabled_extension_names) = (known.len() as u32, known.as_ptr());
        let mut chain = masked.p_next;
        let restore = lend::without_features(&mut chain);
        masked.p_next = chain;
        let result = create(physical, &masked, allocator, device);
        restore();
        if result == vk::Result::SUCCESS {
            calls::born("Device");
            heap::learn(physical);
            calls::resolve(&|name| next_device_proc(*device, name));
            lend::resolve(&|name| next_device_proc(*device, name));
            labels::resolve(&|name| next_device_proc(*device, name));
            presents::resolve(&|name| next_device_proc(*device, name));
            barriers::resolve(&|name| next_device_proc(*device, name));
        }
        result
    }
}

fn next_instance_proc(instance: vk::Instance, name: &CStr) -> vk::PFN_vkVoidFunction {
    let next = NEXT_INSTANCE_PROC.load(Ordering::Acquire);
    // SAFETY: the address is the next entry's, which lives as long as the instance.
    let next = if next == 0 { return None } else { unsafe { transmute::<usize, vk::PFN_vkGetInstanceProcAddr>(next) } };
    // SAFETY: the name ends in a zero.
    unsafe { next(instance, name.as_ptr()) }
}

/// True for a command that is none of a device's: whoever asks a validation layer for it by a device is warned.
fn is_of_instance(name: &CStr) -> bool {
    let name = name.to_string_lossy();
    let begins = ["vkEnumerate", "vkGetPhysicalDevice"].iter().any(|begin| name.starts_with(begin));
    let of_instance = ["vkCreateInstance", "vkDestroyInstance", "vkCreateDevice", "vkGetInstanceProcAddr"];
    begins || name.ends_with("SurfaceKHR") || name.ends_with("MessengerEXT") || of_instance.contains(&&*name)
}

fn next_device_proc(device: vk::Device, name: &CStr) -> vk::PFN_vkVoidFunction {
    if is_of_instance(name) {
        return None;
    }
    let next = NEXT_DEVICE_PROC.load(Ordering::Acquire);
    // SAFETY: as above.
    let next = if next == 0 { return None } else { unsafe { transmute::<usize, vk::PFN_vkGetDeviceProcAddr>(next) } };
    // SAFETY: as above.
    unsafe { next(device, name.as_ptr()) }
}

/// This layer's own function of a name.
fn own(name: &str) -> vk::PFN_vkVoidFunction {
    let function = match name {
        "vkGetInstanceProcAddr" => get_instance_proc_addr as *const c_void,
        "vkGetDeviceProcAddr" => get_device_proc_addr as *const c_void,
        "vkCreateInstance" => create_instance as *const c_void,
        "vkCreateDevice" => create_device as *const c_void,
        other => mask::hook(other)
            .or_else(|| lend::hook(other))
            .or_else(|| heap::hook(other))
            .or_else(|| labels::hook(other))
            .or_else(|| presents::hook(other))
            .or_else(|| barriers::hook(other))
            .or_else(|| calls::hook(other))?,
    };
    // SAFETY: each is a function of the signature that its name has in Vulkan.
    Some(unsafe { transmute::<*const c_void, unsafe extern "system" fn()>(function) })
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the name ends in a zero.
    let name = unsafe { CStr::from_ptr(name) };
    // The loader asks the topmost layer for it by an instance that is not there yet.
    if name == c"vkCreateInstance" {
        return own("vkCreateInstance");
    }
    // What the driver lacks stays lacking.
    let next = next_instance_proc(instance, name);
    let is_there =
        || next.is_some() || instance == vk::Instance::null() || lend::whole(&name.to_string_lossy()).is_some();
    own(&name.to_string_lossy()).filter(|_| is_there()).or(next)
}

unsafe extern "system" fn get_device_proc_addr(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    // SAFETY: the name ends in a zero.
    let name = unsafe { CStr::from_ptr(name) };
    if lend::whole(&name.to_string_lossy()).is_some() {
        return own(&name.to_string_lossy());
    }
    let next = next_device_proc(device, name)?;
    Some(own(&name.to_string_lossy()).unwrap_or(next))
}
