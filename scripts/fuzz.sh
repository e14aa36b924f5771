#!/usr/bin/env bash
# Fuzzes one target (tests/fuzz/TARGET.cc) with libFuzzer, AddressSanitizer and UBSan, starting from its corpus.
# Usage: scripts/fuzz.sh TARGET SECONDS [OPTION OF LIBFUZZER...]     needs clang-14, libomp-14-dev and libclang-rt-14-dev
# What it finds is left in build-fuzz/found/TARGET; a file that shows something becomes part of tests/data/fuzz/TARGET.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -ge 2 ] && [ -f "tests/fuzz/$1.cc" ] && grep -q "moma_fuzz($1 " tests/fuzz/CMakeLists.txt || {
  sed -n '2,4s/^# //p' "$0" >&2
  echo "targets: $(sed -n 's/^ *moma_fuzz(\([a-z]*\) .*/\1/p' tests/fuzz/CMakeLists.txt | tr '\n' ' ')" >&2
  exit 2
}
target=$1 seconds=$2
shift 2
for package in clang-14 libomp-14-dev libclang-rt-14-dev; do
  dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || {
    echo "fuzz: missing: apt-get install clang-14 libomp-14-dev libclang-rt-14-dev" >&2
    exit 2
  }
done
[ -f build-fuzz/build.ninja ] || cmake --preset fuzz >/dev/null
cmake --build build-fuzz --target "fuzz_$target" -- --quiet
mkdir -p "build-fuzz/found/$target" "build-fuzz/corpus/$target"

# Words that the target's inputs are made of: those beside it, and the names of all keys for what is read by them.
words=build-fuzz/words-$target
: >"$words"
[ ! -f "tests/fuzz/$target.dict" ] || cat "tests/fuzz/$target.dict" >>"$words"
case "$target" in
  robot | controller | case | suite)
    cat tests/fuzz/yaml.dict >>"$words"
    sed -n 's/^| `\([^`]*\)`.*/\1/p' docs/reference/keys.md | tr '.' '\n' | grep -x '[a-z_]*' | sort -u | sed 's/.*/"&"/' >>"$words"
    ;;
esac
# Texts whose grammar fits into little, and for which time goes by the byte.
longest=16384
case "$target" in
  yaml | controller) longest=1024 ;;
  world) longest=4096 ;;
esac
# A control step has so much of what libFuzzer counts that choosing by how rare it is takes a quarter of the time, and looking
# for leaks a tenth: steps allocate nothing.
options=()
[ "$target" != step ] || options=(-entropic=0 -detect_leaks=0)
dictionary=()
[ ! -s "$words" ] || dictionary=(-dict="$words")
[ -d /dev/shm ] && export TMPDIR=/dev/shm # targets that write files
# Short stacks of allocations are a tenth of the time, and what was freed need not be kept for many inputs; what others leak
# is listed with its reasons.
export ASAN_OPTIONS="malloc_context_size=4:quarantine_size_mb=16:${ASAN_OPTIONS:-}"
export LSAN_OPTIONS="suppressions=$PWD/tests/sanitizers/lsan.supp:print_suppressions=0:${LSAN_OPTIONS:-}"
exec "build-fuzz/tests/fuzz/fuzz_$target" -max_total_time="$seconds" -timeout=25 -rss_limit_mb=4096 -max_len=$longest -print_final_stats=1 \
  "${options[@]}" "${dictionary[@]}" -artifact_prefix="build-fuzz/found/$target/" "$@" "build-fuzz/corpus/$target" "tests/data/fuzz/$target"
