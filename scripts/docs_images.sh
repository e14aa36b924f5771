#!/usr/bin/env bash
# The pictures of the report page in docs/images, from the store of the demo: scripts/docs_images.sh [MOMA]
# Runs the demo's suite first (what is stored is not computed again). Needs chromium and the page's npm packages (scripts/setup.sh).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
readonly moma=${1:-build/moma}
readonly store=results/demo.db
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$moma" run configs/suites/demo.yaml -o "$store"
"$moma" report "$store" -o "$work/demo.html"
shot() { node reports/web/screenshot.mjs "$work/demo.html" "$@"; }
shot docs/images/report.png 1280 light 900
shot docs/images/replay.png 1280 light 900 .replay 5
shot docs/images/phone.png 390 dark 844
