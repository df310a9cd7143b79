//! The thread count of Mesa's software drivers.

use std::ffi::OsString;
use std::num::NonZero;
use std::process::Command;
use std::sync::OnceLock;

/// The variable that the drivers read when devices are enumerated.
const VARIABLE: &str = "LP_NUM_THREADS";

/// Value of the variable before [`draw_in_place`].
static KEPT: OnceLock<Option<OsString>> = OnceLock::new();

/// Sets `LP_NUM_THREADS` to the number of cores that this process may use, unless the user has set it: without it the
/// driver takes as many threads as it likes, and figures of two machines do not compare. To be called first in `main`:
/// drivers read it when devices are enumerated. Does nothing once a second thread runs.
pub fn pin_software_threads() {
    if std::env::var_os(VARIABLE).is_some() || !is_only_thread() {
        return;
    }
    if let Ok(cores) = std::thread::available_parallelism().map(NonZero::get) {
        // SAFETY: no other thread reads or writes the environment, as this one is the only one of the process.
        unsafe { std::env::set_var(VARIABLE, cores.to_string()) };
    }
}

/// Has a software driver of this process draw on the thread that submits: what is drawn for a moment, beside another process
/// that keeps every core busy, would wait longer for its threads to wake than it takes. Programs that are started with
/// [`for_another_process`] have as many threads as without it. Does nothing once a second thread runs.
pub fn draw_in_place() {
    if !is_only_thread() || KEPT.set(std::env::var_os(VARIABLE)).is_err() {
        return;
    }
    // SAFETY: no other thread reads or writes the environment, as this one is the only one of the process.
    unsafe { std::env::set_var(VARIABLE, "0") };
}

/// Gives a program that is about to start the threads that this process would have without [`draw_in_place`].
pub fn for_another_process(command: &mut Command) {
    match KEPT.get() {
        Some(Some(threads)) => command.env(VARIABLE, threads),
        Some(None) => command.env_remove(VARIABLE),
        None => command,
    };
}

/// True when the system tells that this process has one thread; only Linux does.
pub(super) fn is_only_thread() -> bool {
    cfg!(target_os = "linux") && std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_process_of_several_threads_is_left_alone() {
        // The test harness runs a thread for each test beside its own.
        assert!(!super::is_only_thread());
    }
}
