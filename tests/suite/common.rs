//! The harness of the tests that need a Vulkan device: a device for every test that runs at the time, each under
//! validation with synchronization validation, and the machine alone for those that measure.

use std::env;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

use fumarole::gpu::live::Kind;
use fumarole::gpu::physical::choose;
use fumarole::gpu::{Device, Error, Instance, PhysicalDevice};

/// Index, UUID or part of the name of the device that the tests run on.
const DEVICE_VARIABLE: &str = "FUMAROLE_TEST_DEVICE";

/// lavapipe's name for its device: pictures, counters and limits do not depend on the machine then.
const DEFAULT_DEVICE: &str = "llvmpipe";

/// Held shared by whatever keeps the machine busy, and alone by what measures times.
static MACHINE: RwLock<()> = RwLock::new(());

/// Runs `work` beside others, but not beside a [`gpu_test_alone`].
pub fn beside_others<T>(work: impl FnOnce() -> T) -> T {
    // A test that failed says so itself; the next one is not to fail with it.
    let _shared = MACHINE.read().unwrap_or_else(PoisonError::into_inner);
    work()
}

/// Runs `body` on a device that no other test uses meanwhile.
///
/// # Panics
/// When no device can be opened (a test never passes for want of one), when the validation layer says anything, and
/// when `body` leaves a Vulkan object or memory alive.
pub fn gpu_test(body: impl FnOnce(&Arc<Device>)) {
    beside_others(|| on_idle_device(body));
}

/// As [`gpu_test`], while no other test keeps the machine busy: for times.
pub fn gpu_test_alone(body: impl FnOnce(&Arc<Device>)) {
    let _alone = MACHINE.write().unwrap_or_else(PoisonError::into_inner);
    on_idle_device(body);
}

fn on_idle_device(body: impl FnOnce(&Arc<Device>)) {
    static IDLE: Mutex<Vec<Arc<Device>>> = Mutex::new(Vec::new());
    let idle = || IDLE.lock().unwrap_or_else(PoisonError::into_inner);
    let taken = idle().pop();
    let device = &taken.unwrap_or_else(|| match open_device() {
        Ok(device) => device,
        Err(error) => panic!("the tests need a Vulkan device ({DEVICE_VARIABLE} chooses another): {error}"),
    });
    let outcome = panic::catch_unwind(AssertUnwindSafe(|| body(device)));
    let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
    if let Err(failure) = outcome {
        eprintln!("{}", messages.join("\n"));
        panic::resume_unwind(failure);
    }
    assert!(messages.is_empty(), "{} validation message(s):\n{}", messages.len(), messages.join("\n"));
    assert_eq!(device.live().alive(), [(Kind::Instance, 1), (Kind::Device, 1)], "objects left alive");
    assert_eq!(device.live().memory(), [], "memory left allocated");
    idle().push(device.clone());
}

/// The device that the tests run on, as [`choose`] takes it.
pub fn wanted_device() -> String {
    env::var(DEVICE_VARIABLE).unwrap_or_else(|_| DEFAULT_DEVICE.to_owned())
}

fn open_device() -> Result<Arc<Device>, Error> {
    let instance = Instance::new(true)?;
    let physical = choose(PhysicalDevice::enumerate(&instance)?, Some(&wanted_device()), &[])?;
    Device::open(&instance, physical)
}
