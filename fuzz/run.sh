#!/bin/sh
# Fuzzes one reader, or all in turn: run.sh [TARGET|all] [SECONDS each]. Needs the stable compiler alone.
# A finding is written to fuzz/artifacts; new inputs to fuzz/found, of which the best go into fuzz/corpus by hand.
set -eu
cd "$(dirname "$0")"
host=$(rustc -vV | sed -n 's/^host: //p')
llvm() { printf ' -Cllvm-args=-sanitizer-coverage-%s' "$1"; }
RUSTFLAGS="-Cpasses=sancov-module$(llvm level=4)$(llvm inline-8bit-counters)$(llvm pc-table)$(llvm trace-compares) --cfg fuzzing" \
    cargo build --release --locked --target "$host"
targets=${1:-all}
log=$(mktemp)
trap 'rm -f "$log"' EXIT
failed=
[ "$targets" != all ] || targets=$(ls corpus)
for target in $targets; do
    mkdir -p "found/$target" artifacts
    echo "== $target"
    # Of the cost rule (1 s and 64 MiB beside the program's own, for files of less than a megabyte) as much as can be told from one
    # process for all: 2 s an input, 80 MB an allocation, 1 GB in all. The tests of the command line hold the rest.
    FUMAROLE_FUZZ_TARGET=$target "target/$host/release/fuzz" "found/$target" "corpus/$target" -max_total_time="${2:-60}" \
        -timeout=2 -malloc_limit_mb=80 -rss_limit_mb=1024 -max_len=65536 -artifact_prefix="artifacts/$target-" \
        -print_final_stats=1 -verbosity=1 >"$log" 2>&1 || failed="$failed $target"
    case " $failed " in *" $target "*) tail -5 "$log" ;; esac
    grep -E 'cov:|stat::|ERROR|panicked|SUMMARY' "$log" | awk '/cov:/ { last = $0; next } { print } END { print last }'
done
[ -z "$failed" ] || { echo "fuzz: findings in:$failed" >&2; exit 1; }
