//! Backtraces of errors.

use super::threads::is_only_thread;

/// The variable that the standard library reads before `RUST_BACKTRACE` where an error takes a backtrace along.
const VARIABLE: &str = "RUST_LIB_BACKTRACE";

/// Has errors take no backtrace along, unless the user has said so by `RUST_LIB_BACKTRACE`; panics do as before. Reflection asks
/// whether a type is known by an error for each that is not: with `RUST_BACKTRACE=1` a third of the start of a paper went into
/// walks over the stack that nobody saw. To be called first in `main`. Does nothing once a second thread runs.
pub fn keep_errors_untraced() {
    if std::env::var_os(VARIABLE).is_some() || !is_only_thread() {
        return;
    }
    // SAFETY: no other thread reads or writes the environment, as this one is the only one of the process.
    unsafe { std::env::set_var(VARIABLE, "0") };
}
