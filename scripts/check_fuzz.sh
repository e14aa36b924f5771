#!/usr/bin/env bash
# Runs every fuzz target (scripts/fuzz.sh), or those named, one after the other, and says what each came to.
# Usage: scripts/check_fuzz.sh SECONDS [TARGET...]     SECONDS: at most, for each
# With RUNS=N a target ends after N inputs as well.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -ge 1 ] || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }
seconds=$1
shift
[ $# -gt 0 ] || set -- $(sed -n 's/^ *moma_fuzz(\([a-z]*\) .*/\1/p' tests/fuzz/CMakeLists.txt)
runs=()
[ -z "${RUNS:-}" ] || runs=(-runs="$RUNS")
log=$(mktemp)
trap 'rm -f "$log"' EXIT
found=0
for target in "$@"; do
  begin=$(date +%s)
  if scripts/fuzz.sh "$target" "$seconds" "${runs[@]}" >"$log" 2>&1; then end="nothing found"; else end="FOUND SOMETHING"; found=1; fi
  printf '%-10s %9s inputs %6s s  %s\n' "$target" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" "$(($(date +%s) - begin))" "$end"
  [ "$end" = "nothing found" ] || grep -v '^#' "$log" | tail -n 60
done
exit "$found"
