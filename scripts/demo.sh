#!/usr/bin/env bash
# The main job: 100 open and 100 cluttered worlds x 2 controllers on Frankie in ODE, the summary table and the page.
# A second call finds nothing left to do. Writes results/demo.db and reports/demo.html.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh
mkdir -p results
build/moma run configs/suites/demo.yaml -o results/demo.db "$@"
build/moma report results/demo.db -o reports/demo.html
