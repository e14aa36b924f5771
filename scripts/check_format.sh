#!/usr/bin/env bash
# Every C++ file, or the files named, is as clang-format leaves it. With --fix first, makes it so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
how=(--dry-run --Werror)
if [ "${1:-}" = "--fix" ]; then
  how=(-i)
  shift
fi
if [ $# -gt 0 ]; then files=("$@"); else mapfile -t files < <(git ls-files '*.h' '*.cc'); fi
clang-format "${how[@]}" "${files[@]}"
