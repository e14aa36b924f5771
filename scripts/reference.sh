#!/usr/bin/env bash
# Writes the pages of docs/reference that the program says itself: keys.md and commands.md. With --check only says whether
# they are up to date. MOMA=PATH: the program, build/moma unless told otherwise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
moma="${MOMA:-build/moma}"
for name in keys commands; do
  page="docs/reference/$name.md"
  case "$name" in
    keys) said=(keys --reference) ;;
    commands) said=(help --reference) ;;
  esac
  if [ "${1:-}" = --check ]; then
    "$moma" "${said[@]}" | diff -u "$page" - || { echo "$page is not what the program says: run scripts/reference.sh" >&2; exit 1; }
  else
    "$moma" "${said[@]}" > "$page.new"
    mv "$page.new" "$page"
  fi
done
