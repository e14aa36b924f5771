#!/usr/bin/env bash
# What `moma completion bash` completes, asked of bash itself: completion_test.sh MOMA. Works in a folder of its own.
set -euo pipefail
moma=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir -p suites robots disturbances controllers bin
ln -s "$moma" bin/moma
PATH="$folder/bin:$PATH"
cat > suites/small.yaml <<'YAML'
robot: ../robots/arm.yaml
controllers: {mine: {method: rrmc}, other: {method: park}}
worlds: {families: {open: {}}}
simulation: {mode: kinematic, time_limit: 1}
trials: 3
YAML
cat > robots/arm.urdf <<'XML'
<robot name="arm"><link name="root"/><link name="upper"/><link name="lower"/>
  <joint name="turn" type="revolute"><parent link="root"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="9"/></joint>
  <joint name="bend" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.3 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="1" effort="9"/></joint>
</robot>
XML
echo 'urdf: arm.urdf
base: {type: fixed}
arm: {tip: lower, tool: {position: [0.3, 0, 0]}, ready: [0, 0]}
collision: {shapes: [{link: lower, shape: sphere, size: [0.05]}]}' > robots/arm.yaml
touch disturbances/noisy.yaml controllers/neo.yaml
moma run suites/small.yaml -o a.db --quiet >/dev/null

# shellcheck disable=SC1090
source <(moma completion bash)
complete -p moma | grep -q -- '-F _moma' || { echo "bash knows no completion of moma"; exit 1; }

failed=0
# expect LINE WORD...: these are what bash offers for LINE, in any order; with "..." first, these and more.
expect() {
  local line=$1 wanted word
  shift
  COMP_LINE=$line COMP_POINT=${#line} COMPREPLY=()
  _moma 2>/dev/null || true # without errexit, as at a prompt
  local offered=" ${COMPREPLY[*]-} "
  if [ "${1-}" = ... ]; then
    shift
  elif [ "${#COMPREPLY[@]}" -ne $# ]; then
    printf 'FAILED: "%s" offers %s words instead of %s:%s\n' "$line" "${#COMPREPLY[@]}" $# "$offered"
    failed=1
  fi
  for word in "$@"; do
    wanted=" $word "
    if [[ $offered != *"$wanted"* ]]; then
      printf 'FAILED: "%s" does not offer %s, but:%s\n' "$line" "$word" "$offered"
      failed=1
    fi
  done
}

expect 'moma ' ... init run tune query report help completion
expect 'moma init --fo' --force
expect 'moma ru' run
expect 'moma -' --help --version
expect 'NAME=1 moma ver' verify
expect 'moma help qu' query
expect 'moma nonsense '
expect 'moma run --sha' --shard
expect 'moma run --shard 1/2 --sha'
expect 'moma run --set a=1 --se' ... --set --seed
expect 'moma run suites/sm' suites/small.yaml
expect 'moma run --output=a' a.db
expect 'moma query a.db @su' summary # behind the @, which bash has already
expect 'moma query a.db -f ' table csv json markdown
expect 'moma query a.db --format=m' markdown
expect 'moma run suites/small.yaml --set simulation.mo' simulation.mode=
expect 'moma run suites/small.yaml --set simulation.mode=' kinematic dynamic
expect 'moma run suites/small.yaml --set controllers.m' controllers.mine. controllers.mine=
expect 'moma run suites/small.yaml --set controllers.mine.servo.posi' controllers.mine.servo.position=
expect 'moma run suites/small.yaml --set controllers.mine.method=r' rrmc
expect 'moma run suites/small.yaml --set controllers.mine=' controllers/neo.yaml
expect 'moma run suites/small.yaml --set disturbances=' disturbances/noisy.yaml
expect 'moma run suites/small.yaml --set w' worlds.
expect 'moma keys simulation.t' simulation.time_limit
expect 'moma compare a.db ' mine other
expect 'moma compare a.db mine --suite ' small
expect 'moma run a.db --rerun ' small
expect 'moma run missing.yaml --set controllers.m'
expect 'moma replay missing.db 1'
# shellcheck disable=SC2046
expect 'moma replay a.db ' $(moma query a.db "SELECT substr(trial, 1, 12) FROM v_trials WHERE outcome <> 'success'" -f csv | tail -n +2)
key=$(moma query a.db 'SELECT trial FROM v_trials LIMIT 1' -f csv | tail -n 1)
expect "moma replay a.db ${key:0:8}" "${key:0:12}"
expect "moma solve a.db ${key:0:8}" "${key:0:12}"
exit "$failed"
