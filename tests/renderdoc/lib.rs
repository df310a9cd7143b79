//! Stands for RenderDoc in the tests: its in-application interface, as far as it is called, which writes a file for each
//! capture. The tests load it before the program under RenderDoc's name. Where their Vulkan layer runs too, the file has the labels
//! that were begun while it captured.

#![allow(non_snake_case)]

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::Mutex;

use renderdoc_sys::{RENDERDOC_API_1_6_0, RENDERDOC_DevicePointer, RENDERDOC_Version, RENDERDOC_WindowHandle};

struct State {
    template: String,
    is_capturing: bool,
    labels: Vec<String>,
    files: Vec<CString>,
}

static STATE: Mutex<State> =
    Mutex::new(State { template: String::new(), is_capturing: false, labels: Vec::new(), files: Vec::new() });

unsafe extern "C" fn set_template(template: *const c_char) {
    // SAFETY: the interface promises a text that ends in a zero.
    STATE.lock().unwrap().template = unsafe { CStr::from_ptr(template) }.to_str().unwrap().to_owned();
}

unsafe extern "C" fn start(_: RENDERDOC_DevicePointer, _: RENDERDOC_WindowHandle) {
    STATE.lock().unwrap().is_capturing = true;
}

/// Called by the tests' layer for each label.
///
/// # Safety
/// `label` is a text that ends in a zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn test_renderdoc_label(label: *const c_char) {
    let mut state = STATE.lock().unwrap();
    if state.is_capturing {
        // SAFETY: the caller's promise.
        state.labels.push(unsafe { CStr::from_ptr(label) }.to_str().unwrap().to_owned());
    }
}

unsafe extern "C" fn end(_: RENDERDOC_DevicePointer, _: RENDERDOC_WindowHandle) -> u32 {
    let mut state = STATE.lock().unwrap();
    if !state.is_capturing || state.template.contains("refused") {
        return 0;
    }
    state.is_capturing = false;
    // As RenderDoc: without a template into the folder of temporary files.
    let template = match state.template.as_str() {
        "" => std::env::temp_dir().join("capture").display().to_string(),
        given => given.to_owned(),
    };
    let file = format!("{template}_frame{}.rdc", state.files.len());
    let labels = std::mem::take(&mut state.labels);
    std::fs::write(&file, labels.join("\n")).unwrap();
    state.files.push(CString::new(file).unwrap());
    1
}

unsafe extern "C" fn count() -> u32 {
    STATE.lock().unwrap().files.len() as u32
}

unsafe extern "C" fn get(index: u32, name: *mut c_char, bytes: *mut u32, _: *mut u64) -> u32 {
    let state = STATE.lock().unwrap();
    let Some(file) = state.files.get(index as usize) else { return 0 };
    let text = file.as_bytes_with_nul();
    // SAFETY: the interface promises room for the name where there is a pointer, and a length to write.
    unsafe {
        if !name.is_null() {
            ptr::copy_nonoverlapping(text.as_ptr().cast(), name, text.len());
        }
        bytes.write(text.len() as u32);
    }
    1
}

/// # Safety
/// `api` is a place for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn RENDERDOC_GetAPI(_: RENDERDOC_Version, api: *mut *mut c_void) -> c_int {
    // SAFETY: a table of absent functions is one of zeros.
    let mut table: RENDERDOC_API_1_6_0 = unsafe { MaybeUninit::zeroed().assume_init() };
    table.__bindgen_anon_2.SetCaptureFilePathTemplate = Some(set_template);
    table.StartFrameCapture = Some(start);
    table.EndFrameCapture = Some(end);
    table.GetNumCaptures = Some(count);
    table.GetCapture = Some(get);
    // SAFETY: the caller's promise; the table lives as long as the process.
    unsafe { api.write(Box::into_raw(Box::new(table)).cast()) };
    1
}
