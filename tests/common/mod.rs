//! The harness of the tests that need a Vulkan device: one device for the process, under validation with
//! synchronization validation, and one test on it at a time.

use std::env;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use fumarole::gpu::live::Kind;
use fumarole::gpu::physical::choose;
use fumarole::gpu::{Device, Error, Instance, PhysicalDevice};

/// Index, UUID or part of the name of the device that the tests run on.
const DEVICE_VARIABLE: &str = "FUMAROLE_TEST_DEVICE";

/// lavapipe's name for its device: pictures, counters and limits do not depend on the machine then.
const DEFAULT_DEVICE: &str = "llvmpipe";

/// Runs `body` on the shared device, in turns with the other tests of the process.
///
/// # Panics
/// When no device can be opened (a test never passes for want of one), when the validation layer says anything, and
/// when `body` leaves a Vulkan object or memory alive.
pub fn gpu_test(body: impl FnOnce(&Arc<Device>)) {
    static TURN: Mutex<()> = Mutex::new(());
    static DEVICE: OnceLock<Result<Arc<Device>, Error>> = OnceLock::new();
    // A test that failed says so itself; the next one is not to fail with it.
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let device = match DEVICE.get_or_init(open_device) {
        Ok(device) => device,
        Err(error) => panic!("the tests need a Vulkan device ({DEVICE_VARIABLE} chooses another): {error}"),
    };
    let outcome = panic::catch_unwind(AssertUnwindSafe(|| body(device)));
    let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
    if let Err(failure) = outcome {
        eprintln!("{}", messages.join("\n"));
        panic::resume_unwind(failure);
    }
    assert!(messages.is_empty(), "{} validation message(s):\n{}", messages.len(), messages.join("\n"));
    assert_eq!(device.live().alive(), [(Kind::Instance, 1), (Kind::Device, 1)], "objects left alive");
    assert_eq!(device.live().memory(), [], "memory left allocated");
}

fn open_device() -> Result<Arc<Device>, Error> {
    let wanted = env::var(DEVICE_VARIABLE).unwrap_or_else(|_| DEFAULT_DEVICE.to_owned());
    let instance = Instance::new(true)?;
    let physical = choose(PhysicalDevice::enumerate(&instance)?, Some(&wanted), &[])?;
    Device::open(&instance, physical)
}
