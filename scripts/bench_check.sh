#!/usr/bin/env bash
# Whether this checkout's moma is slower than another's: same trials, in turns, processor time, ratios (bench/check.py).
# Usage: scripts/bench_check.sh BASE [OPTIONS...]   BASE: a program, or a commit, which is built below build-base/ first.
# Exit code 1 where it is slower. Options are those of bench/check.py: --rounds N, --slower PART.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -ge 1 ] || { sed -n '2,4s/^# //p' "$0" >&2; exit 2; }
base=$1
shift
[ -x build/moma ] || scripts/setup.sh moma
if [ ! -f "$base" ]; then
  commit=$(git rev-parse --verify --quiet "$base^{commit}") || { echo "bench_check: $base is neither a program nor a commit" >&2; exit 2; }
  tree=build-base/$commit
  if [ ! -x "$tree/build/moma" ]; then
    rm -rf "$tree"
    mkdir -p "$tree"
    git archive "$commit" | tar -x -C "$tree"
    # What setup.sh has fetched is fetched once; where the commit asks for other versions, setup.sh sees that and fetches them.
    for folder in .venv .deps reports/web/node_modules; do [ ! -d "$folder" ] || cp -a "$folder" "$tree/$folder"; done
    echo "bench_check: building $commit below build-base/" >&2
    "$tree/scripts/setup.sh" moma
  fi
  base=$tree/build/moma
fi
exec python3 -B bench/check.py "$base" build/moma "$@"
