//! Captures of frames by RenderDoc, through its in-application interface, where it was loaded into this process.

use std::ffi::c_void;
use std::path::{Path, PathBuf};
use std::ptr;

use renderdoc_sys::{RENDERDOC_API_1_6_0, eRENDERDOC_API_Version_1_1_2, pRENDERDOC_GetAPI};

use super::device::c_text;
use super::error::Error;

#[cfg(unix)]
const LIBRARY: &str = "librenderdoc.so";
#[cfg(windows)]
const LIBRARY: &str = "renderdoc.dll";

/// RenderDoc in this process.
pub struct RenderDoc {
    api: *const RENDERDOC_API_1_6_0,
    /// Keeps it loaded.
    _library: Library,
}

#[cfg(unix)]
type Library = libloading::os::unix::Library;
#[cfg(windows)]
type Library = libloading::os::windows::Library;

impl RenderDoc {
    /// The interface of the RenderDoc that this process runs under. It must be loaded before Vulkan is, so that it is never
    /// loaded here.
    ///
    /// # Errors
    /// [`Error::Capture`] where it is not there.
    pub fn attach() -> Result<Self, Error> {
        let absent = |reason: &str| Error::Capture { reason: reason.to_owned() };
        let library = loaded().ok_or_else(|| absent("RenderDoc is not loaded into this process"))?;
        // SAFETY: the symbol is RenderDoc's documented entry, of this type in every version.
        let entry = unsafe { library.get::<pRENDERDOC_GetAPI>(b"RENDERDOC_GetAPI\0") };
        let entry = entry.ok().and_then(|entry| *entry).ok_or_else(|| absent("the library has no RENDERDOC_GetAPI"))?;
        let mut api: *mut c_void = ptr::null_mut();
        // SAFETY: the pointer is written by the call, and only where it returns 1.
        let answer = unsafe { entry(eRENDERDOC_API_Version_1_1_2, &mut api) };
        if answer != 1 || api.is_null() {
            return Err(absent("it does not offer version 1.1.2 of its interface"));
        }
        // Of later versions, whose tables begin like this one's, nothing beyond 1.1.2 is called.
        Ok(RenderDoc { api: api.cast_const().cast(), _library: library })
    }

    /// Captures what `work` submits and returns the file that it lies in, whose name begins with `path`, or is of
    /// RenderDoc's own making without one.
    ///
    /// # Errors
    /// The error of `work`; [`Error::Capture`] where RenderDoc captured nothing.
    pub fn capture<E: From<Error>>(
        &self,
        path: Option<&Path>,
        work: impl FnOnce() -> Result<(), E>,
    ) -> Result<PathBuf, E> {
        let failed = |reason: &str| Error::Capture { reason: reason.to_owned() };
        // SAFETY: RenderDoc keeps the table for the life of the process; functions of 1.1.2 alone are taken, and the union's
        // members are two names of one function.
        let (template, start, end) = unsafe {
            let api = &*self.api;
            (api.__bindgen_anon_2.SetCaptureFilePathTemplate, api.StartFrameCapture, api.EndFrameCapture)
        };
        let (Some(template), Some(start), Some(end)) = (template, start, end) else {
            return Err(failed("its table of functions has gaps").into());
        };
        let text = path.map(|path| c_text(&path.to_string_lossy()));
        // SAFETY: the text ends in a zero and is copied; no device and no window are named, which means the one that is there.
        unsafe {
            if let Some(text) = &text {
                template(text.as_ptr());
            }
            start(ptr::null_mut(), ptr::null_mut());
        }
        let result = work();
        // SAFETY: as above, after the start.
        let is_captured = unsafe { end(ptr::null_mut(), ptr::null_mut()) } == 1;
        result?;
        let file = self.last_capture();
        match (is_captured, file) {
            (true, Some(file)) => Ok(file),
            _ => Err(failed("it captured nothing; see its log").into()),
        }
    }

    fn last_capture(&self) -> Option<PathBuf> {
        // SAFETY: as in `capture`.
        let (count, get) = unsafe { ((*self.api).GetNumCaptures?, (*self.api).GetCapture?) };
        // SAFETY: no precondition.
        let last = unsafe { count() }.checked_sub(1)?;
        let mut bytes = 0;
        // SAFETY: the length alone is asked for, then the name of that capacity.
        let name = unsafe {
            get(last, ptr::null_mut(), &mut bytes, ptr::null_mut());
            let mut name = vec![0u8; bytes as usize + 1];
            let mut capacity = bytes + 1;
            (get(last, name.as_mut_ptr().cast(), &mut capacity, ptr::null_mut()) == 1).then_some(name)?
        };
        let end = name.iter().position(|&byte| byte == 0)?;
        Some(PathBuf::from(String::from_utf8_lossy(&name[..end]).into_owned()))
    }
}

#[cfg(unix)]
fn loaded() -> Option<Library> {
    const NOW: i32 = 2;
    /// `RTLD_NOLOAD` of the system's `dlfcn.h`.
    const NO_LOAD: i32 = if cfg!(target_os = "macos") { 0x10 } else { 4 };
    // SAFETY: nothing is loaded that is not loaded already, so that no initialiser runs.
    unsafe { Library::open(Some(LIBRARY), NOW | NO_LOAD) }.ok()
}

#[cfg(windows)]
fn loaded() -> Option<Library> {
    Library::open_already_loaded(LIBRARY).ok()
}
