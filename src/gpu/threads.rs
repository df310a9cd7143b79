//! The thread count of Mesa's software drivers.

use std::num::NonZero;

/// Sets `LP_NUM_THREADS` to the number of cores that this process may use, unless the user has set it: without it the
/// driver takes as many threads as it likes, and figures of two machines do not compare. To be called first in `main`:
/// drivers read it when devices are enumerated. Does nothing once a second thread runs.
pub fn pin_software_threads() {
    const VARIABLE: &str = "LP_NUM_THREADS";
    if std::env::var_os(VARIABLE).is_some() || !is_only_thread() {
        return;
    }
    if let Ok(cores) = std::thread::available_parallelism().map(NonZero::get) {
        // SAFETY: no other thread reads or writes the environment, as this one is the only one of the process.
        unsafe { std::env::set_var(VARIABLE, cores.to_string()) };
    }
}

/// True when the system tells that this process has one thread; only Linux does.
fn is_only_thread() -> bool {
    std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_process_of_several_threads_is_left_alone() {
        // The test harness runs a thread for each test beside its own.
        assert!(!super::is_only_thread());
    }
}
