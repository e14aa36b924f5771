#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test. Arguments go to ctest, for instance: scripts/test.sh -R store
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh all
if [ "$#" -eq 0 ]; then scripts/check_format.sh; fi
ctest --test-dir build --output-on-failure --no-tests=error -j "$(nproc)" "$@"
