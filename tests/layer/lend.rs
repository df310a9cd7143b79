//! Extensions that the driver lacks and the layer plays: counters of the device, what its compiler made of pipelines, ends
//! of frames. What their rules forbid is written down, and told in the report.

use std::collections::BTreeMap;
use std::env;
use std::ffi::{CStr, CString, c_char, c_void};
use std::fmt::Write;
use std::mem::transmute_copy;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard};

use ash::{khr, vk};
use vk::{
    PerformanceCounterScopeKHR as Scope, PerformanceCounterStorageKHR as Storage, PerformanceCounterUnitKHR as Unit,
};

use crate::calls;
use crate::mask::change_in_chain;

const FRAME_BOUNDARY: &CStr = c"VK_EXT_frame_boundary";

/// The word that lends an extension, and the extension.
const LENT: [(&str, &CStr); 3] = [
    ("performance-query", khr::performance_query::NAME),
    ("executable-properties", khr::pipeline_executable_properties::NAME),
    ("frame-boundary", FRAME_BOUNDARY),
];

fn lends(word: &str) -> bool {
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

/// A played counter; every two take a replay.
struct Counter {
    name: &'static str,
    unit: Unit,
    scope: Scope,
    storage: Storage,
    /// The value, of what was recorded inside the query.
    value: fn(&Counts) -> vk::PerformanceCounterResultKHR,
}

const A_REPLAY: usize = 2;

const COUNTERS: [Counter; 8] = [
    counter("draws", Unit::GENERIC, Scope::COMMAND, Storage::UINT32, |counts| vk::PerformanceCounterResultKHR {
        uint32: counts.draws,
    }),
    counter("dispatches", Unit::GENERIC, Scope::COMMAND, Storage::UINT64, |counts| vk::PerformanceCounterResultKHR {
        uint64: counts.dispatches.into(),
    }),
    counter("render-passes", Unit::GENERIC, Scope::RENDER_PASS, Storage::INT32, |counts| {
        vk::PerformanceCounterResultKHR { int32: counts.render_passes as i32 }
    }),
    counter("traffic", Unit::BYTES, Scope::COMMAND_BUFFER, Storage::UINT64, |_| vk::PerformanceCounterResultKHR {
        uint64: (1 << 60) + 1,
    }),
    counter("busy", Unit::PERCENTAGE, Scope::COMMAND_BUFFER, Storage::FLOAT32, |_| vk::PerformanceCounterResultKHR {
        float32: 37.5,
    }),
    counter("heat", Unit::KELVIN, Scope::COMMAND, Storage::FLOAT64, |_| vk::PerformanceCounterResultKHR {
        float64: 300.25,
    }),
    counter("drift", Unit::CYCLES, Scope::COMMAND, Storage::INT64, |_| vk::PerformanceCounterResultKHR { int64: -7 }),
    counter("nothing", Unit::WATTS, Scope::COMMAND, Storage::FLOAT64, |_| vk::PerformanceCounterResultKHR {
        float64: f64::NAN,
    }),
];

const fn counter(
    name: &'static str,
    unit: Unit,
    scope: Scope,
    storage: Storage,
    value: fn(&Counts) -> vk::PerformanceCounterResultKHR,
) -> Counter {
    Counter { name, unit, scope, storage, value }
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
    Some(match name {
        "vkEnumerateDeviceExtensionProperties" => extensions as *const c_void,
        "vkCreateQueryPool" => create_pool as *const c_void,
        "vkDestroyQueryPool" => destroy_pool as *const c_void,
        "vkResetQueryPool" => reset_pool as *const c_void,
        "vkGetQueryPoolResults" => results as *const c_void,
        "vkCmdBeginQuery" => begin_query as *const c_void,
        "vkCmdEndQuery" => end_query as *const c_void,
        "vkBeginCommandBuffer" => begin_buffer as *const c_void,
        "vkQueueSubmit2" => submit as *const c_void,
        "vkCmdDraw" => draw as *const c_void,
        "vkCmdDrawIndexed" => draw_indexed as *const c_void,
        "vkCmdDrawIndirect" => draw_indirect as *const c_void,
        "vkCmdDrawIndexedIndirect" => draw_indexed_indirect as *const c_void,
        "vkCmdDispatch" => dispatch as *const c_void,
        "vkCmdDispatchIndirect" => dispatch_indirect as *const c_void,
        "vkCmdPipelineBarrier2" => barrier as *const c_void,
        "vkCmdBeginRenderPass" => begin_render_pass as *const c_void,
        "vkCmdEndRenderPass" => end_render_pass as *const c_void,
        "vkCreateGraphicsPipelines" => create_graphics as *const c_void,
        "vkCreateComputePipelines" => create_compute as *const c_void,
        _ => whole(name)?,
    })
}

/// A command of a lent extension.
pub fn whole(name: &str) -> Option<*const c_void> {
    let of_extension = |word: &str, function: *const c_void| lends(word).then_some(function);
    match name {
        "vkEnumeratePhysicalDeviceQueueFamilyPerformanceQueryCountersKHR" => {
            of_extension("performance-query", counters as *const c_void)
        }
        "vkGetPhysicalDeviceQueueFamilyPerformanceQueryPassesKHR" => {
            of_extension("performance-query", passes as *const c_void)
        }
        "vkAcquireProfilingLockKHR" => of_extension("performance-query", lock as *const c_void),
        "vkReleaseProfilingLockKHR" => of_extension("performance-query", unlock as *const c_void),
        "vkGetPipelineExecutablePropertiesKHR" => of_extension("executable-properties", executables as *const c_void),
        "vkGetPipelineExecutableStatisticsKHR" => of_extension("executable-properties", statistics as *const c_void),
        "vkGetPipelineExecutableInternalRepresentationsKHR" => {
            of_extension("executable-properties", representations as *const c_void)
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

const FEATURES: [vk::StructureType; 3] = [
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

unsafe extern "system" fn counters(
    _physical: vk::PhysicalDevice,
    _family: u32,
    count: *mut u32,
    found: *mut vk::PerformanceCounterKHR<'_>,
    described: *mut vk::PerformanceCounterDescriptionKHR<'_>,
) -> vk::Result {
    if let Some(failure) = calls::counted("vkEnumeratePhysicalDeviceQueueFamilyPerformanceQueryCountersKHR") {
        return failure;
    }
    let counters = COUNTERS.iter().enumerate().map(|(index, one)| vk::PerformanceCounterKHR {
        unit: one.unit,
        scope: one.scope,
        storage: one.storage,
        uuid: [index as u8; vk::UUID_SIZE],
        ..Default::default()
    });
    let descriptions = COUNTERS.iter().map(|one| {
        let mut description = vk::PerformanceCounterDescriptionKHR::default();
        write(&mut description.name, one.name);
        write(&mut description.category, "played");
        write(&mut description.description, &format!("what the tests' layer plays as {}", one.name));
        description
    });
    // SAFETY: as above.
    unsafe {
        if !described.is_null() {
            let mut room = *count;
            let _of_the_counters = list(descriptions.collect(), &mut room, described);
        }
        list(counters.collect(), count, found)
    }
}

fn replays(indices: &[u32]) -> u32 {
    indices.len().div_ceil(A_REPLAY) as u32
}

/// # Safety
/// The structure is Vulkan's.
unsafe fn indices(info: &vk::QueryPoolPerformanceCreateInfoKHR<'_>) -> Vec<u32> {
    // SAFETY: the caller's.
    unsafe { std::slice::from_raw_parts(info.p_counter_indices, info.counter_index_count as usize) }.to_vec()
}

unsafe extern "system" fn passes(
    _physical: vk::PhysicalDevice,
    info: *const vk::QueryPoolPerformanceCreateInfoKHR<'_>,
    count: *mut u32,
) {
    // SAFETY: as above.
    unsafe { *count = replays(&indices(&*info)) };
}

unsafe extern "system" fn lock(_device: vk::Device, _info: *const vk::AcquireProfilingLockInfoKHR<'_>) -> vk::Result {
    if let Some(failure) = calls::counted("vkAcquireProfilingLockKHR") {
        return failure;
    }
    if env::var_os("FUMAROLE_LAYER_LOCKED").is_some() {
        return vk::Result::TIMEOUT;
    }
    let mut state = state();
    let is_free = !state.is_locked;
    state.check(is_free, "the profiling lock is taken twice");
    state.is_locked = true;
    vk::Result::SUCCESS
}

unsafe extern "system" fn unlock(_device: vk::Device) {
    let mut state = state();
    let is_held = state.is_locked;
    state.check(is_held, "the profiling lock is given back that nobody holds");
    state.is_locked = false;
}

unsafe extern "system" fn create_pool(
    device: vk::Device,
    info: *const vk::QueryPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::QueryPool,
) -> vk::Result {
    // SAFETY: as above.
    unsafe {
        if (*info).query_type != vk::QueryType::PERFORMANCE_QUERY_KHR {
            let next: vk::PFN_vkCreateQueryPool = next("vkCreateQueryPool");
            return next(device, info.cast(), allocator.cast(), pool);
        }
        if let Some(failure) = calls::counted("vkCreateQueryPool") {
            return failure;
        }
        let mut chosen = Vec::new();
        let chain = (*info).p_next.cast_mut();
        let wanted = vk::StructureType::QUERY_POOL_PERFORMANCE_CREATE_INFO_KHR;
        change_in_chain(chain, wanted, |found: &mut vk::QueryPoolPerformanceCreateInfoKHR<'_>| {
            chosen = indices(found);
        });
        let mut state = state();
        let are_known = !chosen.is_empty() && chosen.iter().all(|&index| (index as usize) < COUNTERS.len());
        state.check(are_known, "a pool of counters that there are not");
        state.made += 1;
        // No driver gives an address like this.
        let handle = (0xf0_0000 << 40) + state.made;
        let replays = replays(&chosen);
        let queries = (0..(*info).query_count).map(|_| None).collect();
        state.pools.insert(handle, Pool { counters: chosen, replays, queries });
        *pool = ash::vk::Handle::from_raw(handle);
        calls::born("QueryPool");
    }
    vk::Result::SUCCESS
}

unsafe extern "system" fn destroy_pool(
    device: vk::Device,
    pool: vk::QueryPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    if state().pools.remove(&ash::vk::Handle::as_raw(pool)).is_some() {
        calls::died("QueryPool");
        return;
    }
    // SAFETY: as above.
    unsafe { next::<vk::PFN_vkDestroyQueryPool>("vkDestroyQueryPool")(device, pool, allocator.cast()) };
}

unsafe extern "system" fn reset_pool(device: vk::Device, pool: vk::QueryPool, first: u32, count: u32) {
    if let Some(pool) = state().pools.get_mut(&ash::vk::Handle::as_raw(pool)) {
        let queries = pool.queries.iter_mut().skip(first as usize).take(count as usize);
        queries.for_each(|query| *query = Some(BTreeMap::new()));
        return;
    }
    // SAFETY: as above.
    unsafe { next::<vk::PFN_vkResetQueryPool>("vkResetQueryPool")(device, pool, first, count) };
}

unsafe extern "system" fn results(
    device: vk::Device,
    pool: vk::QueryPool,
    first: u32,
    count: u32,
    size: usize,
    data: *mut c_void,
    stride: vk::DeviceSize,
    flags: vk::QueryResultFlags,
) -> vk::Result {
    let mut state = state();
    let handle = ash::vk::Handle::as_raw(pool);
    let Some(played) = state.pools.get(&handle) else {
        drop(state);
        // SAFETY: as above.
        return unsafe {
            let next: vk::PFN_vkGetQueryPoolResults = next("vkGetQueryPoolResults");
            next(device, pool, first, count, size, data, stride, flags)
        };
    };
    if let Some(failure) = calls::counted("vkGetQueryPoolResults") {
        return failure;
    }
    let is_whole = |query: &Option<BTreeMap<u32, Counts>>| {
        query.as_ref().is_some_and(|replays| (0..played.replays).all(|replay| replays.contains_key(&replay)))
    };
    let asked = played.queries.iter().skip(first as usize).take(count as usize);
    let are_whole = asked.clone().count() == count as usize && asked.clone().all(is_whole);
    let bytes = 8 * played.counters.len() as u64;
    let has_room = stride >= bytes && stride.is_multiple_of(8) && size as u64 >= stride * u64::from(count);
    if are_whole && has_room {
        for (number, replays) in asked.flatten().enumerate() {
            for (place, &index) in played.counters.iter().enumerate() {
                let counts = replays[&((place / A_REPLAY) as u32)];
                let result = (COUNTERS[index as usize].value)(&counts);
                // SAFETY: the caller has room for as many, and a driver writes what the storage has and no more.
                unsafe {
                    let to = data.cast::<u8>().add(number * stride as usize + 8 * place);
                    let from = (&raw const result).cast::<u8>();
                    let bytes = match COUNTERS[index as usize].storage {
                        Storage::INT32 | Storage::UINT32 | Storage::FLOAT32 => 4,
                        _ => 8,
                    };
                    std::ptr::copy_nonoverlapping(from, to, bytes);
                }
            }
        }
    }
    state.check(are_whole, "results of a query that not every replay has recorded");
    state.check(has_room, "results without room for them");
    state.check(flags == vk::QueryResultFlags::WAIT, "results with other flags than may be");
    vk::Result::SUCCESS
}

unsafe extern "system" fn begin_query(
    commands: vk::CommandBuffer,
    pool: vk::QueryPool,
    query: u32,
    flags: vk::QueryControlFlags,
) {
    let mut state = state();
    let handle = ash::vk::Handle::as_raw(pool);
    if !state.pools.contains_key(&handle) {
        state.command(commands, |_| {});
        drop(state);
        // SAFETY: as above.
        return unsafe { next::<vk::PFN_vkCmdBeginQuery>("vkCmdBeginQuery")(commands, pool, query, flags) };
    }
    let buffer = state.buffers.entry(ash::vk::Handle::as_raw(commands)).or_default();
    let (is_locked, is_first, is_outside) = (buffer.is_locked, !buffer.is_begun, !buffer.is_in_render_pass);
    buffer.is_begun = true;
    buffer.open = Some((handle, query));
    buffer.counts = Counts::default();
    state.check(is_locked, "a query in a command buffer that began without the profiling lock");
    state.check(is_first, "a query of a command buffer that is not its first command");
    state.check(is_outside, "a query that begins inside a render pass");
}

unsafe extern "system" fn end_query(commands: vk::CommandBuffer, pool: vk::QueryPool, query: u32) {
    let mut state = state();
    let handle = ash::vk::Handle::as_raw(pool);
    if !state.pools.contains_key(&handle) {
        state.command(commands, |_| {});
        drop(state);
        // SAFETY: as above.
        return unsafe { next::<vk::PFN_vkCmdEndQuery>("vkCmdEndQuery")(commands, pool, query) };
    }
    let buffer = state.buffers.entry(ash::vk::Handle::as_raw(commands)).or_default();
    let is_open = buffer.open.take() == Some((handle, query));
    let is_outside = !buffer.is_in_render_pass;
    buffer.ended.push((handle, query, buffer.counts));
    state.check(is_open, "a query that ends and has not begun");
    state.check(is_outside, "a query that ends inside a render pass");
}

unsafe extern "system" fn begin_buffer(
    commands: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    let mut state = state();
    let buffer = Buffer { is_locked: state.is_locked, ..Buffer::default() };
    state.buffers.insert(ash::vk::Handle::as_raw(commands), buffer);
    drop(state);
    // SAFETY: as above.
    unsafe { next::<vk::PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer")(commands, info.cast()) }
}

unsafe extern "system" fn submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    use vk::StructureType as Type;
    // SAFETY: as above.
    unsafe {
        for one in std::slice::from_raw_parts(submits, count as usize) {
            let chain = one.p_next.cast_mut();
            let (mut replay, mut boundary) = (None, None);
            change_in_chain(
                chain,
                Type::PERFORMANCE_QUERY_SUBMIT_INFO_KHR,
                |found: &mut vk::PerformanceQuerySubmitInfoKHR<'_>| replay = Some(found.counter_pass_index),
            );
            change_in_chain(chain, Type::FRAME_BOUNDARY_EXT, |found: &mut vk::FrameBoundaryEXT<'_>| {
                boundary = Some((found.flags, found.frame_id));
            });
            let buffers =
                std::slice::from_raw_parts(one.p_command_buffer_infos, one.command_buffer_info_count as usize);
            let mut state = state();
            for buffer in buffers {
                executed(&mut state, buffer.command_buffer, replay);
            }
            if let Some((flags, frame)) = boundary {
                state.check(lends("frame-boundary"), "the end of a frame without the extension");
                state.check(flags == vk::FrameBoundaryFlagsEXT::FRAME_END, "a boundary that ends no frame");
                let is_later = state.frame.is_none_or(|last| last < frame);
                state.check(is_later, "the number of a frame that has ended");
                state.frame = Some(frame);
                state.frames += 1;
            }
        }
        next::<vk::PFN_vkQueueSubmit2>("vkQueueSubmit2")(queue, count, submits.cast(), fence)
    }
}

/// Takes what the queries of a buffer count.
fn executed(state: &mut State, commands: vk::CommandBuffer, replay: Option<u32>) {
    let buffer = state.buffers.entry(ash::vk::Handle::as_raw(commands)).or_default();
    let (ended, is_closed) = (std::mem::take(&mut buffer.ended), buffer.open.is_none());
    state.check(is_closed, "a query that does not end in its command buffer");
    let is_fitting = !ended.is_empty() || replay.is_none();
    state.check(is_fitting, "the number of a replay for a submission without a query");
    for (pool, query, counts) in ended {
        let replay = replay.unwrap_or_default();
        let is_locked = state.is_locked;
        state.check(is_locked, "a query that is submitted without the profiling lock");
        let Some(pool) = state.pools.get_mut(&pool) else { continue };
        let is_known = replay < pool.replays;
        let slot = pool.queries.get_mut(query as usize).and_then(Option::as_mut);
        let is_reset = slot.is_some_and(|replays| replays.insert(replay, counts).is_none());
        state.check(is_known, "a replay that the counters do not need");
        state.check(is_reset, "a query that was not reset");
    }
}

macro_rules! command {
    ($function:ident, $name:literal, $type:ty, ($($argument:ident: $of:ty),*), $count:expr) => {
        unsafe extern "system" fn $function(commands: vk::CommandBuffer, $($argument: $of),*) {
            state().command(commands, $count);
            // SAFETY: as above.
            unsafe { next::<$type>($name)(commands, $($argument),*) };
        }
    };
}

command!(draw, "vkCmdDraw", vk::PFN_vkCmdDraw, (a: u32, b: u32, c: u32, d: u32), |counts| counts.draws += 1);
command!(
    draw_indexed, "vkCmdDrawIndexed", vk::PFN_vkCmdDrawIndexed, (a: u32, b: u32, c: u32, d: i32, e: u32),
    |counts| counts.draws += 1
);
command!(
    draw_indirect, "vkCmdDrawIndirect", vk::PFN_vkCmdDrawIndirect,
    (a: vk::Buffer, b: vk::DeviceSize, c: u32, d: u32), |counts| counts.draws += 1
);
command!(
    draw_indexed_indirect, "vkCmdDrawIndexedIndirect", vk::PFN_vkCmdDrawIndexedIndirect,
    (a: vk::Buffer, b: vk::DeviceSize, c: u32, d: u32), |counts| counts.draws += 1
);
command!(dispatch, "vkCmdDispatch", vk::PFN_vkCmdDispatch, (a: u32, b: u32, c: u32), |counts| counts.dispatches += 1);
command!(
    dispatch_indirect, "vkCmdDispatchIndirect", vk::PFN_vkCmdDispatchIndirect, (a: vk::Buffer, b: vk::DeviceSize),
    |counts| counts.dispatches += 1
);
command!(
    barrier, "vkCmdPipelineBarrier2", vk::PFN_vkCmdPipelineBarrier2, (a: *const vk::DependencyInfo<'static>), |_| {}
);

unsafe extern "system" fn begin_render_pass(
    commands: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'static>,
    contents: vk::SubpassContents,
) {
    let mut state = state();
    state.command(commands, |counts| counts.render_passes += 1);
    state.buffers.entry(ash::vk::Handle::as_raw(commands)).or_default().is_in_render_pass = true;
    drop(state);
    // SAFETY: as above.
    unsafe { next::<vk::PFN_vkCmdBeginRenderPass>("vkCmdBeginRenderPass")(commands, info, contents) };
}

unsafe extern "system" fn end_render_pass(commands: vk::CommandBuffer) {
    state().buffers.entry(ash::vk::Handle::as_raw(commands)).or_default().is_in_render_pass = false;
    // SAFETY: as above.
    unsafe { next::<vk::PFN_vkCmdEndRenderPass>("vkCmdEndRenderPass")(commands) };
}

/// Notes the stages of new pipelines.
fn made(pipelines: &[vk::Pipeline], of: impl Iterator<Item = (vk::ShaderStageFlags, vk::PipelineCreateFlags)>) {
    let kept =
        vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR | vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR;
    let mut state = state();
    for (pipeline, (stages, flags)) in pipelines.iter().zip(of) {
        state.pipelines.insert(ash::vk::Handle::as_raw(*pipeline), (stages, flags.contains(kept)));
    }
}

unsafe extern "system" fn create_graphics(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'static>,
    allocator: *const vk::AllocationCallbacks<'static>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    // SAFETY: as above.
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

unsafe extern "system" fn create_compute(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::ComputePipelineCreateInfo<'static>,
    allocator: *const vk::AllocationCallbacks<'static>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    // SAFETY: as above.
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

unsafe extern "system" fn executables(
    _device: vk::Device,
    info: *const vk::PipelineInfoKHR<'_>,
    count: *mut u32,
    found: *mut vk::PipelineExecutablePropertiesKHR<'_>,
) -> vk::Result {
    if let Some(failure) = calls::counted("vkGetPipelineExecutablePropertiesKHR") {
        return failure;
    }
    // SAFETY: as above.
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

unsafe extern "system" fn statistics(
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
    // SAFETY: as above.
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

unsafe extern "system" fn representations(
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
    // SAFETY: as above.
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
