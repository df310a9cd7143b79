//! The host's part of a record's environment; the device's part is filled by whoever owns the device.

use std::collections::BTreeMap;
use std::ffi::OsString;

use super::record::{Build, Host};
use crate::content;

/// The current time in UTC, RFC 3339 to the microsecond, by which processes that follow each other are put in order.
pub fn instant() -> String {
    humantime::format_rfc3339_micros(std::time::SystemTime::now()).to_string()
}

/// The current time in UTC, RFC 3339 to the second: `2026-01-31T12:00:00Z`.
pub fn date() -> String {
    humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string()
}

/// The command line as it was typed, what is not UTF-8 replaced.
pub fn command() -> Vec<String> {
    std::env::args_os().map(|argument| argument.to_string_lossy().into_owned()).collect()
}

/// The machine this process runs on, as far as the system tells.
pub fn host() -> Host {
    Host {
        os: read("/etc/os-release").and_then(|text| os_name(&text)).unwrap_or_else(|| std::env::consts::OS.to_owned()),
        kernel: read("/proc/sys/kernel/osrelease").map(|text| text.trim().to_owned()),
        cpu: read("/proc/cpuinfo").and_then(|text| cpu_name(&text)),
        logical_cores: std::thread::available_parallelism().ok().and_then(|count| u32::try_from(count.get()).ok()),
        lp_num_threads: lp_num_threads(),
        cpu_governor: read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor").map(|text| text.trim().to_owned()),
        variables: variables(std::env::vars_os()),
    }
}

/// The thread count of Mesa's software drivers; absent where the variable is unset or no number.
pub fn lp_num_threads() -> Option<u32> {
    std::env::var("LP_NUM_THREADS").ok().and_then(|value| value.trim().parse().ok())
}

/// Prefixes of the variables that the Vulkan loader, its layers and drivers read.
const VARIABLES: [&str; 23] = [
    "VK_",
    "LP_",
    "MESA_",
    "GALLIUM_",
    "GALLIVM_",
    "RADV_",
    "ANV_",
    "DRI_PRIME",
    "ACO_",
    "AMD_",
    "AMDVLK_",
    "INTEL_",
    "NIR_",
    "NVK_",
    "NOUVEAU_",
    "NV_",
    "__NV_",
    "__GL_",
    "PVR_",
    "PAN_",
    "TU_",
    "V3DV_",
    "VN_",
];

fn variables(all: impl Iterator<Item = (OsString, OsString)>) -> BTreeMap<String, String> {
    let text = |value: OsString| value.to_string_lossy().into_owned();
    let all = all.map(|(name, value)| (text(name), text(value)));
    all.filter(|(name, _)| VARIABLES.iter().any(|prefix| name.starts_with(prefix))).collect()
}

/// The build of this program, as told by the build script; what it could not find out is absent.
pub fn build() -> Build {
    let known = |value: Option<&str>| value.filter(|v| !v.is_empty()).map(str::to_owned);
    Build {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        git_commit: known(option_env!("FUMAROLE_GIT_COMMIT")),
        dirty: option_env!("FUMAROLE_GIT_DIRTY").and_then(|value| value.parse().ok()),
        rustc: known(option_env!("FUMAROLE_RUSTC")),
        profile: known(option_env!("FUMAROLE_PROFILE")),
        executable_sha256: std::env::current_exe().and_then(|path| content::file_sha256(&path)).ok(),
    }
}

fn read(path: &str) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

fn os_name(os_release: &str) -> Option<String> {
    let value = os_release.lines().find_map(|line| line.strip_prefix("PRETTY_NAME="))?;
    let name = value.trim().trim_matches(['"', '\'']);
    (!name.is_empty()).then(|| name.to_owned())
}

/// x86 says `model name`; ARM boards say `Model` or `Hardware`, if anything.
fn cpu_name(cpuinfo: &str) -> Option<String> {
    ["model name", "Model", "Hardware"].iter().find_map(|key| {
        cpuinfo.lines().find_map(|line| {
            let (name, value) = line.split_once(':')?;
            let value = value.trim();
            (name.trim() == *key && !value.is_empty()).then(|| value.to_owned())
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn date_is_rfc_3339_utc_to_the_second() {
        let date = date();
        assert_eq!(date.len(), "2026-01-31T12:00:00Z".len(), "{date}");
        assert!(date.ends_with('Z'));
        assert!(humantime::parse_rfc3339(&date).is_ok());
    }

    #[test]
    fn names_are_read_from_the_system_files() {
        let release = "NAME=\"Debian\"\nPRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\n";
        assert_eq!(os_name(release).as_deref(), Some("Debian GNU/Linux 12 (bookworm)"));
        assert_eq!(os_name("NAME=x\n"), None);
        let cpuinfo = "processor\t: 0\nmodel\t\t: 85\nmodel name\t: Some CPU @ 2.60GHz\n";
        assert_eq!(cpu_name(cpuinfo).as_deref(), Some("Some CPU @ 2.60GHz"));
        assert_eq!(cpu_name("processor : 0\n"), None);
    }

    #[test]
    fn this_machine_has_cores_and_this_build_a_version() {
        assert!(host().logical_cores.is_some_and(|count| count >= 1));
        assert_eq!(build().version, env!("CARGO_PKG_VERSION"));
    }
}
