//! The surface of a window, and what an instance and a device need to present to it. Nothing of this is asked for
//! without a window.

use std::ffi::{CStr, c_void};
use std::num::NonZeroU32;
use std::ptr::NonNull;
use std::sync::{Arc, Mutex, MutexGuard};

use ash::{ext, khr, vk};
use raw_window_handle::{
    HasDisplayHandle, HasWindowHandle, RawDisplayHandle, RawWindowHandle, XcbDisplayHandle, XcbWindowHandle,
};

use super::error::{Context, Error};
use super::instance::Instance;
use super::live::Kind;
use super::physical::PhysicalDevice;

/// Extensions of an instance by which a device may have present fences.
pub(super) const OPTIONAL_EXTENSIONS: [&CStr; 2] =
    [khr::get_surface_capabilities2::NAME, ext::surface_maintenance1::NAME];

/// The kind of display that windows are on, with the extensions that its surfaces need.
pub struct Display {
    required: Vec<&'static CStr>,
}

impl Display {
    /// # Errors
    /// [`Error::NoInstance`] for a display that has gone, or of a kind that Vulkan has no surfaces for.
    pub fn of(display: &impl HasDisplayHandle) -> Result<Self, Error> {
        let handle = display_handle(display)?;
        let names = ash_window::enumerate_required_extensions(handle)
            .map_err(|result| Error::NoInstance { reason: format!("asking what windows need: {result}") })?;
        // SAFETY: the names are those of `ash`, which are static and end with a zero.
        let required = names.iter().map(|&name| unsafe { CStr::from_ptr(name) }).collect();
        Ok(Display { required })
    }

    pub(super) fn required(&self) -> &[&'static CStr] {
        &self.required
    }
}

/// The display as every driver knows it: one of Xlib by its connection of XCB, since some have surfaces of XCB alone.
fn display_handle(display: &impl HasDisplayHandle) -> Result<RawDisplayHandle, Error> {
    let gone = |error| Error::NoInstance { reason: format!("asking for the display: {error}") };
    let handle = display.display_handle().map_err(gone)?.as_raw();
    let RawDisplayHandle::Xlib(xlib) = handle else { return Ok(handle) };
    // SAFETY: the display is open: the handle was asked for just now.
    let connection = xlib.display.and_then(|display| unsafe { xcb_connection(display) });
    Ok(connection.map_or(handle, |connection| XcbDisplayHandle::new(Some(connection), xlib.screen).into()))
}

/// The connection behind a display of Xlib; `None` without the library that tells.
///
/// # Safety
/// `display` is an open `Display` of Xlib.
unsafe fn xcb_connection(display: NonNull<c_void>) -> Option<NonNull<c_void>> {
    // SAFETY: a system library without initialisers of its own. What it returns belongs to the libraries of the display,
    // which are loaded as long as it is open.
    let library = unsafe { libloading::Library::new("libX11-xcb.so.1") }.ok()?;
    type ConnectionOf = unsafe extern "C" fn(*mut c_void) -> *mut c_void;
    // SAFETY: its type in X11/Xlib-xcb.h.
    let connection_of = unsafe { library.get::<ConnectionOf>(b"XGetXCBConnection\0") }.ok()?;
    // SAFETY: the display is open, as the caller promises.
    NonNull::new(unsafe { connection_of(display.as_ptr()) })
}

/// The window beside a display of [`display_handle`].
fn window_handle(window: &impl HasWindowHandle, display: RawDisplayHandle) -> Result<RawWindowHandle, Error> {
    let gone = |error| Error::NoInstance { reason: format!("asking for the window: {error}") };
    let handle = window.window_handle().map_err(gone)?.as_raw();
    let (RawWindowHandle::Xlib(xlib), RawDisplayHandle::Xcb(_)) = (handle, display) else { return Ok(handle) };
    let id = u32::try_from(xlib.window).ok().and_then(NonZeroU32::new);
    Ok(id.map_or(handle, |id| XcbWindowHandle::new(id).into()))
}

/// The calls of swapchains on an open device.
pub(super) struct Presenting {
    /// Entry points of `VK_KHR_swapchain`.
    pub swapchains: khr::swapchain::Device,
    /// A present can signal a fence when it has let go of its semaphore (`VK_EXT_swapchain_maintenance1`).
    pub has_fences: bool,
}

impl Presenting {
    pub fn new(instance: &Instance, device: &ash::Device, has_fences: bool) -> Self {
        Presenting { swapchains: khr::swapchain::Device::new(&instance.raw, device), has_fences }
    }
}

/// A window as Vulkan draws to it.
pub struct Surface {
    /// Handle.
    pub(super) raw: vk::SurfaceKHR,
    /// Calls about surfaces of the instance.
    pub(super) calls: khr::surface::Instance,
    instance: Arc<Instance>,
    /// The swapchain that has it, null without one.
    swapchain: Mutex<vk::SwapchainKHR>,
    // The window outlives its surface.
    _window: Arc<dyn Send + Sync>,
}

impl Surface {
    /// The surface of `window`, which it keeps alive.
    ///
    /// # Errors
    /// Any error of Vulkan; [`Error::NoInstance`] for a window that has gone.
    pub fn new<W>(instance: &Arc<Instance>, window: &Arc<W>) -> Result<Arc<Self>, Error>
    where
        W: HasDisplayHandle + HasWindowHandle + Send + Sync + 'static,
    {
        let display = display_handle(window)?;
        let handle = window_handle(window.as_ref(), display)?;
        let required = ash_window::enumerate_required_extensions(display).unwrap_or_default();
        // SAFETY: the names are those of `ash`, which are static and end with a zero.
        let mut required = required.iter().map(|&name| unsafe { CStr::from_ptr(name) }.to_string_lossy());
        if required.any(|name| !instance.extensions().iter().any(|enabled| *enabled == name)) {
            return Err(Error::NoInstance { reason: "the instance was not made for this kind of display".into() });
        }
        // SAFETY: the instance has the extensions of this display, by the check above; the handles are those of a window
        // that the surface keeps alive.
        let raw = unsafe { ash_window::create_surface(&instance.entry, &instance.raw, display, handle, None) }
            .context("creating the surface of", "the window")?;
        instance.live().add(Kind::Surface);
        let calls = khr::surface::Instance::new(&instance.entry, &instance.raw);
        let swapchain = Mutex::new(vk::SwapchainKHR::null());
        Ok(Arc::new(Surface { raw, calls, instance: instance.clone(), swapchain, _window: window.clone() }))
    }

    /// The instance that it is a part of.
    pub fn instance(&self) -> &Arc<Instance> {
        &self.instance
    }

    /// Its swapchain, for one thread at a time: calls that make swapchains want the surface for themselves, even from those
    /// that ask about it.
    pub(super) fn lock(&self) -> MutexGuard<'_, vk::SwapchainKHR> {
        self.swapchain.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// The devices that can present to it.
    ///
    /// # Errors
    /// Any error of Vulkan.
    pub fn devices(&self) -> Result<Vec<PhysicalDevice>, Error> {
        let mut able = Vec::new();
        let _alone = self.lock();
        for physical in PhysicalDevice::enumerate(&self.instance)? {
            let Some((family, _)) = physical.queue else { continue };
            if !physical.offers(&self.instance, khr::swapchain::NAME) {
                continue;
            }
            // SAFETY: surface and device belong to the same living instance, and the family is one of the device's.
            let presents = unsafe { self.calls.get_physical_device_surface_support(physical.raw, family, self.raw) }
                .before_a_device("asking about the surface of", "the window")?;
            if presents {
                able.push(physical);
            }
        }
        Ok(able)
    }
}

impl Drop for Surface {
    fn drop(&mut self) {
        // SAFETY: swapchains hold an `Arc` of their surface, so none is left.
        unsafe { self.calls.destroy_surface(self.raw, None) };
        self.instance.live().remove(Kind::Surface);
    }
}
