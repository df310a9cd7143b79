//! A device that takes its heaps at their word: memory beyond their sizes together, or beyond less, is refused. Drivers that
//! keep memory in the host's give more than they say they have.

use std::collections::HashMap;
use std::env;
use std::ffi::{CStr, c_void};
use std::mem::transmute;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use ash::vk;

static MEMORY_PROPERTIES: AtomicUsize = AtomicUsize::new(0);
/// Bytes of all heaps.
static HEAP_BYTES: AtomicU64 = AtomicU64::new(u64::MAX);
/// Bytes behind each handle.
static ALLOCATED: Mutex<Option<HashMap<u64, u64>>> = Mutex::new(None);

fn allocated() -> MutexGuard<'static, Option<HashMap<u64, u64>>> {
    ALLOCATED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Finds the instance's function.
pub fn resolve(next: &dyn Fn(&CStr) -> vk::PFN_vkVoidFunction) {
    let found = next(c"vkGetPhysicalDeviceMemoryProperties").map_or(0, |found| found as usize);
    MEMORY_PROPERTIES.store(found, Ordering::Release);
}

/// Learns the sizes of the heaps of the device that is opened.
///
/// # Safety
/// The physical device is the instance's.
pub unsafe fn learn(physical: vk::PhysicalDevice) {
    let ask = MEMORY_PROPERTIES.load(Ordering::Acquire);
    let Ok(most) = env::var("FUMAROLE_LAYER_HEAPS") else { return };
    if ask == 0 {
        return;
    }
    let mut memory = vk::PhysicalDeviceMemoryProperties::default();
    // SAFETY: the address is that of the command.
    unsafe { transmute::<usize, vk::PFN_vkGetPhysicalDeviceMemoryProperties>(ask)(physical, &raw mut memory) };
    let heaps = &memory.memory_heaps[..memory.memory_heap_count as usize];
    let all: u64 = heaps.iter().map(|heap| heap.size).sum();
    HEAP_BYTES.store(all.min(most.parse().unwrap_or(all)), Ordering::Release);
}

/// The hook before a command, if it has one.
pub fn hook(name: &str) -> Option<*const c_void> {
    env::var_os("FUMAROLE_LAYER_HEAPS")?;
    match name {
        "vkAllocateMemory" => Some(allocate as *const c_void),
        "vkFreeMemory" => Some(free as *const c_void),
        _ => None,
    }
}

unsafe extern "system" fn allocate(
    device: vk::Device,
    info: *const vk::MemoryAllocateInfo<'_>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    memory: *mut vk::DeviceMemory,
) -> vk::Result {
    let mut allocated = allocated();
    let of_handles = allocated.get_or_insert_default();
    // SAFETY: the caller's structure.
    let bytes = unsafe { (*info).allocation_size };
    let together = of_handles.values().fold(bytes, |sum, one| sum.saturating_add(*one));
    if together > HEAP_BYTES.load(Ordering::Acquire) {
        return vk::Result::ERROR_OUT_OF_DEVICE_MEMORY;
    }
    let Some(counting) = super::calls::hook("vkAllocateMemory") else { return vk::Result::ERROR_UNKNOWN };
    // SAFETY: a function of that command's signature, with the caller's arguments.
    unsafe {
        let result = transmute::<*const c_void, vk::PFN_vkAllocateMemory>(counting)(device, info, callbacks, memory);
        if result == vk::Result::SUCCESS {
            of_handles.insert(vk::Handle::as_raw(*memory), bytes);
        }
        result
    }
}

unsafe extern "system" fn free(
    device: vk::Device,
    memory: vk::DeviceMemory,
    callbacks: *const vk::AllocationCallbacks<'_>,
) {
    allocated().get_or_insert_default().remove(&vk::Handle::as_raw(memory));
    if let Some(counting) = super::calls::hook("vkFreeMemory") {
        // SAFETY: as above.
        unsafe { transmute::<*const c_void, vk::PFN_vkFreeMemory>(counting)(device, memory, callbacks) };
    }
}
