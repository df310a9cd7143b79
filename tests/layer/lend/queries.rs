//! Counters of the device (`VK_KHR_performance_query`): what was recorded inside a query, replay by replay, and the rules of
//! queries and of the profiling lock. Ends of frames come with the submissions.

use std::collections::BTreeMap;
use std::env;
use std::ffi::c_void;

use ash::vk;
use vk::{
    PerformanceCounterScopeKHR as Scope, PerformanceCounterStorageKHR as Storage, PerformanceCounterUnitKHR as Unit,
};

use super::{Buffer, Counts, Pool, State, lends, list, next, state, write};
use crate::calls;
use crate::mask::change_in_chain;

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

pub unsafe extern "system" fn counters(
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
    // SAFETY: as in `extensions`.
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

pub unsafe extern "system" fn passes(
    _physical: vk::PhysicalDevice,
    info: *const vk::QueryPoolPerformanceCreateInfoKHR<'_>,
    count: *mut u32,
) {
    // SAFETY: as in `extensions`.
    unsafe { *count = replays(&indices(&*info)) };
}

pub unsafe extern "system" fn lock(
    _device: vk::Device,
    _info: *const vk::AcquireProfilingLockInfoKHR<'_>,
) -> vk::Result {
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

pub unsafe extern "system" fn unlock(_device: vk::Device) {
    let mut state = state();
    let is_held = state.is_locked;
    state.check(is_held, "the profiling lock is given back that nobody holds");
    state.is_locked = false;
}

pub unsafe extern "system" fn create_pool(
    device: vk::Device,
    info: *const vk::QueryPoolCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pool: *mut vk::QueryPool,
) -> vk::Result {
    // SAFETY: as in `extensions`.
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

pub unsafe extern "system" fn destroy_pool(
    device: vk::Device,
    pool: vk::QueryPool,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    if state().pools.remove(&ash::vk::Handle::as_raw(pool)).is_some() {
        calls::died("QueryPool");
        return;
    }
    // SAFETY: as in `extensions`.
    unsafe { next::<vk::PFN_vkDestroyQueryPool>("vkDestroyQueryPool")(device, pool, allocator.cast()) };
}

pub unsafe extern "system" fn reset_pool(device: vk::Device, pool: vk::QueryPool, first: u32, count: u32) {
    if let Some(pool) = state().pools.get_mut(&ash::vk::Handle::as_raw(pool)) {
        let queries = pool.queries.iter_mut().skip(first as usize).take(count as usize);
        queries.for_each(|query| *query = Some(BTreeMap::new()));
        return;
    }
    // SAFETY: as in `extensions`.
    unsafe { next::<vk::PFN_vkResetQueryPool>("vkResetQueryPool")(device, pool, first, count) };
}

pub unsafe extern "system" fn results(
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
        // SAFETY: as in `extensions`.
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

pub unsafe extern "system" fn begin_query(
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
        // SAFETY: as in `extensions`.
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

pub unsafe extern "system" fn end_query(commands: vk::CommandBuffer, pool: vk::QueryPool, query: u32) {
    let mut state = state();
    let handle = ash::vk::Handle::as_raw(pool);
    if !state.pools.contains_key(&handle) {
        state.command(commands, |_| {});
        drop(state);
        // SAFETY: as in `extensions`.
        return unsafe { next::<vk::PFN_vkCmdEndQuery>("vkCmdEndQuery")(commands, pool, query) };
    }
    let buffer = state.buffers.entry(ash::vk::Handle::as_raw(commands)).or_default();
    let is_open = buffer.open.take() == Some((handle, query));
    let is_outside = !buffer.is_in_render_pass;
    buffer.ended.push((handle, query, buffer.counts));
    state.check(is_open, "a query that ends and has not begun");
    state.check(is_outside, "a query that ends inside a render pass");
}

pub unsafe extern "system" fn begin_buffer(
    commands: vk::CommandBuffer,
    info: *const vk::CommandBufferBeginInfo<'_>,
) -> vk::Result {
    let mut state = state();
    let buffer = Buffer { is_locked: state.is_locked, ..Buffer::default() };
    state.buffers.insert(ash::vk::Handle::as_raw(commands), buffer);
    drop(state);
    // SAFETY: as in `extensions`.
    unsafe { next::<vk::PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer")(commands, info.cast()) }
}

pub unsafe extern "system" fn submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    use vk::StructureType as Type;
    // SAFETY: as in `extensions`.
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
        pub unsafe extern "system" fn $function(commands: vk::CommandBuffer, $($argument: $of),*) {
            state().command(commands, $count);
            // SAFETY: as in `extensions`.
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

pub unsafe extern "system" fn begin_render_pass(
    commands: vk::CommandBuffer,
    info: *const vk::RenderPassBeginInfo<'static>,
    contents: vk::SubpassContents,
) {
    let mut state = state();
    state.command(commands, |counts| counts.render_passes += 1);
    state.buffers.entry(ash::vk::Handle::as_raw(commands)).or_default().is_in_render_pass = true;
    drop(state);
    // SAFETY: as in `extensions`.
    unsafe { next::<vk::PFN_vkCmdBeginRenderPass>("vkCmdBeginRenderPass")(commands, info, contents) };
}

pub unsafe extern "system" fn end_render_pass(commands: vk::CommandBuffer) {
    state().buffers.entry(ash::vk::Handle::as_raw(commands)).or_default().is_in_render_pass = false;
    // SAFETY: as in `extensions`.
    unsafe { next::<vk::PFN_vkCmdEndRenderPass>("vkCmdEndRenderPass")(commands) };
}
