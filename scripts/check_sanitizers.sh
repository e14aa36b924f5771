#!/usr/bin/env bash
# Builds and runs the tests under sanitizers: asan-ubsan (memory, undefined behaviour), tsan (data races), or both.
# Usage: scripts/check_sanitizers.sh [asan-ubsan] [tsan]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -gt 0 ] || set -- asan-ubsan tsan
for preset in "$@"; do
  case "$preset" in
    asan-ubsan) ;;
    tsan)
      command -v clang++-14 >/dev/null || { echo "clang is missing: apt-get install clang-14 libomp-14-dev libclang-rt-14-dev" >&2; exit 2; }
      ;;
    *) echo "usage: $0 [asan-ubsan] [tsan]" >&2; exit 2 ;;
  esac
done
scripts/setup.sh none
for preset in "$@"; do
  cmake --preset "$preset"
  cmake --build --preset "$preset"
  ctest --preset "$preset" -j "$(nproc)"
done
