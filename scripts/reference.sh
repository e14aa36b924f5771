#!/usr/bin/env bash
# Writes the pages of docs/reference that the program says itself: keys.md and commands.md. With --check only says whether
# they are up to date. MOMA=PATH: the program, build/moma unless told otherwise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
moma="${MOMA:-build/moma}"

keys() { "$moma" keys --reference; }

# The help of the program and of each command.
commands() {
  printf '# Every command\n\nWritten by `scripts/reference.sh`: what `moma help`, `moma help COMMAND` and the manual page say.\n\n'
  printf '```text\n%s\n```\n' "$("$moma" help)"
  for command in $("$moma" help | sed -n 's/^  \([a-z][a-z]*\) .*/\1/p'); do
    printf '\n## moma %s\n\n```text\n%s\n```\n' "$command" "$("$moma" help "$command")"
  done
}

for name in keys commands; do
  page="docs/reference/$name.md"
  if [ "${1:-}" = --check ]; then
    "$name" | diff -u "$page" - || { echo "$page is not what the program says: run scripts/reference.sh" >&2; exit 1; }
  else
    "$name" > "$page.new"
    mv "$page.new" "$page"
  fi
done
