#!/usr/bin/env bash
# The packages of the peers, into .venv-peers and .venv-toolbox of the checkout, where configs/suites/peers.yaml looks for them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$here/../.."
install() {  # FOLDER REQUIREMENTS
  python3 -m venv "$1"
  "$1/bin/python3" -m pip install --quiet --disable-pip-version-check -r "$2"
}
install .venv-peers "$here/requirements.txt"
install .venv-toolbox "$here/requirements-toolbox.txt"
