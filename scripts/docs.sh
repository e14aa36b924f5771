#!/usr/bin/env bash
# The documentation as a site, in build/site, with the C++ API (by Doxygen) and the Python API: scripts/docs.sh [serve].
# A link or an anchor that leads nowhere is an error.
# MOMA_REPOSITORY=https://HOST/OWNER/NAME/blob/BRANCH: where links to sources lead; without it they are plain text.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if ! cmp -s requirements-docs.txt .venv-docs/.installed-requirements 2>/dev/null; then
  echo "docs: installing the wheels of requirements-docs.txt into .venv-docs" >&2
  rm -rf .venv-docs
  python3 -m venv .venv-docs
  .venv-docs/bin/pip install --quiet --disable-pip-version-check --no-deps -r requirements-docs.txt
  cp requirements-docs.txt .venv-docs/.installed-requirements
fi
if ! command -v doxygen >/dev/null; then
  echo "docs: doxygen is missing, which makes the pages of the C++ API: apt-get install -y --no-install-recommends doxygen" >&2
  exit 2
fi
case "${1:-build}" in
  build) NO_MKDOCS_2_WARNING=1 .venv-docs/bin/mkdocs build --strict && echo "docs: build/site/index.html" >&2 ;;
  serve) NO_MKDOCS_2_WARNING=1 exec .venv-docs/bin/mkdocs serve --strict ;;
  *) echo "usage: scripts/docs.sh [serve]" >&2; exit 2 ;;
esac
