//! The host's memory, by Linux's account; other systems tell nothing.

use std::fs;
use std::path::Path;

/// Most memory that this process has had.
pub fn peak_bytes() -> Option<u64> {
    kilobytes(&account("/proc/self/status")?, "VmHWM:")
}

/// Memory that a process may still take: what the system has free, and what its control group and those round it may have.
pub fn available_bytes() -> Option<u64> {
    let free = kilobytes(&account("/proc/meminfo")?, "MemAvailable:")?;
    let groups = account("/proc/self/cgroup").unwrap_or_default();
    let group = groups.lines().find_map(|line| line.strip_prefix("0::/"));
    let of_groups = group.and_then(|group| least_left(Path::new("/sys/fs/cgroup"), group));
    Some(of_groups.map_or(free, |left| left.min(free)))
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

/// Least that is left in a group below `root` and in those that it lies in, each of which counts what those in it have.
fn least_left(root: &Path, group: &str) -> Option<u64> {
    Path::new(group).ancestors().filter_map(|group| left_in(&root.join(group))).min()
}

fn left_in(group: &Path) -> Option<u64> {
    let number = |name: &str| fs::read_to_string(group.join(name)).ok()?.trim().parse::<u64>().ok();
    // What the system gives back by itself before it kills for memory: files that were read long ago, and its own caches.
    let account = fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
    let spare = ["inactive_file", "slab_reclaimable"].iter().filter_map(|name| counted(&account, name));
    let taken = spare.fold(number("memory.current")?, u64::saturating_sub);
    Some(number("memory.max")?.saturating_sub(taken))
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
        // What can be given back is not lost.
        let account = "inactive_file_of 7\nfile 90\ninactive_file 60\nslab_reclaimable 10\nslab 20\n";
        fs::write(folder.path().join("memory.stat"), account).unwrap();
        assert_eq!(left_in(folder.path()), Some(320));
        // The accounts are not of one moment.
        fs::write(folder.path().join("memory.stat"), "inactive_file 101\n").unwrap();
        assert_eq!(left_in(folder.path()), Some(350));
    }

    #[test]
    fn a_group_has_no_more_than_those_that_it_lies_in() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        assert_eq!(least_left(root, "outer/middle/inner"), None);
        fs::create_dir_all(root.join("outer/middle/inner")).unwrap();
        let set = |group: &str, most: &str, current: &str| {
            fs::write(root.join(group).join("memory.max"), format!("{most}\n")).unwrap();
            fs::write(root.join(group).join("memory.current"), format!("{current}\n")).unwrap();
        };
        set("outer/middle/inner", "900", "100");
        set("outer/middle", "max", "150");
        set("outer", "300", "200");
        let left = || ["outer/middle/inner", "outer/middle", "outer", ""].map(|group| least_left(root, group));
        assert_eq!(left(), [Some(100), Some(100), Some(100), None]);
        set("outer/middle/inner", "130", "100");
        assert_eq!(left(), [Some(30), Some(100), Some(100), None]);
        // The root has a limit where it is a container's own.
        set("", "210", "200");
        assert_eq!(left(), [Some(10); 4]);
    }

    #[test]
    fn this_process_has_had_some_and_may_take_more() {
        let is_linux = cfg!(target_os = "linux");
        assert_eq!(peak_bytes().is_some_and(|bytes| bytes > 1 << 20), is_linux);
        assert_eq!(available_bytes().is_some_and(|bytes| bytes > 1 << 20), is_linux);
    }
}
