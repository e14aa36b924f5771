#!/usr/bin/env bash
# moma's speed beside that of what a user would pick instead (bench/peers), on this machine: same work, one thread, in turns.
# Writes results/speed.json, and docs/studies/speed.md with its figure from that.
# Usage: scripts/bench.sh [OPTIONS of bench/speed.py]   e.g. --rounds 3 --parts steps
# The peers are installed once into .venv-bench-peers and .venv-bench-toolbox (bench/peers/requirements*.txt); one that cannot be is left out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

install() {  # FOLDER REQUIREMENTS
  if cmp -s "$2" "$1/.installed-requirements"; then return; fi
  echo "bench: installing the wheels of $2 into $1" >&2
  rm -rf "$1"
  python3 -m venv "$1"
  if "$1/bin/pip" install --quiet --disable-pip-version-check -r "$2"; then
    cp "$2" "$1/.installed-requirements"
  else
    echo "bench: $2 cannot be installed as a whole; its packages one by one" >&2
    while read -r package; do
      "$1/bin/pip" install --quiet --disable-pip-version-check "$package" ||
        echo "bench: $package cannot be installed: what needs it is left out" >&2
    done < <(grep -v '^[#-]' "$2")
  fi
}
install .venv-bench-peers bench/peers/requirements.txt
install .venv-bench-toolbox bench/peers/requirements-toolbox.txt
scripts/setup.sh moma moma_bench_control physics_probe
python3 -B bench/speed.py "$@"
python3 -B bench/speed_page.py
