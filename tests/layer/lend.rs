//! Extensions that the driver lacks and the layer plays: counters of the device, what its compiler made of pipelines, ends
//! of frames, fences of presents. What their rules forbid is written down, and told in the report.

mod pipelines;
mod queries;

use std::collections::BTreeMap;
use std::env;
use std::ffi::{CStr, CString, c_char, c_void};
use std::fmt::Write;
use std::mem::transmute_copy;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard};

use ash::{ext, khr, vk};

use crate::calls;
use crate::mask::change_in_chain;

const FRAME_BOUNDARY: &CStr = c"VK_EXT_frame_boundary";

/// The word that lends an extension, and the extension.
const LENT: [(&str, &CStr); 4] = [
    ("present-fences", ext::swapchain_maintenance1::NAME),
    ("performance-query", khr::performance_query::NAME),
    ("executable-properties", khr::pipeline_executable_properties::NAME),
    ("frame-boundary", FRAME_BOUNDARY),
];

pub fn lends(word: &str) -> bool {
    env::var("FUMAROLE_LAYER_LENDS").is_ok_and(|list| list.split(',').any(|lent| lent == word))
}

/// The extensions that are lent now.
pub fn lent() -> impl Iterator<Item = &'static CStr> {
    LENT.into_iter().filter(|(word, _)| lends(word)).map(|(_, name)| name)
}

/// True of what the driver must not be asked for.
///
/// # Safety
/// The name ends in a zero.
pub unsafe fn is_lent(name: *const c_char) -> bool {
    // SAFETY: the caller's.
    let name = unsafe { CStr::from_ptr(name) };
    lent().any(|lent| lent == name)
}

/// Commands inside a query.
#[derive(Clone, Copy, Default)]
struct Counts {
    draws: u32,
    dispatches: u32,
    render_passes: u32,
}

#[derive(Default)]
struct Buffer {
    /// The lock was held when it began.
    is_locked: bool,
    /// Something stands in it.
    is_begun: bool,
    is_in_render_pass: bool,
    open: Option<(u64, u32)>,
    counts: Counts,
    ended: Vec<(u64, u32, Counts)>,
}

struct Pool {
    counters: Vec<u32>,
    replays: u32,
    /// Of each query, what each replay counted; nothing before a reset.
    queries: Vec<Option<BTreeMap<u32, Counts>>>,
}

struct State {
    is_locked: bool,
    buffers: BTreeMap<u64, Buffer>,
    pools: BTreeMap<u64, Pool>,
    /// Stages of each pipeline, and whether it keeps what is known of it.
    pipelines: BTreeMap<u64, (vk::ShaderStageFlags, bool)>,
    made: u64,
    frame: Option<u64>,
    frames: u64,
    misuses: Vec<String>,
}

static STATE: Mutex<State> = Mutex::new(State {
    is_locked: false,
    buffers: BTreeMap::new(),
    pools: BTreeMap::new(),
    pipelines: BTreeMap::new(),
    made: 0,
    frame: None,
    frames: 0,
    misuses: Vec::new(),
});

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl State {
    fn check(&mut self, holds: bool, rule: &str) {
        if !holds && self.misuses.len() < 20 {
            self.misuses.push(rule.to_owned());
        }
    }

    /// Notes a command of a buffer; `count` what it is.
    fn command(&mut self, buffer: vk::CommandBuffer, count: impl Fn(&mut Counts)) {
        let buffer = self.buffers.entry(ash::vk::Handle::as_raw(buffer)).or_default();
        buffer.is_begun = true;
        if buffer.open.is_some() {
            count(&mut buffer.counts);
        }
        let is_last = buffer.open.is_some() || buffer.ended.is_empty();
        self.check(is_last, "a command after the end of a query of the command buffer");
    }
}

/// Lines of the report.
pub fn report() -> String {
    let mut state = state();
    let is_free = !state.is_locked;
    state.check(is_free, "the profiling lock is held at the end");
    let mut text = String::new();
    for misuse in &state.misuses {
        let _infallible = writeln!(text, "misuse {misuse}");
    }
    let _infallible = writeln!(text, "frames {}", state.frames);
    text
}

/// Commands that go on to the driver, or to the layer's other hooks.
const NAMES: [&str; 20] = [
    "vkEnumerateDeviceExtensionProperties",
    "vkCreateQueryPool",
    "vkDestroyQueryPool",
    "vkResetQueryPool",
    "vkGetQueryPoolResults",
    "vkCmdBeginQuery",
    "vkCmdEndQuery",
    "vkBeginCommandBuffer",
    "vkQueueSubmit2",
    "vkCmdDraw",
    "vkCmdDrawIndexed",
    "vkCmdDrawIndirect",
    "vkCmdDrawIndexedIndirect",
    "vkCmdDispatch",
    "vkCmdDispatchIndirect",
    "vkCmdPipelineBarrier2",
    "vkCmdBeginRenderPass",
    "vkCmdEndRenderPass",
    "vkCreateGraphicsPipelines",
    "vkCreateComputePipelines",
];

static NEXT: [AtomicUsize; NAMES.len()] = [const { AtomicUsize::new(0) }; NAMES.len()];

/// Finds the next functions of all that is hooked.
pub fn resolve(next: &dyn Fn(&CStr) -> vk::PFN_vkVoidFunction) {
    for (name, slot) in NAMES.iter().zip(&NEXT) {
        let below = || CString::new(*name).ok().and_then(|name| next(&name)).map(|found| found as usize);
        if let Some(found) = calls::hook(name).map(|hook| hook as usize).or_else(below) {
            slot.store(found, Ordering::Release);
        }
    }
}

/// The next function of this name.
///
/// # Safety
/// `F` is the type of a pointer to the command of this name.
unsafe fn next<F: Copy>(name: &str) -> F {
    let index = NAMES.iter().position(|&hooked| hooked == name).unwrap_or_default();
    let address = NEXT[index].load(Ordering::Acquire);
    // SAFETY: a function pointer has the size of an address, and its type is right by the caller.
    unsafe { transmute_copy(&address) }
}

/// The hook before a command, if it has one; the whole command for one that the driver lacks.
pub fn hook(name: &str) -> Option<*const c_void> {
    lent().next()?;
    // What presents is in `presents.rs`.
    let is_presents_alone = lent().all(|name| name == ext::swapchain_maintenance1::NAME);
    Some(match name {
        "vkEnumerateDeviceExtensionProperties" => extensions as *const c_void,
        _ if is_presents_alone => return None,
        "vkCreateQueryPool" => queries::create_pool as *const c_void,
        "vkDestroyQueryPool" => queries::destroy_pool as *const c_void,
        "vkResetQueryPool" => queries::reset_pool as *const c_void,
        "vkGetQueryPoolResults" => queries::results as *const c_void,
        "vkCmdBeginQuery" => queries::begin_query as *const c_void,
        "vkCmdEndQuery" => queries::end_query as *const c_void,
        "vkBeginCommandBuffer" => queries::begin_buffer as *const c_void,
        "vkQueueSubmit2" => queries::submit as *const c_void,
        "vkCmdDraw" => queries::draw as *const c_void,
        "vkCmdDrawIndexed" => queries::draw_indexed as *const c_void,
        "vkCmdDrawIndirect" => queries::draw_indirect as *const c_void,
        "vkCmdDrawIndexedIndirect" => queries::draw_indexed_indirect as *const c_void,
        "vkCmdDispatch" => queries::dispatch as *const c_void,
        "vkCmdDispatchIndirect" => queries::dispatch_indirect as *const c_void,
        "vkCmdPipelineBarrier2" => queries::barrier as *const c_void,
        "vkCmdBeginRenderPass" => queries::begin_render_pass as *const c_void,
        "vkCmdEndRenderPass" => queries::end_render_pass as *const c_void,
        "vkCreateGraphicsPipelines" => pipelines::create_graphics as *const c_void,
        "vkCreateComputePipelines" => pipelines::create_compute as *const c_void,
        _ => whole(name)?,
    })
}

/// A command of a lent extension.
pub fn whole(name: &str) -> Option<*const c_void> {
    let of_extension = |word: &str, function: *const c_void| lends(word).then_some(function);
    match name {
        "vkEnumeratePhysicalDeviceQueueFamilyPerformanceQueryCountersKHR" => {
            of_extension("performance-query", queries::counters as *const c_void)
        }
        "vkGetPhysicalDeviceQueueFamilyPerformanceQueryPassesKHR" => {
            of_extension("performance-query", queries::passes as *const c_void)
        }
        "vkAcquireProfilingLockKHR" => of_extension("performance-query", queries::lock as *const c_void),
        "vkReleaseProfilingLockKHR" => of_extension("performance-query", queries::unlock as *const c_void),
        "vkGetPipelineExecutablePropertiesKHR" => {
            of_extension("executable-properties", pipelines::executables as *const c_void)
        }
        "vkGetPipelineExecutableStatisticsKHR" => {
            of_extension("executable-properties", pipelines::statistics as *const c_void)
        }
        "vkGetPipelineExecutableInternalRepresentationsKHR" => {
            of_extension("executable-properties", pipelines::representations as *const c_void)
        }
        _ => None,
    }
}

/// Answers of a list that is asked for twice.
///
/// # Safety
/// `found` is null or has room for as many as `count` says, each a structure whose type and chain are set.
unsafe fn list<T>(all: Vec<T>, count: *mut u32, found: *mut T) -> vk::Result {
    // SAFETY: the caller's.
    unsafe {
        if found.is_null() {
            *count = all.len() as u32;
            return vk::Result::SUCCESS;
        }
        let written = all.len().min(*count as usize);
        let is_whole = written == all.len();
        for (index, one) in all.into_iter().take(written).enumerate() {
            found.add(index).write(one);
        }
        *count = written as u32;
        if is_whole { vk::Result::SUCCESS } else { vk::Result::INCOMPLETE }
    }
}

fn write<const N: usize>(to: &mut [c_char; N], text: &str) {
    for (to, from) in to.iter_mut().zip(text.bytes().chain([0])) {
        *to = from as c_char;
    }
}

unsafe extern "system" fn extensions(
    physical: vk::PhysicalDevice,
    layer: *const c_char,
    count: *mut u32,
    found: *mut vk::ExtensionProperties,
) -> vk::Result {
    // SAFETY: here and below, the caller's arguments go through, and what it gives to be filled lives for the call.
    unsafe {
        let next: vk::PFN_vkEnumerateDeviceExtensionProperties = next("vkEnumerateDeviceExtensionProperties");
        if !layer.is_null() {
            return next(physical, layer, count, found);
        }
        let mut all = Vec::new();
        let mut of_driver = 0;
        let result = next(physical, layer, &mut of_driver, std::ptr::null_mut());
        if result != vk::Result::SUCCESS {
            return result;
        }
        all.resize(of_driver as usize, vk::ExtensionProperties::default());
        let result = next(physical, layer, &mut of_driver, all.as_mut_ptr());
        if result != vk::Result::SUCCESS {
            return result;
        }
        all.truncate(of_driver as usize);
        all.retain(|one| !is_lent(one.extension_name.as_ptr()));
        for name in lent() {
            let mut one = vk::ExtensionProperties { spec_version: 1, ..Default::default() };
            write(&mut one.extension_name, &name.to_string_lossy());
            all.push(one);
        }
        list(all, count, found)
    }
}

const FEATURES: [vk::StructureType; 4] = [
    vk::StructureType::PHYSICAL_DEVICE_SWAPCHAIN_MAINTENANCE_1_FEATURES_EXT,
    vk::StructureType::PHYSICAL_DEVICE_PERFORMANCE_QUERY_FEATURES_KHR,
    vk::StructureType::PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR,
    vk::StructureType::PHYSICAL_DEVICE_FRAME_BOUNDARY_FEATURES_EXT,
];

/// Takes the lent features out of a chain, for a driver that knows and refuses them, and gives back what restores it.
///
/// # Safety
/// The chain is Vulkan's, nobody else looks at it, and it lives until what is given back was called.
pub unsafe fn without_features(first: &mut *const c_void) -> impl FnOnce() + use<> {
    let mut taken: Vec<(*mut vk::BaseOutStructure<'static>, *mut vk::BaseOutStructure<'static>)> = Vec::new();
    // SAFETY: see above; every structure of a chain begins as this one does.
    unsafe {
        while let Some(head) = first.cast::<vk::BaseOutStructure<'static>>().as_ref()
            && FEATURES.contains(&head.s_type)
            && lent().next().is_some()
        {
            *first = head.p_next.cast_const().cast();
        }
        let mut at = first.cast_mut().cast::<vk::BaseOutStructure<'static>>();
        while let Some(one) = at.as_mut() {
            match one.p_next.as_ref() {
                Some(next) if FEATURES.contains(&next.s_type) && lent().next().is_some() => {
                    taken.push((at, one.p_next));
                    one.p_next = next.p_next;
                }
                _ => at = one.p_next,
            }
        }
    }
    move || {
        for (before, one) in taken.into_iter().rev() {
            // SAFETY: as above; what was taken last comes back first.
            unsafe { (*before).p_next = one };
        }
    }
}

/// Features of the lent extensions in a chain that is filled.
///
/// # Safety
/// The chain is Vulkan's.
pub unsafe fn features(chain: *mut c_void) {
    use vk::StructureType as Type;
    // SAFETY: the types are those of their structures.
    unsafe {
        if lends("present-fences") {
            let change = |found: &mut vk::PhysicalDeviceSwapchainMaintenance1FeaturesEXT<'_>| {
                found.swapchain_maintenance1 = vk::TRUE;
            };
            change_in_chain(chain, Type::PHYSICAL_DEVICE_SWAPCHAIN_MAINTENANCE_1_FEATURES_EXT, change);
        }
        if lends("performance-query") {
            let change = |found: &mut vk::PhysicalDevicePerformanceQueryFeaturesKHR<'_>| {
                found.performance_counter_query_pools = vk::TRUE;
            };
            change_in_chain(chain, Type::PHYSICAL_DEVICE_PERFORMANCE_QUERY_FEATURES_KHR, change);
        }
        if lends("executable-properties") {
            let change = |found: &mut vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR<'_>| {
                found.pipeline_executable_info = vk::TRUE;
            };
            change_in_chain(chain, Type::PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR, change);
        }
        if lends("frame-boundary") {
            let change = |found: &mut vk::PhysicalDeviceFrameBoundaryFeaturesEXT<'_>| found.frame_boundary = vk::TRUE;
            change_in_chain(chain, Type::PHYSICAL_DEVICE_FRAME_BOUNDARY_FEATURES_EXT, change);
        }
    }
}
