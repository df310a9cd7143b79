//! Calls that return a result: counted, and one of them made to fail. Objects: counted from birth to death.

use std::collections::BTreeMap;
use std::env;
use std::ffi::{CStr, CString, c_void};
use std::fmt::Write;
use std::fs;
use std::mem::transmute;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard};

use ash::vk;

/// Arguments of any call here, as the registers and the stack hold them: none has more than eight, and a callee leaves
/// alone what it has no argument for.
type Call = unsafe extern "system" fn(usize, usize, usize, usize, usize, usize, usize, usize) -> vk::Result;

/// Every command of Vulkan 1.3 and of the extensions in use that returns a result, but for those that make an instance or a
/// device, which stand in `lib.rs`, and those that the loader answers itself before there is an instance.
const RESULTS: [&str; 77] = [
    "vkEnumeratePhysicalDevices",
    "vkGetPhysicalDeviceImageFormatProperties",
    "vkGetPhysicalDeviceImageFormatProperties2",
    "vkEnumerateDeviceExtensionProperties",
    "vkEnumerateDeviceLayerProperties",
    "vkEnumeratePhysicalDeviceGroups",
    "vkGetPhysicalDeviceToolProperties",
    "vkQueueSubmit",
    "vkQueueSubmit2",
    "vkQueueWaitIdle",
    "vkDeviceWaitIdle",
    "vkAllocateMemory",
    "vkMapMemory",
    "vkFlushMappedMemoryRanges",
    "vkInvalidateMappedMemoryRanges",
    "vkBindBufferMemory",
    "vkBindBufferMemory2",
    "vkBindImageMemory",
    "vkBindImageMemory2",
    "vkQueueBindSparse",
    "vkCreateFence",
    "vkResetFences",
    "vkGetFenceStatus",
    "vkWaitForFences",
    "vkCreateSemaphore",
    "vkGetSemaphoreCounterValue",
    "vkWaitSemaphores",
    "vkSignalSemaphore",
    "vkCreateEvent",
    "vkGetEventStatus",
    "vkSetEvent",
    "vkResetEvent",
    "vkCreateQueryPool",
    "vkGetQueryPoolResults",
    "vkCreateBuffer",
    "vkCreateBufferView",
    "vkCreateImage",
    "vkCreateImageView",
    "vkCreateShaderModule",
    "vkCreatePipelineCache",
    "vkGetPipelineCacheData",
    "vkMergePipelineCaches",
    "vkCreateGraphicsPipelines",
    "vkCreateComputePipelines",
    "vkCreatePipelineLayout",
    "vkCreateSampler",
    "vkCreateSamplerYcbcrConversion",
    "vkCreateDescriptorSetLayout",
    "vkCreateDescriptorPool",
    "vkCreateDescriptorUpdateTemplate",
    "vkResetDescriptorPool",
    "vkAllocateDescriptorSets",
    "vkFreeDescriptorSets",
    "vkCreateFramebuffer",
    "vkCreateRenderPass",
    "vkCreateRenderPass2",
    "vkCreateCommandPool",
    "vkResetCommandPool",
    "vkAllocateCommandBuffers",
    "vkBeginCommandBuffer",
    "vkEndCommandBuffer",
    "vkResetCommandBuffer",
    "vkSetDebugUtilsObjectNameEXT",
    "vkCreateDebugUtilsMessengerEXT",
    "vkGetPhysicalDeviceCalibrateableTimeDomainsEXT",
    "vkGetCalibratedTimestampsEXT",
    "vkCreateXcbSurfaceKHR",
    "vkCreateXlibSurfaceKHR",
    "vkCreateWaylandSurfaceKHR",
    "vkGetPhysicalDeviceSurfaceSupportKHR",
    "vkGetPhysicalDeviceSurfaceCapabilitiesKHR",
    "vkGetPhysicalDeviceSurfaceFormatsKHR",
    "vkGetPhysicalDeviceSurfacePresentModesKHR",
    "vkCreateSwapchainKHR",
    "vkGetSwapchainImagesKHR",
    "vkAcquireNextImageKHR",
    "vkQueuePresentKHR",
];

/// Commands that end an object.
const ENDS: [&str; 20] = [
    "vkDestroyInstance",
    "vkDestroyDevice",
    "vkFreeMemory",
    "vkDestroyFence",
    "vkDestroySemaphore",
    "vkDestroyQueryPool",
    "vkDestroyBuffer",
    "vkDestroyImage",
    "vkDestroyImageView",
    "vkDestroyShaderModule",
    "vkDestroyPipeline",
    "vkDestroyPipelineLayout",
    "vkDestroySampler",
    "vkDestroyDescriptorSetLayout",
    "vkDestroyDescriptorPool",
    "vkDestroyFramebuffer",
    "vkDestroyRenderPass",
    "vkDestroyDebugUtilsMessengerEXT",
    "vkDestroySurfaceKHR",
    "vkDestroySwapchainKHR",
];

/// The one that does not fit above by its number of arguments alone: a pool takes its buffers along.
const END_OF_POOL: &str = "vkDestroyCommandPool";

/// Calls that a lost device refuses for good.
const LOST_FOR: [&str; 8] = [
    "vkQueueSubmit",
    "vkQueueSubmit2",
    "vkQueuePresentKHR",
    "vkAcquireNextImageKHR",
    "vkWaitForFences",
    "vkDeviceWaitIdle",
    "vkGetQueryPoolResults",
    "vkGetCalibratedTimestampsEXT",
];

static NEXT_RESULTS: [AtomicUsize; RESULTS.len()] = [const { AtomicUsize::new(0) }; RESULTS.len()];
static NEXT_ENDS: [AtomicUsize; ENDS.len() + 1] = [const { AtomicUsize::new(0) }; ENDS.len() + 1];
/// Calls so far, by their names.
static COUNTS: Mutex<BTreeMap<&str, usize>> = Mutex::new(BTreeMap::new());
static LOST: AtomicBool = AtomicBool::new(false);
/// Text of the round's file.
static ROUND: Mutex<String> = Mutex::new(String::new());
static FAILED: Mutex<Option<&str>> = Mutex::new(None);
static ALIVE: Mutex<BTreeMap<String, i64>> = Mutex::new(BTreeMap::new());

fn counts() -> MutexGuard<'static, BTreeMap<&'static str, usize>> {
    COUNTS.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// The call that is to fail: of all, or of a round, which ends where its file has another text. What was counted in it is
/// reported then, and forgotten.
fn wanted() -> Option<String> {
    let Some(path) = env::var_os("FUMAROLE_LAYER_ROUNDS") else { return env::var("FUMAROLE_LAYER_FAIL").ok() };
    let text = fs::read_to_string(path).unwrap_or_default();
    let mut round = ROUND.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if *round != text {
        report();
        counts().clear();
        *FAILED.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = None;
        LOST.store(false, Ordering::Release);
        round.clone_from(&text);
    }
    text.split_once(' ').map(|(_, failing)| failing.to_owned())
}

/// Counts a call; its failure, if it is the one that is to fail.
pub fn counted(name: &'static str) -> Option<vk::Result> {
    let wanted = wanted();
    let number = {
        let mut counts = counts();
        let count = counts.entry(name).or_default();
        *count += 1;
        *count
    };
    let wanted = wanted?;
    if env::var("FUMAROLE_LAYER_ONLY").is_ok_and(|only| env::args().all(|argument| argument != only)) {
        return None;
    }
    let (call, failure) = wanted.split_once(':')?;
    let (wanted, at) = call.split_once('@')?;
    if wanted != name || at != "0" && at.parse() != Ok(number) {
        return None;
    }
    *FAILED.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(name);
    Some(match failure {
        "host" => vk::Result::ERROR_OUT_OF_HOST_MEMORY,
        "device" => vk::Result::ERROR_OUT_OF_DEVICE_MEMORY,
        _ => {
            LOST.store(true, Ordering::Release);
            vk::Result::ERROR_DEVICE_LOST
        }
    })
}

/// The kind of object that a command makes or ends.
fn kind(name: &str) -> Option<&str> {
    let verbs = ["vkCreateGraphics", "vkCreateCompute", "vkCreate", "vkAllocate", "vkDestroy", "vkFree"];
    let kind = verbs.iter().find_map(|verb| name.strip_prefix(verb))?;
    let kind = kind.trim_end_matches('2').trim_end_matches('s');
    // Whatever the kind of display.
    let kind = if kind.ends_with("SurfaceKHR") { "SurfaceKHR" } else { kind };
    // Both go with their pools.
    (!["DescriptorSet", "CommandBuffer"].contains(&kind)).then_some(kind)
}

fn change(kind: &str, by: i64) {
    *ALIVE.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).entry(kind.to_owned()).or_default() += by;
}

/// Counts an object that was made.
pub fn born(kind: &str) {
    change(kind, 1);
}

/// Counts an object that was ended.
pub fn died(kind: &str) {
    change(kind, -1);
}

unsafe fn wait_idle(device: usize) {
    let index = RESULTS.iter().position(|&name| name == "vkDeviceWaitIdle").unwrap_or_default();
    let next = NEXT_RESULTS[index].load(Ordering::Acquire);
    // SAFETY: the address is that of the command, the device the caller's. Its result changes nothing.
    let _ = unsafe { transmute::<usize, unsafe extern "system" fn(usize) -> vk::Result>(next)(device) };
}

unsafe extern "system" fn result<const I: usize>(
    a: usize,
    b: usize,
    c: usize,
    d: usize,
    e: usize,
    f: usize,
    g: usize,
    h: usize,
) -> vk::Result {
    let name = RESULTS[I];
    let failure = counted(name);
    if LOST.load(Ordering::Acquire) && LOST_FOR.contains(&name) {
        // A lost device executes nothing more, the real one might.
        if !name.starts_with("vkQueue") {
            // SAFETY: the first argument of these calls is the device.
            unsafe { wait_idle(a) };
        }
        return vk::Result::ERROR_DEVICE_LOST;
    }
    if let Some(failure) = failure {
        return failure;
    }
    // SAFETY: the address is that of the command of this name, and the arguments are the caller's.
    let outcome = unsafe { transmute::<usize, Call>(NEXT_RESULTS[I].load(Ordering::Acquire))(a, b, c, d, e, f, g, h) };
    if outcome == vk::Result::SUCCESS
        && let Some(kind) = kind(name).filter(|_| name.starts_with("vkCreate") || name.starts_with("vkAllocate"))
    {
        born(kind);
    }
    outcome
}

/// Ends an instance or a device, or a device's object.
unsafe extern "system" fn end<const I: usize>(parent: usize, object: usize, allocator: usize) {
    let name = if I == ENDS.len() { END_OF_POOL } else { ENDS[I] };
    let is_root = matches!(name, "vkDestroyInstance" | "vkDestroyDevice");
    if is_root && parent != 0 || !is_root && object != 0 {
        change(kind(name).unwrap_or_default(), -1);
    }
    let next = NEXT_ENDS[I].load(Ordering::Acquire);
    // SAFETY: as above.
    unsafe { transmute::<usize, unsafe extern "system" fn(usize, usize, usize)>(next)(parent, object, allocator) };
    if name == "vkDestroyInstance" {
        report();
    }
}

/// Writes how often each call was made, the one that failed, and what is alive.
fn report() {
    let Some(path) = env::var_os("FUMAROLE_LAYER_REPORT") else { return };
    let mut text = String::new();
    for (name, count) in counts().iter() {
        let _infallible = writeln!(text, "call {name} {count}");
    }
    if let Some(name) = *FAILED.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) {
        let _infallible = writeln!(text, "failed {name}");
    }
    for (kind, count) in ALIVE.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).iter() {
        if *count != 0 {
            let _infallible = writeln!(text, "alive {kind} {count}");
        }
    }
    text.push_str(&crate::lend::report());
    text.push_str(&crate::labels::report());
    // A test that finds no report fails.
    let _ = fs::write(path, text);
}

/// Finds the next functions of all that is hooked.
pub fn resolve(next: &dyn Fn(&CStr) -> vk::PFN_vkVoidFunction) {
    let ends = ENDS.iter().chain([&END_OF_POOL]).zip(&NEXT_ENDS);
    for (name, slot) in RESULTS.iter().zip(&NEXT_RESULTS).chain(ends) {
        if let Some(found) = CString::new(*name).ok().and_then(|name| next(&name)) {
            slot.store(found as usize, Ordering::Release);
        }
    }
}

macro_rules! table {
    ($function:ident; $($index:literal)*) => { [$($function::<$index> as *const c_void),*] };
}

/// The hook before a command, if it has one.
pub fn hook(name: &str) -> Option<*const c_void> {
    let results: [*const c_void; RESULTS.len()] = table!(result;
        0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32 33 34 35 36 37 38 39 40
        41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64 65 66 67 68 69 70 71 72 73 74 75 76);
    let ends: [*const c_void; ENDS.len() + 1] = table!(end; 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20);
    let result = RESULTS.iter().position(|&hooked| hooked == name).map(|index| results[index]);
    let end = ENDS.iter().chain([&END_OF_POOL]).position(|&hooked| hooked == name);
    result.or(end.map(|index| ends[index]))
}
