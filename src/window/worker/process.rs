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
    #[cfg(target_os = "linux")]
    turns::lengthen();
}

/// Turns on a core. A thread that wakes up waits for the end of another's turn, unless its own are shorter (Linux, from 6.12
/// on; before, nothing of this changes anything). The window, which wakes up for a moment and several times a frame, has
/// its core at once where the worker's turns are long.
#[cfg(target_os = "linux")]
mod turns {
    use nix::libc;

    /// Nanoseconds of a turn: the longest that the system takes.
    const LONG_NS: u64 = 100_000_000;

    /// The first form of what `sched_getattr` and `sched_setattr` take, as `linux/sched/types.h` has it.
    #[derive(Debug, Default)]
    #[repr(C)]
    struct Attributes {
        size_bytes: u32,
        policy: u32,
        flags: u64,
        niceness: i32,
        priority: u32,
        turn_ns: u64,
        deadline_ns: u64,
        period_ns: u64,
    }

    /// Those of the thread that asks; `None` where the system does not tell.
    fn own() -> Option<Attributes> {
        let mut attributes = Attributes::default();
        // SAFETY: the call writes no more than the bytes that it is told of, which are those of the structure; any bytes are one.
        let result = unsafe {
            libc::syscall(libc::SYS_sched_getattr, 0, &raw mut attributes, size_of::<Attributes>() as libc::c_uint, 0)
        };
        (result == 0).then_some(attributes)
    }

    /// Has the thread that asks, and those that it makes, take long turns. A system that does not know them is left alone.
    pub fn lengthen() {
        let Some(mut attributes) = own().filter(|own| own.policy == libc::SCHED_OTHER as u32) else { return };
        attributes.turn_ns = LONG_NS;
        attributes.flags = 0;
        // SAFETY: the call reads the bytes that the structure says it has, and touches no memory of the program.
        unsafe { libc::syscall(libc::SYS_sched_setattr, 0, &raw const attributes, 0) };
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn turns_are_long_and_all_else_is_as_it_was() {
            let before = own().expect("Linux tells");
            lengthen();
            let after = own().expect("Linux tells");
            // A system before 6.12 tells of no turns.
            assert_eq!(after.turn_ns, if before.turn_ns == 0 { 0 } else { LONG_NS }, "{before:?}");
            assert_eq!((after.policy, after.niceness), (before.policy, before.niceness));
            assert_eq!(std::thread::spawn(own).join().unwrap().map(|of_child| of_child.turn_ns), Some(after.turn_ns));
        }
    }
}

/// Bytes that the process holds in memory, where the system tells.
pub fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}
