//! Labels round the commands of passes, and names of pipelines, as a debugger would show them.

use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_void};
use std::fmt::Write;
use std::mem::transmute;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{LazyLock, Mutex, MutexGuard};

use ash::vk;
use libloading::os::unix::Library;

use crate::calls;

const NAMES: [&str; 3] = ["vkCmdBeginDebugUtilsLabelEXT", "vkCmdEndDebugUtilsLabelEXT", "vkSetDebugUtilsObjectNameEXT"];
static NEXT: [AtomicUsize; NAMES.len()] = [const { AtomicUsize::new(0) }; NAMES.len()];

struct Seen {
    /// In the order of their first use.
    labels: Vec<String>,
    pipelines: Vec<String>,
    /// Labels that are open in each command buffer.
    open: BTreeMap<vk::CommandBuffer, u32>,
    is_unpaired: bool,
}

static SEEN: Mutex<Seen> =
    Mutex::new(Seen { labels: Vec::new(), pipelines: Vec::new(), open: BTreeMap::new(), is_unpaired: false });

/// The library that stands for RenderDoc, where it was loaded before the program.
static RENDERDOC: LazyLock<Option<unsafe extern "C" fn(*const c_char)>> = LazyLock::new(|| {
    // SAFETY: the address of a function of that type, in a library that is never unloaded.
    unsafe { Library::this().get(b"test_renderdoc_label\0").ok().map(|found| *found) }
});

fn seen() -> MutexGuard<'static, Seen> {
    SEEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

fn note(list: &mut Vec<String>, text: *const c_char) {
    // SAFETY: a name ends in a zero.
    let text = unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned();
    if !list.contains(&text) {
        list.push(text);
    }
}

/// Finds the next functions of all that is hooked.
pub fn resolve(next: &dyn Fn(&CStr) -> vk::PFN_vkVoidFunction) {
    for (name, slot) in NAMES.iter().zip(&NEXT) {
        let below = || CString::new(*name).ok().and_then(|name| next(&name)).map(|found| found as usize);
        if let Some(found) = calls::hook(name).map(|hook| hook as usize).or_else(below) {
            slot.store(found, Ordering::Release);
        }
    }
}

/// The hook before a command, if it has one.
pub fn hook(name: &str) -> Option<*const c_void> {
    match name {
        "vkCmdBeginDebugUtilsLabelEXT" => Some(begin as *const c_void),
        "vkCmdEndDebugUtilsLabelEXT" => Some(end as *const c_void),
        "vkSetDebugUtilsObjectNameEXT" => Some(name_object as *const c_void),
        _ => None,
    }
}

/// Lines of the report.
pub fn report() -> String {
    let seen = seen();
    let mut text = String::new();
    for (kind, names) in [("label", &seen.labels), ("pipeline", &seen.pipelines)] {
        for name in names {
            let _infallible = writeln!(text, "{kind} {name}");
        }
    }
    if seen.is_unpaired || seen.open.values().any(|&open| open != 0) {
        text.push_str("misuse labels do not pair\n");
    }
    text
}

unsafe extern "system" fn begin(buffer: vk::CommandBuffer, label: *const vk::DebugUtilsLabelEXT<'_>) {
    {
        let mut seen = seen();
        *seen.open.entry(buffer).or_default() += 1;
        // SAFETY: the caller's structure lives for the call.
        note(&mut seen.labels, unsafe { (*label).p_label_name });
    }
    if let Some(tell) = *RENDERDOC {
        // SAFETY: the stand-in's function of this name, and the caller's text.
        unsafe { tell((*label).p_label_name) };
    }
    let next = NEXT[0].load(Ordering::Acquire);
    // SAFETY: here and below, the address is that of the command of this name, the arguments are the caller's.
    unsafe { transmute::<usize, vk::PFN_vkCmdBeginDebugUtilsLabelEXT>(next)(buffer, label) };
}

unsafe extern "system" fn end(buffer: vk::CommandBuffer) {
    {
        let mut seen = seen();
        match seen.open.get_mut(&buffer).and_then(|open| open.checked_sub(1).map(|less| *open = less)) {
            Some(()) => {}
            None => seen.is_unpaired = true,
        }
    }
    // SAFETY: see above.
    unsafe { transmute::<usize, vk::PFN_vkCmdEndDebugUtilsLabelEXT>(NEXT[1].load(Ordering::Acquire))(buffer) };
}

unsafe extern "system" fn name_object(
    device: vk::Device,
    info: *const vk::DebugUtilsObjectNameInfoEXT<'_>,
) -> vk::Result {
    // SAFETY: the caller's structure lives for the call.
    let (kind, text) = unsafe { ((*info).object_type, (*info).p_object_name) };
    if kind == vk::ObjectType::PIPELINE && !text.is_null() {
        note(&mut seen().pipelines, text);
    }
    // SAFETY: see above.
    unsafe { transmute::<usize, vk::PFN_vkSetDebugUtilsObjectNameEXT>(NEXT[2].load(Ordering::Acquire))(device, info) }
}
