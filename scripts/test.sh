#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test. Arguments go to ctest, for instance: scripts/test.sh -R store
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh all
# What some tests of the Python package use (Gymnasium, notebooks, Parquet). Without it they are skipped, and say so.
if ! cmp -s python/requirements-tests.txt .venv/.installed-tests; then
  echo "test: installing the packages of python/requirements-tests.txt into .venv" >&2
  if .venv/bin/python3 -m pip install --quiet --disable-pip-version-check -r python/requirements-tests.txt; then
    cp python/requirements-tests.txt .venv/.installed-tests
  else
    echo "test: they cannot be installed: the tests that use them are skipped" >&2
  fi
fi
if [ "$#" -eq 0 ]; then scripts/check_format.sh; fi
# Stores of tests lie in memory where it has room, so that their synchronisations wait for no disk; and threads that wait for work
# leave their processor to the other tests.
if [ -z "${TMPDIR:-}" ] && [ -w /dev/shm ] && [ "$(df --output=avail -k /dev/shm | tail -n 1)" -gt 2000000 ] && ! findmnt -no OPTIONS /dev/shm | grep -q noexec; then
  export TMPDIR=/dev/shm
fi
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
# Twice as many at a time as there are processors: tests wait for locks, browsers and processes of their own.
ctest --test-dir build --output-on-failure --no-tests=error -j "$((2 * $(nproc)))" "$@"
