#!/usr/bin/env bash
# clang-tidy over the sources of the folders named (default: controller), with the checks of .clang-tidy; needs a
# configured build (BUILD, default build/) for the compile commands. About 15 s a file.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build="${BUILD:-build}"
[ -f "$build/compile_commands.json" ] || { echo "no $build/compile_commands.json: run scripts/test.sh first" >&2; exit 2; }
[ $# -gt 0 ] || set -- controller
# Solver adapters of packages that are not there have no compile command.
mapfile -t files < <(for f in $(git ls-files "${@/%//*.cc}"); do
  grep -q "$PWD/$f\"" "$build/compile_commands.json" && echo "$f"
done)
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet
