//! The worker's own process.

/// Ends it at once, without the handlers of libraries whose threads are at work.
pub fn end_now() -> ! {
    // SAFETY: `_exit` takes any number, touches no memory of the program and does not return.
    #[cfg(unix)]
    unsafe {
        nix::libc::_exit(0)
    }
    #[cfg(not(unix))]
    std::process::abort()
}

/// Degree to which the process gives way to others that want a core: at 5, a thread of theirs has three quarters of it; on
/// a core that nobody else wants nothing changes.
#[cfg(unix)]
const NICENESS: nix::libc::c_int = 5;

/// Gives way to the window, which draws for a moment now and then and whose user waits for it. To be called before other
/// threads are there: they have it from the first one.
pub fn give_way() {
    // SAFETY: `nice` takes any number and touches no memory of the program. What it returns says how nice the process is.
    #[cfg(unix)]
    unsafe {
        nix::libc::nice(NICENESS);
    }
}

/// Bytes that the process holds in memory, where the system tells.
pub fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}
