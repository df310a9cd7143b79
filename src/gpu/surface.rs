//! The surface of a window, and what an instance and a device need to present to it. Nothing of this is asked for
//! without a window.

use std::ffi::CStr;
use std::sync::Arc;

use ash::{ext, khr, vk};
use raw_window_handle::{HasDisplayHandle, HasWindowHandle, RawDisplayHandle};

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

fn display_handle(display: &impl HasDisplayHandle) -> Result<RawDisplayHandle, Error> {
    let handle = display.display_handle();
    Ok(handle.map_err(|error| Error::NoInstance { reason: format!("asking for the display: {error}") })?.as_raw())
}

/// The calls of swapchains on an open device.
pub(super) struct Presenting {
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
    pub(super) raw: vk::SurfaceKHR,
    pub(super) calls: khr::surface::Instance,
    instance: Arc<Instance>,
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
        let gone = |error| Error::NoInstance { reason: format!("asking for the window: {error}") };
        let handle = window.window_handle().map_err(gone)?.as_raw();
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
        Ok(Arc::new(Surface { raw, calls, instance: instance.clone(), _window: window.clone() }))
    }

    /// The instance that it is a part of.
    pub fn instance(&self) -> &Arc<Instance> {
        &self.instance
    }

    /// The devices that can present to it.
    ///
    /// # Errors
    /// Any error of Vulkan.
    pub fn devices(&self) -> Result<Vec<PhysicalDevice>, Error> {
        let mut able = Vec::new();
        for physical in PhysicalDevice::enumerate(&self.instance)? {
            let Some((family, _)) = physical.queue else { continue };
            if !physical.offers(&self.instance, khr::swapchain::NAME) {
                continue;
            }
            // SAFETY: surface and device belong to the same living instance, and the family is one of the device's.
            let presents = unsafe { self.calls.get_physical_device_surface_support(physical.raw, family, self.raw) };
            if presents == Ok(true) {
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
