#!/usr/bin/env bash
# Builds and checks for systems that the tests do not run on: platforms.sh [windows|macos|aarch64]..., all of them without a
# name. It adds the Rust targets that it needs. What a step needs beside: windows a cross compiler (Debian's
# g++-mingw-w64-x86-64-posix) and, to run the library's tests, wine; aarch64 a cross compiler (g++-aarch64-linux-gnu).
#
# windows compiles and links the programs, and runs the tests that need no device (all but those of gpu::tests); wine 8 lacks
# one library of Windows 10, for which a stub stands in. macos and
# aarch64 compile all Rust code and link nothing. Build scripts compile C++ under `cargo check` too: for macOS, whose compiler
# and headers may not be shipped, a stub stands in for it and makes empty objects, so that nothing is known of the C++ there.
set -euo pipefail
cd "$(dirname "$0")/.."
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target/platforms}
PATH=$PATH:${CARGO_HOME:-${HOME:-}/.cargo}/bin
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

need() {
    command -v "$1" >/dev/null || {
        printf 'platforms: %s is missing: install %s\n' "$1" "$2" >&2
        exit 1
    }
}

target() {
    rustup target add "$1" 2>"$scratch/rustup" || {
        printf 'platforms: the Rust target %s is not to be had here: %s\n' "$1" "$(tail -n 1 "$scratch/rustup")" >&2
        exit 1
    }
}

windows() {
    need x86_64-w64-mingw32-g++-posix g++-mingw-w64-x86-64-posix
    target x86_64-pc-windows-gnu
    export CC_x86_64_pc_windows_gnu=x86_64-w64-mingw32-gcc-posix CXX_x86_64_pc_windows_gnu=x86_64-w64-mingw32-g++-posix
    export CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER=x86_64-w64-mingw32-g++-posix
    # One file runs by itself: the C++ runtime is part of it, since where the linker looks first there is no other.
    runtime=$CARGO_TARGET_DIR/cxx-of-windows
    mkdir -p "$runtime"
    cp "$(x86_64-w64-mingw32-g++-posix -print-file-name=libstdc++.a)" "$runtime"
    runtime=$(cd "$runtime" && pwd)
    export CARGO_TARGET_X86_64_PC_WINDOWS_GNU_RUSTFLAGS="-Clink-arg=-static -Lnative=$runtime"
    cargo build --release --locked --target x86_64-pc-windows-gnu --bins
    if ! command -v wine >/dev/null; then
        echo 'platforms: no wine: the tests were compiled for Windows, not run'
        cargo test --release --locked --target x86_64-pc-windows-gnu --lib --no-run
        return
    fi
    # Rust asks Windows 10's bcryptprimitives.dll for random bytes.
    cat >"$scratch/random.c" <<'STUB'
#include <windows.h>
BOOLEAN NTAPI SystemFunction036(void *, ULONG);
__declspec(dllexport) BOOL WINAPI ProcessPrng(void *bytes, SIZE_T count) { return SystemFunction036(bytes, (ULONG)count); }
STUB
    x86_64-w64-mingw32-gcc-posix -shared -o "$scratch/bcryptprimitives.dll" "$scratch/random.c" -ladvapi32
    export WINEPREFIX=$scratch/wine WINEPATH=$scratch WINEDEBUG=-all CARGO_TARGET_X86_64_PC_WINDOWS_GNU_RUNNER=wine
    cargo test --release --locked --target x86_64-pc-windows-gnu --lib -- --skip gpu::tests
    programs=$CARGO_TARGET_DIR/x86_64-pc-windows-gnu/release
    wine "$programs/fumarole.exe" --version
    wine "$programs/caustics.exe" bench --help >/dev/null
    # There is no Vulkan driver: it must say so and end with 3.
    status=0
    wine "$programs/caustics.exe" bench || status=$?
    [ "$status" -eq 3 ] || { printf 'platforms: without a driver it ended with %s\n' "$status" >&2; exit 1; }
}

macos() {
    target aarch64-apple-darwin
    cat >"$scratch/compiler" <<'STUB'
#!/bin/sh
# An empty object in place of every source, and the answers of a plain clang.
for word; do
    [ "$previous" = -o ] && : >"$word"
    previous=$word
done
exit 0
STUB
    printf '#!/bin/sh\nexit 0\n' >"$scratch/archiver"
    chmod +x "$scratch/compiler" "$scratch/archiver"
    env CC_aarch64_apple_darwin="$scratch/compiler" CXX_aarch64_apple_darwin="$scratch/compiler" \
        AR_aarch64_apple_darwin="$scratch/archiver" RANLIB_aarch64_apple_darwin=true SDKROOT="$scratch" \
        cargo check --release --locked --target aarch64-apple-darwin --all-targets
}

aarch64() {
    need aarch64-linux-gnu-g++ g++-aarch64-linux-gnu
    target aarch64-unknown-linux-gnu
    env CC_aarch64_unknown_linux_gnu=aarch64-linux-gnu-gcc CXX_aarch64_unknown_linux_gnu=aarch64-linux-gnu-g++ \
        cargo check --release --locked --target aarch64-unknown-linux-gnu --all-targets
}

for name in "${@:-windows macos aarch64}"; do
    for platform in $name; do
        case $platform in
        windows | macos | aarch64) "$platform" ;;
        *) printf 'platforms: no step %s\n' "$platform" >&2; exit 2 ;;
        esac
        printf 'platforms: %s: done\n' "$platform"
    done
done
