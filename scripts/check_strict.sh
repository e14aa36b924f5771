#!/usr/bin/env bash
# Builds everything with warnings as errors: by gcc, clang, or both. Usage: scripts/check_strict.sh [gcc] [clang]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -gt 0 ] || set -- gcc clang
for compiler in "$@"; do
  case "$compiler" in
    gcc) preset=strict ;;
    clang)
      preset=strict-clang
      command -v clang++-14 >/dev/null || { echo "clang is missing: apt-get install clang-14 libomp-14-dev" >&2; exit 2; }
      ;;
    *) echo "usage: $0 [gcc] [clang]" >&2; exit 2 ;;
  esac
done
scripts/setup.sh none
for compiler in "$@"; do
  preset=strict
  [ "$compiler" = gcc ] || preset=strict-clang
  cmake --preset "$preset"
  cmake --build --preset "$preset"
done
