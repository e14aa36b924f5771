#!/usr/bin/env bash
# Writes docs/reference-keys.md from the program's own descriptions. With --check only says whether it is up to date.
# MOMA=PATH: the program, build/moma unless told otherwise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
moma="${MOMA:-build/moma}"
page=docs/reference-keys.md
if [ "${1:-}" = --check ]; then
  "$moma" keys --reference | diff -u "$page" - || { echo "$page is not what the program says: run scripts/reference_keys.sh" >&2; exit 1; }
else
  "$moma" keys --reference > "$page.new"
  mv "$page.new" "$page"
fi
