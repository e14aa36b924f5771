#!/usr/bin/env bash
# Fuzzes one target (tests/fuzz/TARGET.cc) with libFuzzer, AddressSanitizer and UBSan, starting from its corpus.
# Usage: scripts/fuzz.sh TARGET SECONDS     needs clang-14, libomp-14-dev and libclang-rt-14-dev
# What it finds is left in build-fuzz/found/TARGET; a file that shows something becomes part of tests/data/fuzz/TARGET.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -eq 2 ] && [ -f "tests/fuzz/$1.cc" ] || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }
[ -f build-fuzz/build.ninja ] || cmake --preset fuzz >/dev/null
cmake --build build-fuzz --target "fuzz_$1" -- --quiet
mkdir -p "build-fuzz/found/$1" "build-fuzz/corpus/$1"
exec "build-fuzz/tests/fuzz/fuzz_$1" -max_total_time="$2" -timeout=25 -rss_limit_mb=4096 -max_len=16384 -print_final_stats=1 \
  -artifact_prefix="build-fuzz/found/$1/" "build-fuzz/corpus/$1" "tests/data/fuzz/$1"
