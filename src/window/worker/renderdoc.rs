//! Captures by RenderDoc, where its library is in the process: by its in-application API, version 1.1.2, as
//! `renderdoc_app.h` declares it.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr::{self, NonNull};

use crate::measure::Error;

/// Version 1.1.2, which later libraries keep.
const VERSION: c_int = 10_102;

type Other = unsafe extern "C" fn();

/// The functions of the API in their order.
#[repr(C)]
struct Api {
    _before: [Option<Other>; 13],
    get_num_captures: Option<unsafe extern "C" fn() -> u32>,
    get_capture: Option<unsafe extern "C" fn(u32, *mut c_char, *mut u32, *mut u64) -> u32>,
    _between: [Option<Other>; 4],
    start_frame_capture: Option<unsafe extern "C" fn(*mut c_void, *mut c_void)>,
    _is_frame_capturing: Option<Other>,
    end_frame_capture: Option<unsafe extern "C" fn(*mut c_void, *mut c_void) -> u32>,
}

/// RenderDoc in this process.
pub struct RenderDoc {
    api: NonNull<Api>,
}

impl RenderDoc {
    /// Finds the library, without loading it.
    #[cfg(unix)]
    pub fn find() -> Option<Self> {
        type GetApi = unsafe extern "C" fn(c_int, *mut *mut c_void) -> c_int;
        // SAFETY: both names end in a zero. The library is not loaded here: whoever has loaded it keeps it, and the handle is
        // not closed, so that the symbol stays.
        let symbol = unsafe {
            let library = libc::dlopen(c"librenderdoc.so".as_ptr(), libc::RTLD_NOW | libc::RTLD_NOLOAD);
            if library.is_null() {
                return None;
            }
            libc::dlsym(library, c"RENDERDOC_GetAPI".as_ptr())
        };
        let mut api = ptr::null_mut();
        // SAFETY: a symbol of that name in that library has that type, and writes one pointer; it is not null.
        let is_there = unsafe {
            let get_api: Option<GetApi> = std::mem::transmute::<*mut c_void, Option<GetApi>>(symbol);
            get_api.is_some_and(|get_api| get_api(VERSION, &raw mut api) == 1)
        };
        NonNull::new(api.cast()).filter(|_| is_there).map(|api| RenderDoc { api })
    }

    /// Finds nothing: the API is loaded in other ways on other systems.
    #[cfg(not(unix))]
    pub fn find() -> Option<Self> {
        None
    }

    /// Captures what `draw` submits, and gives the file.
    ///
    /// # Errors
    /// Of `draw`; of a capture that failed.
    pub fn capture(&self, draw: impl FnOnce() -> Result<(), Error>) -> Result<String, Error> {
        let failed = || Error::Input("capturing a frame: RenderDoc gave no capture; its log tells why".to_owned());
        // SAFETY: the library has handed out the functions of its version 1.1.2, of which this is the beginning, and lives
        // as long as the process.
        let api = unsafe { self.api.as_ref() };
        let (Some(start), Some(end), Some(count), Some(get)) =
            (api.start_frame_capture, api.end_frame_capture, api.get_num_captures, api.get_capture)
        else {
            return Err(failed());
        };
        // SAFETY: null for both means any device and any window.
        unsafe { start(ptr::null_mut(), ptr::null_mut()) };
        let drawn = draw();
        // SAFETY: as above.
        let is_captured = unsafe { end(ptr::null_mut(), ptr::null_mut()) } == 1;
        drawn?;
        if !is_captured {
            return Err(failed());
        }
        let mut bytes = 0;
        // SAFETY: without a buffer it writes the length, zero included, and no name.
        let last = unsafe {
            let last = count().saturating_sub(1);
            get(last, ptr::null_mut(), &raw mut bytes, ptr::null_mut());
            last
        };
        let mut name = vec![0u8; bytes as usize + 1];
        // SAFETY: the buffer holds the length that it gave, and the zero behind it ends the text in any case.
        let is_named = unsafe { get(last, name.as_mut_ptr().cast(), &raw mut bytes, ptr::null_mut()) } == 1;
        let name = CStr::from_bytes_until_nul(&name).ok().filter(|_| is_named);
        name.map(|name| name.to_string_lossy().into_owned()).ok_or_else(failed)
    }
}
