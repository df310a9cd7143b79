//! The host's memory, by Linux's account; other systems tell nothing.

use std::fs;
use std::path::Path;

/// Most memory that this process has had.
pub fn peak_bytes() -> Option<u64> {
    kilobytes(&account("/proc/self/status")?, "VmHWM:")
}

/// Memory that a process may still take: what the system has free, and what the control group may have.
pub fn available_bytes() -> Option<u64> {
    let free = kilobytes(&account("/proc/meminfo")?, "MemAvailable:")?;
    let groups = account("/proc/self/cgroup").unwrap_or_default();
    let group = groups.lines().find_map(|line| line.strip_prefix("0::/"));
    let of_group = group.and_then(|group| left_in(&Path::new("/sys/fs/cgroup").join(group)));
    Some(of_group.map_or(free, |left| left.min(free)))
}

/// Processes that the system has killed since its start because memory ran out, its own or a control group's.
pub fn killed_for_memory() -> Option<u64> {
    counted(&account("/proc/vmstat")?, "oom_kill")
}

/// Makes this process the first that the system kills when memory runs out, so that it takes no other.
pub fn be_killed_first() {
    // Where it cannot be said, nothing is lost.
    let _ = fs::write("/proc/self/oom_score_adj", "1000");
}

/// Text of a file of Linux's account; another system may show the account of a Linux below it, which is not its own.
fn account(path: &str) -> Option<String> {
    cfg!(target_os = "linux").then(|| fs::read_to_string(path).ok()).flatten()
}

fn left_in(group: &Path) -> Option<u64> {
    let number = |name: &str| fs::read_to_string(group.join(name)).ok()?.trim().parse::<u64>().ok();
    Some(number("memory.max")?.saturating_sub(number("memory.current")?))
}

fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

fn counted(text: &str, name: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' ')?.trim().parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_in_bytes_and_a_group_may_have_none() {
        assert_eq!(kilobytes("a: 1 kB\nVmHWM:\t  12 kB\n", "VmHWM:"), Some(12 << 10));
        assert_eq!(kilobytes("VmHWM: many", "VmHWM:"), None);
        assert_eq!(counted("oom_kill_of 1\noom_kill 3\n", "oom_kill"), Some(3));
        assert_eq!(counted("oom_kills 1\n", "oom_kill"), None);
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(left_in(folder.path()), None);
        fs::write(folder.path().join("memory.current"), "100\n").unwrap();
        fs::write(folder.path().join("memory.max"), "max\n").unwrap();
        assert_eq!(left_in(folder.path()), None);
        fs::write(folder.path().join("memory.max"), "350\n").unwrap();
        assert_eq!(left_in(folder.path()), Some(250));
    }

    #[test]
    fn this_process_has_had_some_and_may_take_more() {
        let is_linux = cfg!(target_os = "linux");
        assert_eq!(peak_bytes().is_some_and(|bytes| bytes > 1 << 20), is_linux);
        assert_eq!(available_bytes().is_some_and(|bytes| bytes > 1 << 20), is_linux);
    }
}
