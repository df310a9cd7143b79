//! `setup.sh` on systems that have nothing: the names that it gives their packages. Each is an `/etc/os-release` in a name space
//! of mounts of the test's own.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Output};

use crate::cli::program::{file, folder};

/// A system by its `/etc/os-release`, and the begin and the end of the command that installs what is missing.
const SYSTEMS: [(&str, &str, &str); 6] = [
    (
        "NAME=x\nID=debian\n",
        "apt-get install g++ libvulkan1 mesa-vulkan-drivers vulkan-validationlayers ",
        " libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0",
    ),
    (
        "ID=linuxmint\nID_LIKE=\"ubuntu\"\n",
        "apt-get install g++ libvulkan1 mesa-vulkan-drivers vulkan-validationlayers ",
        " libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0",
    ),
    (
        "ID=fedora\n",
        "dnf install gcc-c++ vulkan-loader mesa-vulkan-drivers vulkan-validation-layers ",
        " libX11-xcb libXcursor libXi libxkbcommon-x11",
    ),
    (
        "ID=\"rocky\"\nID_LIKE=\"rhel centos\"\n",
        "dnf install gcc-c++ vulkan-loader mesa-vulkan-drivers vulkan-validation-layers ",
        " libX11-xcb libXcursor libXi libxkbcommon-x11",
    ),
    (
        "ID=arch\n",
        "pacman -S gcc vulkan-icd-loader vulkan-swrast vulkan-validation-layers ",
        " libx11 libxcursor libxi libxkbcommon-x11",
    ),
    (
        "ID=\"opensuse-tumbleweed\"\nID_LIKE=\"opensuse suse\"\n",
        "zypper install gcc-c++ libvulkan1 libvulkan_lvp vulkan-validationlayers ",
        " libX11-xcb1 libXcursor1 libXi6 libxkbcommon-x11-0",
    ),
];

/// Runs `setup.sh --tests` on a system that says `release` of itself, with the programs of a folder alone.
fn set_up(release: &Path, programs: &Path) -> Output {
    let script = format!(
        "mount --bind '{}' /etc/os-release || exit
        exec env -i PATH='{}' HOME=/nowhere XDG_DATA_DIRS=/nowhere XDG_CONFIG_DIRS=/nowhere /bin/sh '{}/setup.sh' --tests",
        release.display(),
        programs.display(),
        env!("CARGO_MANIFEST_DIR"),
    );
    // An ordinary user is root in name spaces of its own.
    let run =
        |arguments: &[&str]| Command::new("unshare").args(arguments).args(["sh", "-c", &script]).output().unwrap();
    let has_run = |output: &Output| output.stderr.starts_with(b"setup: ");
    let output = Some(run(&["--mount"])).filter(has_run).unwrap_or_else(|| run(&["--map-root-user", "--mount"]));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(has_run(&output), "nothing can be mounted, nor in a name space: {said}; run the test as root");
    output
}

#[test]
fn packages_have_the_names_of_their_systems() {
    let (programs, out) = (folder(), folder());
    for tool in ["dirname", "sed", "cut", "sort", "head", "tail", "grep", "id", "env"] {
        let found = Command::new("sh").args(["-c", "command -v \"$0\"", tool]).output().unwrap();
        symlink(String::from_utf8(found.stdout).unwrap().trim(), programs.path().join(tool)).unwrap();
    }
    // Rust is there, and no library.
    for (name, text) in [("rustc", "echo rustc 9.0.0"), ("cargo", "echo cargo 9.0.0"), ("ldconfig", "exit 0")] {
        let path = file(&programs, name, format!("#!/bin/sh\n{text}\n"));
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    }
    for (release, begin, end) in SYSTEMS {
        let output = set_up(&file(&out, "os-release", release), programs.path());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), said.lines().count()), (Some(1), 1), "{release}: {said}");
        assert!(said.contains(begin) && said.trim_end().ends_with(end), "{release}: {said}");
    }
    let output = set_up(&file(&out, "os-release", "ID=void\n"), programs.path());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && said.contains("by their names in this system"), "{said}");
}
