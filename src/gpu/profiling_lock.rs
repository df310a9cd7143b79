//! The lock that performance queries are recorded under (`VK_KHR_performance_query`). A device has it once.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use ash::{khr, vk};

use super::device::Device;
use super::error::Error;

/// Wait for the lock, which another process may hold, in nanoseconds.
const LOCK_TIMEOUT_NS: u64 = 1_000_000_000;

/// The device's profiling lock, held until this is dropped.
pub(super) struct ProfilingLock {
    calls: khr::performance_query::Device,
    device: Arc<Device>,
}

impl ProfilingLock {
    /// Takes it of a device that was opened with the extension, as the caller has asked.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where another recorder or process holds it; any error of Vulkan.
    pub fn take(device: &Arc<Device>) -> Result<Self, Error> {
        let unsupported = |problem: &str| Error::Unsupported {
            object: "performance counters".to_owned(),
            problem: format!("the profiling lock, which {problem}"),
        };
        // Whoever gave it back first would take it from the other.
        if device.is_profiling.swap(true, Ordering::Acquire) {
            return Err(unsupported("another recorder holds"));
        }
        let calls = khr::performance_query::Device::new(&device.instance().raw, &device.raw);
        let info = vk::AcquireProfilingLockInfoKHR::default().timeout(LOCK_TIMEOUT_NS);
        // SAFETY: the device was opened with the extension, as the caller has asked.
        let taken = unsafe { calls.acquire_profiling_lock(&info) };
        if taken.is_err() {
            device.is_profiling.store(false, Ordering::Release);
        }
        match taken {
            Ok(()) => Ok(ProfilingLock { calls, device: device.clone() }),
            Err(vk::Result::TIMEOUT) => Err(unsupported("another process holds or is not to be had without rights")),
            Err(other) => Err(Error::vulkan("taking", "the profiling lock", other)),
        }
    }
}

impl Drop for ProfilingLock {
    fn drop(&mut self) {
        // SAFETY: it is held, by its taking; `Counting` drops it when nothing is in flight that was recorded under it.
        unsafe { self.calls.release_profiling_lock() };
        self.device.is_profiling.store(false, Ordering::Release);
    }
}
