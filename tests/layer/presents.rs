//! Presenting to a window that changes: acquisitions and presents that end as a display may let them end. And fences of
//! presents, for a driver that has none: each is signalled when all that was handed in before is done.

use std::env;
use std::ffi::{CStr, CString, c_void};
use std::mem::transmute;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use ash::vk;

use crate::lend::lends;

const ACQUIRE: &str = "vkAcquireNextImageKHR";
const PRESENT: &str = "vkQueuePresentKHR";
/// Not hooked: it signals the fences.
const SUBMIT: &str = "vkQueueSubmit";
const NAMES: [&str; 3] = [ACQUIRE, PRESENT, SUBMIT];

static NEXT: [AtomicUsize; NAMES.len()] = [const { AtomicUsize::new(0) }; NAMES.len()];
static COUNTS: [AtomicUsize; NAMES.len()] = [const { AtomicUsize::new(0) }; NAMES.len()];

/// Finds the next functions of all that is hooked.
pub fn resolve(next: &dyn Fn(&CStr) -> vk::PFN_vkVoidFunction) {
    for (name, slot) in NAMES.iter().zip(&NEXT) {
        if let Some(found) = CString::new(*name).ok().and_then(|name| next(&name)) {
            slot.store(found as usize, Ordering::Release);
        }
    }
}

/// The hook before a command, if it has one.
pub fn hook(name: &str) -> Option<*const c_void> {
    if env::var_os("FUMAROLE_LAYER_PRESENTS").is_none() && !lends("present-fences") {
        return None;
    }
    match name {
        ACQUIRE => Some(acquire as *const c_void),
        PRESENT => Some(present as *const c_void),
        _ => None,
    }
}

/// The end that the next call of this name is to have.
fn ending(index: usize) -> Option<vk::Result> {
    let number = COUNTS[index].fetch_add(1, Ordering::Relaxed) + 1;
    let list = env::var("FUMAROLE_LAYER_PRESENTS").ok()?;
    let call = format!("{}@{number}=", ["acquire", "present"][index]);
    let result = match list.split(',').find_map(|one| one.strip_prefix(call.as_str()))? {
        "suboptimal" => vk::Result::SUBOPTIMAL_KHR,
        "out-of-date" => vk::Result::ERROR_OUT_OF_DATE_KHR,
        "surface-lost" => vk::Result::ERROR_SURFACE_LOST_KHR,
        "timeout" => vk::Result::TIMEOUT,
        _ => vk::Result::ERROR_DEVICE_LOST,
    };
    // Read by the test beside the program's own words.
    eprintln!("layer: {call}{result:?}");
    Some(result)
}

unsafe extern "system" fn acquire(
    device: vk::Device,
    swapchain: vk::SwapchainKHR,
    timeout: u64,
    semaphore: vk::Semaphore,
    fence: vk::Fence,
    index: *mut u32,
) -> vk::Result {
    let ending = ending(0);
    // An acquisition that fails leaves semaphore and fence alone.
    if let Some(failure) = ending.filter(|&ending| ending != vk::Result::SUBOPTIMAL_KHR) {
        return failure;
    }
    let next = NEXT[0].load(Ordering::Acquire);
    // SAFETY: here and below, the address is that of the command of this name, the arguments are the caller's.
    let result = unsafe {
        transmute::<usize, vk::PFN_vkAcquireNextImageKHR>(next)(device, swapchain, timeout, semaphore, fence, index)
    };
    ending.filter(|_| result == vk::Result::SUCCESS).unwrap_or(result)
}

unsafe extern "system" fn present(queue: vk::Queue, info: *const vk::PresentInfoKHR<'_>) -> vk::Result {
    let next = NEXT[1].load(Ordering::Acquire);
    // SAFETY: see above; the structures of a chain are of the types that they say, and live for the call.
    let result = unsafe {
        let mut known = *info;
        let fences = if lends("present-fences") { take_fences(&mut known) } else { &[] };
        // A present that fails so has waited for its semaphores all the same.
        let result = transmute::<usize, vk::PFN_vkQueuePresentKHR>(next)(queue, &known);
        for fence in fences {
            let submit = transmute::<usize, vk::PFN_vkQueueSubmit>(NEXT[2].load(Ordering::Acquire));
            let signalled = submit(queue, 0, std::ptr::null(), *fence);
            if !SIGNALLED.swap(true, Ordering::Relaxed) {
                eprintln!("layer: fences of presents are signalled: {signalled:?}");
            }
        }
        result
    };
    ending(1).filter(|_| result == vk::Result::SUCCESS).unwrap_or(result)
}

static SIGNALLED: AtomicBool = AtomicBool::new(false);

/// Takes the fences out of the chain of a present, where they come first.
///
/// # Safety
/// The chain is Vulkan's.
unsafe fn take_fences<'a>(info: &mut vk::PresentInfoKHR<'a>) -> &'a [vk::Fence] {
    // SAFETY: the caller's.
    unsafe {
        let Some(first) = info.p_next.cast::<vk::SwapchainPresentFenceInfoEXT<'a>>().as_ref() else { return &[] };
        if first.s_type != vk::StructureType::SWAPCHAIN_PRESENT_FENCE_INFO_EXT {
            return &[];
        }
        info.p_next = first.p_next;
        std::slice::from_raw_parts(first.p_fences, first.swapchain_count as usize)
    }
}
