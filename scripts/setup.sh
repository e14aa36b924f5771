#!/usr/bin/env bash
# Installs what is missing and builds moma into build/. Idempotent: a second call takes seconds and needs no network.
# Usage: scripts/setup.sh [TARGET...]   builds these targets of CMake: `moma` (the program) unless told otherwise, `all` with tests and
#                                       benchmarks too; `none` builds nothing.
set -euo pipefail
case "${1:-}" in -*)
  sed -n '2,4s/^# //p' "$0" >&2
  exit 2
esac
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly DAQP_VERSION=0.11.0
readonly DAQP_SHA256=2f27baf18d2acca14186498e651b34e0bed455627e777d3fd8ba655e7e40f920
targets=("${@:-moma}")

say() { printf 'setup: %s\n' "$*" >&2; }

# ---- Debian packages --------------------------------------------------------------------------------------------
packages=(
  build-essential ca-certificates ccache cmake ninja-build pkg-config python3-venv python3-dev
  libode-dev libeigen3-dev liburdfdom-dev libnlopt-cxx-dev libsqlite3-dev libsqlitecpp-dev libyaml-cpp-dev
  nlohmann-json3-dev libcli11-dev libfmt-dev librandom123-dev libzstd-dev libxxhash-dev zlib1g-dev
  libmicrohttpd-dev libboost-dev
  libopenmpi-dev openmpi-bin
  libgtest-dev librapidcheck-dev libbenchmark-dev clang-format sqlite3
  liboctomap-dev libdynamicedt3d-dev   # oracles of the map's tests
  librsvg2-bin poppler-utils   # draw and read the page's figures and prints in the tests
)
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
done
# Programs that may have come from elsewhere: the package is wanted only where the command is not there.
command -v node >/dev/null || missing+=(nodejs)
command -v npm >/dev/null || missing+=(npm)
# The page's tests use the headless shell where it is: it starts and draws with less work.
command -v chromium >/dev/null || missing+=(chromium chromium-headless-shell)

if [ "${#missing[@]}" -gt 0 ]; then
  line="apt-get install -y --no-install-recommends ${missing[*]}"
  if [ "$(id -u)" -eq 0 ]; then
    run=()
  elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    run=(sudo)
  else
    say "these Debian packages are missing; install them and call this again:"
    printf '  sudo apt-get update && sudo %s\n' "$line" >&2
    exit 2
  fi
  say "installing ${#missing[@]} Debian packages: ${missing[*]}"
  mkdir -p .deps
  log=.deps/apt.log
  # shellcheck disable=SC2086
  if ! { "${run[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq &&
         "${run[@]}" env DEBIAN_FRONTEND=noninteractive $line -qq; } </dev/null >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    say "installing failed (whole log: $log); the command was: $line"
    exit 1
  fi
fi

# ---- The report page, beside the libraries ------------------------------------------------------------------------------
bundle_page() {
  if [ -f reports/web/package-lock.json ]; then
    if ! cmp -s reports/web/package-lock.json reports/web/node_modules/.installed-lock 2>/dev/null; then
      say "installing the report page's npm packages"
      (cd reports/web && npm ci --no-audit --no-fund --loglevel=error </dev/null >/dev/null)
      cp reports/web/package-lock.json reports/web/node_modules/.installed-lock
    fi
    stamp=reports/web/dist/.built
    if [ ! -f "$stamp" ] || [ -n "$(find reports/web -path reports/web/node_modules -prune -o -path reports/web/dist -prune \
        -o -type f -newer "$stamp" -print -quit)" ]; then
      say "bundling the report page"
      (cd reports/web && npm run --silent build </dev/null)
      touch "$stamp"
    fi
  fi
}
bundle_page &
page=$!

# ---- C++ libraries that PyPI carries -----------------------------------------------------------------------------
if ! cmp -s requirements.txt .venv/.installed-requirements 2>/dev/null; then
  say "installing the wheels of requirements.txt into .venv"
  rm -rf .venv
  python3 -m venv .venv
  .venv/bin/pip install --quiet --disable-pip-version-check --no-deps -r requirements.txt
  cp requirements.txt .venv/.installed-requirements
fi

if [ ! -f ".deps/daqp-$DAQP_VERSION/csrc/include/api.h" ]; then
  say "fetching the sources of DAQP $DAQP_VERSION"
  rm -rf .deps/download && mkdir -p .deps/download
  .venv/bin/pip download --quiet --disable-pip-version-check --no-deps --no-binary daqp "daqp==$DAQP_VERSION" \
    -d .deps/download
  archive=".deps/download/daqp-$DAQP_VERSION.tar.gz"
  echo "$DAQP_SHA256  $archive" | sha256sum --check --quiet - || {
    say "the checksum of $archive is not the expected $DAQP_SHA256: not used"
    exit 1
  }
  tar -xzf "$archive" -C .deps
  rm -rf .deps/download
fi

wait "$page"

# ---- moma ------------------------------------------------------------------------------------------------------------
if [ "${targets[0]}" != none ]; then
  # Sources are compiled several at once, which takes half of the time; CONTRIBUTING.md says how to compile them one by one.
  [ -f build/build.ninja ] || cmake --preset release -DCMAKE_UNITY_BUILD=ON >/dev/null
  say "building ${targets[*]} into build/"
  cmake --build build --target "${targets[@]}" -- --quiet
fi
