#!/bin/sh
# Makes this machine able to build and run fumarole, with --tests to test it as well: checks what that needs, installs
# what is missing with apt-get on Debian and Ubuntu, names the packages of Fedora, Arch and openSUSE, and is silent when
# all is there. Exits 1, having changed nothing, where it cannot.
set -eu

here=$(dirname "$0")

say() {
    printf 'setup: %s\n' "$1" >&2
}

fail() {
    say "$1"
    exit 1
}

# Prints what is wrong with the Rust toolchain and the way out, or nothing.
rust_problem() {
    required=$(sed -n 's/^rust-version *= *"\(.*\)".*/\1/p' "$here/Cargo.toml")
    for tool in rustc cargo; do
        if ! answer=$(cd "$here" && "$tool" --version 2>/dev/null); then
            echo "no working $tool on PATH; install Rust $required or later with rustup (https://rustup.rs) and open a new shell"
            return
        fi
        found=$(printf '%s\n' "$answer" | cut -d ' ' -f 2)
        if [ "$(printf '%s\n' "$required" "$found" | sort -V | head -n 1)" != "$required" ]; then
            echo "$tool is $found, needed is $required or later; run 'rustup update stable' (rustup: https://rustup.rs)"
            return
        fi
    done
}

# Rust links through cc, the shader compiler is built with c++, and a compiler without its standard library is no use.
has_cpp_compiler() {
    command -v cc >/dev/null &&
        echo '#include <cstddef>' | c++ -x c++ -fsyntax-only - 2>/dev/null
}

has_vulkan_loader() (
    has_library libvulkan.so.1 && exit
    IFS=:
    for directory in ${LD_LIBRARY_PATH:-}; do
        [ -e "$directory/libvulkan.so.1" ] && exit
    done
    exit 1
)

# has_manifest TEXT KIND PATHS: whether TEXT stands in a manifest of this KIND where the Vulkan loader looks for it,
# or in one of the files and directories of the colon-separated PATHS. The versions that manifests state are no
# guide: Mesa 22.3's says 1.1 of a driver for 1.3. The program itself refuses a driver that is too old.
has_manifest() (
    configuration=${XDG_CONFIG_HOME:-${HOME:-}/.config}:${XDG_CONFIG_DIRS:-/etc/xdg}:/usr/local/etc:/etc
    data=${XDG_DATA_HOME:-${HOME:-}/.local/share}:${XDG_DATA_DIRS:-/usr/local/share:/usr/share}
    IFS=:
    for directory in $configuration $data; do
        grep -rqsF "$1" "$directory/vulkan/$2" && exit
    done
    for path in $3; do
        grep -rqsF "$1" "$path" && exit
    done
    exit 1
)

# Whether a library that Chromium brings lies where the tests look for it: tests/suite/drivers/mod.rs has the same list.
has_chromium_library() {
    for directory in "${FUMAROLE_TEST_LIBRARIES:-}" /usr/lib/chromium /usr/lib64/chromium-browser /usr/lib64/chromium; do
        [ -e "$directory/$1" ] && return
    done
    return 1
}

# Whether all these programs are there; daemons are not on every user's path.
has_programs() (
    PATH=$PATH:/usr/sbin:/sbin
    for program; do
        command -v "$program" >/dev/null || exit 1
    done
)

# Whether a Chromium is there that the tests of the report's page can drive: tests/suite/page/browser.rs has the same list.
has_browser() {
    [ -x "${FUMAROLE_TEST_BROWSER:-}" ] && return
    for program in chromium-headless-shell chromium chromium-browser google-chrome; do
        command -v "$program" >/dev/null && return
    done
    return 1
}

# Whether a session's bus can start the one of assistive tools.
has_a11y_bus() (
    IFS=:
    for directory in ${XDG_DATA_DIRS:-/usr/local/share:/usr/share}; do
        [ -e "$directory/dbus-1/services/org.a11y.Bus.service" ] && exit
    done
    exit 1
)

# Collects the missing pieces in words and as packages.
find_missing() {
    missing='' packages=''
    has_cpp_compiler ||
        need g++ 'a C++ compiler'
    has_vulkan_loader ||
        need libvulkan1 'the Vulkan loader libvulkan.so.1'
    has_manifest libvulkan_lvp icd.d "${VK_DRIVER_FILES:-}:${VK_ICD_FILENAMES:-}:${VK_ADD_DRIVER_FILES:-}" ||
        need mesa-vulkan-drivers "Mesa's lavapipe driver"
    has_manifest VK_LAYER_KHRONOS_validation explicit_layer.d "${VK_LAYER_PATH:-}:${VK_ADD_LAYER_PATH:-}" ||
        need vulkan-validationlayers 'the Khronos validation layer'
    [ -z "$tests" ] || { has_chromium_library libvk_swiftshader.so && has_chromium_library libVkLayer_khronos_validation.so; } ||
        need chromium-common 'the SwiftShader driver and the current validation layer that Chromium brings'
    [ -z "$tests" ] || has_browser ||
        need chromium-headless-shell 'a Chromium without a window'
    [ -z "$tests" ] || command -v Xvfb >/dev/null ||
        need xvfb 'Xvfb, a display without a screen, for the tests of the window'
    [ -z "$tests" ] || command -v openbox >/dev/null ||
        need openbox 'a small window manager for the same tests'
    [ -z "$tests" ] || command -v weston >/dev/null ||
        need weston 'weston, a Wayland compositor, for the same tests'
    [ -z "$tests" ] || has_programs dbus-run-session dbus-send ||
        need dbus 'dbus, the buses that assistive tools read the window over, for the same tests'
    [ -z "$tests" ] || has_a11y_bus ||
        need at-spi2-core 'at-spi2-core, their registry'
    [ -z "$tests" ] || has_programs sbatch slurmctld slurmd ||
        need slurm-wlm 'Slurm, for the tests of films on many machines'
    [ -z "$tests" ] || has_programs munged mungekey ||
        need munge "munge, Slurm's authentication"
    # The window loads these when it opens.
    for library in libX11-xcb.so.1:libx11-xcb1 libXcursor.so.1:libxcursor1 libXi.so.6:libxi6 \
        libxkbcommon-x11.so.0:libxkbcommon-x11-0; do
        [ -z "$tests" ] || has_library "${library%%:*}" ||
            need "${library##*:}" "${library%%:*}, which windows need"
    done
}

# Whether a library is where the system looks for libraries. An ordinary user's PATH on Debian lacks ldconfig.
has_library() (
    PATH=$PATH:/usr/sbin:/sbin
    ldconfig -p 2>/dev/null | grep -qF "$1 "
)

# need PACKAGE WORDS: the package by Debian's name.
need() {
    package=$(package_here "$1")
    missing="$missing${missing:+, }$2 (package $package)"
    packages="$packages $package"
}

# The kind of this system, as its package names go: debian, fedora, arch, suse or nothing.
system() {
    for kind in debian ubuntu fedora rhel arch suse; do
        if grep -Eqs "^ID(_LIKE)?=.*$kind" /etc/os-release; then
            echo "$kind" | sed 's/ubuntu/debian/; s/rhel/fedora/'
            return
        fi
    done
}

# What Debian's package is called here. The names of other systems than Debian's are from their package lists: nothing was
# ever installed there.
package_here() {
    case $system:$1 in
    fedora:g++ | suse:g++) echo gcc-c++ ;;
    arch:g++) echo gcc ;;
    fedora:libvulkan1) echo vulkan-loader ;;
    arch:libvulkan1) echo vulkan-icd-loader ;;
    arch:mesa-vulkan-drivers) echo vulkan-swrast ;;
    suse:mesa-vulkan-drivers) echo libvulkan_lvp ;;
    fedora:vulkan-validationlayers | arch:vulkan-validationlayers) echo vulkan-validation-layers ;;
    fedora:xvfb) echo xorg-x11-server-Xvfb ;;
    arch:xvfb) echo xorg-server-xvfb ;;
    suse:xvfb) echo xorg-x11-server-Xvfb ;;
    fedora:libxkbcommon-x11-0 | arch:libxkbcommon-x11-0) echo libxkbcommon-x11 ;;
    fedora:libxcursor1) echo libXcursor ;;
    fedora:libxi6) echo libXi ;;
    arch:libxcursor1) echo libxcursor ;;
    arch:libxi6) echo libxi ;;
    suse:libxcursor1) echo libXcursor1 ;;
    suse:libxi6) echo libXi6 ;;
    fedora:libx11-xcb1) echo libX11-xcb ;;
    arch:libx11-xcb1) echo libx11 ;;
    suse:libx11-xcb1) echo libX11-xcb1 ;;
    fedora:chromium-* | arch:chromium-* | suse:chromium-*) echo chromium ;;
    fedora:dbus) echo dbus-daemon dbus-tools ;;
    suse:dbus) echo dbus-1-daemon dbus-1-tools ;;
    fedora:slurm-wlm) echo slurm slurm-slurmctld slurm-slurmd ;;
    arch:slurm-wlm) echo slurm-llnl ;;
    suse:slurm-wlm) echo slurm ;;
    *) echo "$1" ;;
    esac
}

# The command that installs packages here.
installer() {
    case $system in
    fedora) echo 'dnf install' ;;
    arch) echo 'pacman -S' ;;
    suse) echo 'zypper install' ;;
    *) echo 'apt-get install' ;;
    esac
}

# Prints the command that gives root's rights: `env` for root itself.
root_command() {
    if [ "$(id -u)" -eq 0 ]; then
        echo env
    elif sudo -n true 2>/dev/null; then
        echo 'sudo -n env'
    elif [ -t 0 ] && command -v sudo >/dev/null; then
        echo 'sudo env'
    else
        return 1
    fi
}

# A package manager of a machine that has just booted may hold the lock for minutes.
apt() {
    $as_root DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 "$@" </dev/null 2>&1
}

install_packages() {
    say "installing$packages"
    # A source that fails need not be the one that holds the packages; if it is, the installation fails as well.
    log=$(apt update) || say "apt-get update failed; going on with the package lists that are here"
    # shellcheck disable=SC2086
    if ! log="$log
$(apt install -y --no-install-recommends $packages)"; then
        printf '%s\n' "$log" | tail -n 20 >&2
        fail "apt-get could not install$packages: see its messages above"
    fi
}

tests=''
case $#:${1:-} in
0:) ;;
1:--tests) tests=yes ;;
*) fail "unknown arguments '$*'; give none, or --tests" ;;
esac
system=$(system)
rust=$(rust_problem)
find_missing
if [ -n "$rust" ]; then
    say "$rust"
    [ -z "$missing" ] || say "missing as well: $missing"
    exit 1
elif [ -z "$missing" ]; then
    exit 0
elif [ -z "$system" ]; then
    fail "missing: $missing; install them by their names in this system, which is not known here, and run this again"
elif [ "$system" != debian ] || ! command -v apt-get >/dev/null; then
    fail "missing: $missing; install them and run this again: $(installer)$packages"
elif ! as_root=$(root_command); then
    fail "missing: $missing; no root and no sudo here, so let an administrator run: apt-get install$packages"
fi
install_packages
find_missing
[ -z "$missing" ] || fail "still missing after the installation: $missing"
