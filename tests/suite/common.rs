//! The harness of the tests that need a Vulkan device: a device for every test that runs at the time, each under
//! validation with synchronization validation, and the machine alone for those that measure.

use std::cell::Cell;
use std::num::NonZero;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, Condvar, Mutex, PoisonError, RwLock};
use std::{env, iter, mem, thread};

use fumarole::gpu::live::Kind;
use fumarole::gpu::physical::choose;
use fumarole::gpu::{Compiler, Device, Error, Instance, PhysicalDevice, ShaderLibrary};

/// Index, UUID or part of the name of the device that the tests run on.
const DEVICE_VARIABLE: &str = "FUMAROLE_TEST_DEVICE";

/// lavapipe's name for its device: pictures, counters and limits do not depend on the machine then.
const DEFAULT_DEVICE: &str = "llvmpipe";

/// Held shared by whatever keeps the machine busy, and alone by what measures times.
static MACHINE: RwLock<()> = RwLock::new(());

thread_local! {
    /// True while this thread holds [`MACHINE`]: a lock that is taken again waits for whoever waits for the first.
    static HOLDS: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work` beside others, but not beside a [`gpu_test_alone`].
pub fn beside_others<T>(work: impl FnOnce() -> T) -> T {
    if HOLDS.get() {
        return work();
    }
    // A test that failed says so itself; the next one is not to fail with it.
    let _shared = MACHINE.read().unwrap_or_else(PoisonError::into_inner);
    HOLDS.set(true);
    let done = work();
    HOLDS.set(false);
    done
}

/// Runs `body` on a device that no other test uses meanwhile. A body that makes an instance or a device of its own under
/// validation takes [`gpu_test_alone`]: the layer (1.3.239) looks its devices up in a table without a lock, so that one
/// that is made or dropped takes the ground from under the calls of all others.
///
/// # Panics
/// When no device can be opened (a test never passes for want of one), when the validation layer says anything, and
/// when `body` leaves a Vulkan object or memory alive.
pub fn gpu_test(body: impl FnOnce(&Arc<Device>)) {
    beside_others(|| on_idle_device(body));
}

/// As [`gpu_test`], while no other test keeps the machine busy: for times, and for instances and devices of a test's own.
pub fn gpu_test_alone(body: impl FnOnce(&Arc<Device>)) {
    let _alone = MACHINE.write().unwrap_or_else(PoisonError::into_inner);
    HOLDS.set(true);
    on_idle_device(body);
    HOLDS.set(false);
}

fn on_idle_device(body: impl FnOnce(&Arc<Device>)) {
    let lent = Lent::take();
    let device = &lent.0;
    let outcome = panic::catch_unwind(AssertUnwindSafe(|| body(device)));
    forget_most(device);
    let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
    if let Err(failure) = outcome {
        eprintln!("{}", messages.join("\n"));
        panic::resume_unwind(failure);
    }
    assert!(messages.is_empty(), "{} validation message(s):\n{}", messages.len(), messages.join("\n"));
    assert_nothing_left(device);
    assert_eq!(device.live().memory(), [], "memory left allocated");
}

/// The built-in shaders of the pool's devices, with the pipelines that tests have made: the next test compiles none of them
/// again.
static LIBRARIES: Mutex<Vec<(Compiler, Arc<ShaderLibrary>)>> = Mutex::new(Vec::new());

/// Most objects of a kind that a library keeps from one test to the next.
const MOST_KEPT: usize = 300;

/// The built-in shaders as a compiler made them.
pub fn shaders_by(device: &Arc<Device>, compiler: Compiler) -> Arc<ShaderLibrary> {
    let libraries = LIBRARIES.lock().unwrap_or_else(PoisonError::into_inner);
    let is_it =
        |(by, library): &&(Compiler, Arc<ShaderLibrary>)| *by == compiler && Arc::ptr_eq(library.device(), device);
    match libraries.iter().find(is_it) {
        Some((_, library)) => library.clone(),
        // A device of the test's own.
        None => new_library(device, compiler),
    }
}

fn new_library(device: &Arc<Device>, compiler: Compiler) -> Arc<ShaderLibrary> {
    Arc::new(ShaderLibrary::new(device, compiler, None).expect("no folder is compiled"))
}

/// # Panics
/// When more is alive than the device and what its libraries keep, or a pass still holds some of that.
fn assert_nothing_left(device: &Arc<Device>) {
    let libraries = [Compiler::Glslang, Compiler::Naga].map(|compiler| shaders_by(device, compiler));
    let kept: Vec<_> = libraries.iter().flat_map(|library| library.kept()).collect();
    for kind in Kind::ALL {
        let own = usize::from(matches!(kind, Kind::Instance | Kind::Device));
        let expected = own + kept.iter().filter(|(of, _)| *of == kind).map(|(_, count)| count).sum::<usize>();
        assert_eq!(device.live().count(kind), expected, "objects left alive: {kind:?}");
    }
    assert!(!libraries.iter().any(|library| library.is_in_use()), "a pass is left alive");
}

/// Libraries that keep too much keep nothing.
fn forget_most(device: &Arc<Device>) {
    for compiler in [Compiler::Glslang, Compiler::Naga] {
        let library = shaders_by(device, compiler);
        if library.kept().iter().any(|(_, count)| *count > MOST_KEPT) {
            library.forget_pipelines();
        }
    }
}

/// The devices of the tests, opened together before the first of them works.
struct Pool {
    idle: Vec<Arc<Device>>,
    lent: usize,
}

static POOL: Mutex<Pool> = Mutex::new(Pool { idle: Vec::new(), lent: 0 });
static RETURNED: Condvar = Condvar::new();

/// A device of the pool; it goes back, unless its test failed.
struct Lent(Arc<Device>);

impl Lent {
    /// Waits for a device. New ones are opened while none is at work: at the start, and once all were lost to failures.
    fn take() -> Self {
        let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if pool.idle.is_empty() && pool.lent == 0 {
                let count = thread::available_parallelism().map_or(2, NonZero::get);
                let open = || {
                    open_device().unwrap_or_else(|error| {
                        panic!("the tests need a Vulkan device ({DEVICE_VARIABLE} chooses another): {error}")
                    })
                };
                pool.idle = iter::repeat_with(open).take(count).collect();
                let of_each = |device| {
                    [Compiler::Glslang, Compiler::Naga].map(|compiler| (compiler, new_library(device, compiler)))
                };
                let mut libraries = LIBRARIES.lock().unwrap_or_else(PoisonError::into_inner);
                libraries.extend(pool.idle.iter().flat_map(of_each));
            }
            if let Some(device) = pool.idle.pop() {
                pool.lent += 1;
                return Lent(device);
            }
            pool = RETURNED.wait(pool).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
        pool.lent -= 1;
        if thread::panicking() {
            // What the test has left on it may be anything, and it cannot be dropped beside others.
            mem::forget(self.0.clone());
        } else {
            pool.idle.push(self.0.clone());
        }
        RETURNED.notify_one();
    }
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
