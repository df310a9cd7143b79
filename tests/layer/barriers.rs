//! Barriers that wait for nothing: what a validation layer below this one must find.

use std::env;
use std::ffi::{CStr, c_void};
use std::mem::transmute;
use std::slice;
use std::sync::atomic::{AtomicUsize, Ordering};

use ash::vk;

static NEXT: AtomicUsize = AtomicUsize::new(0);

/// Finds the next function.
pub fn resolve(next: &dyn Fn(&CStr) -> vk::PFN_vkVoidFunction) {
    if let Some(found) = next(c"vkCmdPipelineBarrier2") {
        NEXT.store(found as usize, Ordering::Release);
    }
}

/// The barrier without what it waits for, where the tests ask for it.
pub fn hook(name: &str) -> Option<*const c_void> {
    let drops = name == "vkCmdPipelineBarrier2" && env::var_os("FUMAROLE_LAYER_DROPS_BARRIERS").is_some();
    drops.then_some(barrier as *const c_void)
}

/// A change of layout that waits for nothing; none of a barrier that changes none.
fn without_waits<'a>(barrier: &vk::ImageMemoryBarrier2<'a>) -> Option<vk::ImageMemoryBarrier2<'a>> {
    let none = vk::ImageMemoryBarrier2 {
        src_stage_mask: vk::PipelineStageFlags2::NONE,
        src_access_mask: vk::AccessFlags2::NONE,
        dst_stage_mask: vk::PipelineStageFlags2::NONE,
        dst_access_mask: vk::AccessFlags2::NONE,
        ..*barrier
    };
    (barrier.old_layout != barrier.new_layout).then_some(none)
}

unsafe extern "system" fn barrier(commands: vk::CommandBuffer, info: *const vk::DependencyInfo<'_>) {
    // SAFETY: the caller's structure and its lists live for the call.
    let images = unsafe {
        let info = &*info;
        let count = info.image_memory_barrier_count as usize;
        if count == 0 { &[] } else { slice::from_raw_parts(info.p_image_memory_barriers, count) }
    };
    let images: Vec<_> = images.iter().filter_map(without_waits).collect();
    let next = NEXT.load(Ordering::Acquire);
    if next == 0 || images.is_empty() {
        return;
    }
    // SAFETY: the address is the next command's, which lives as long as the device.
    unsafe {
        let next = transmute::<usize, vk::PFN_vkCmdPipelineBarrier2>(next);
        next(commands, &vk::DependencyInfo::default().image_memory_barriers(&images));
    }
}
