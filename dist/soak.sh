#!/usr/bin/env bash
# Long runs of every paper: 20,000 frames on the first device, or on DEVICE, and 1,000 on SwiftShader where Chromium has it
# (./setup.sh --tests installs it). Rows of a Markdown table come out; benches/soak.rs says what each must show. A paper
# by name, or all: soak.sh [PAPER] [FRAMES] [FRAMES on SwiftShader] [DEVICE].
set -euo pipefail
cd "$(dirname "$0")/.."
PATH=$PATH:${CARGO_HOME:-${HOME:-}/.cargo}/bin
paper=${1:-all} frames=${2:-20000} slow_frames=${3:-1000} device=${4:-llvmpipe}
# What was freed goes back to the system: glibc keeps more of it the more it has seen, in steps, up to several megabytes.
export MALLOC_TRIM_THRESHOLD_=4096
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
status=0

echo '| Paper, variant | Device | Frames | Growth after warm-up | Live objects | Last picture and a fresh run'"'"'s | Equal frames after and in a fresh process | Took |'
echo '| --- | --- | --- | --- | --- | --- | --- | --- |'
cargo bench --quiet --locked --bench soak -- "$paper" "$frames" "$device" || status=1

for folder in ${FUMAROLE_TEST_LIBRARIES:-} /usr/lib/chromium /usr/lib64/chromium-browser /usr/lib64/chromium; do
    library=$folder/libvk_swiftshader.so
    [ -e "$library" ] || continue
    printf '{"file_format_version": "1.0.0", "ICD": {"library_path": "%s", "api_version": "1.3.0"}}' "$library" \
        >"$scratch/swiftshader.json"
    VK_DRIVER_FILES=$scratch/swiftshader.json VK_ICD_FILENAMES=$scratch/swiftshader.json \
        cargo bench --quiet --locked --bench soak -- "$paper" "$slow_frames" SwiftShader || status=1
    exit "$status"
done
echo 'soak: no SwiftShader is installed: run ./setup.sh --tests' >&2
exit 1
