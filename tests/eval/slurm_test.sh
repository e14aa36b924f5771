#!/bin/bash
# The job scripts of configs/slurm on a real Slurm: one node, its daemons started here and ended by their pid files.
#   slurm_test.sh MOMA SOURCE_DIR
# Exits with 77 (skipped) where Slurm cannot be started: not installed, or not root.
set -euo pipefail
moma=$1
source=$2

skip() { echo "skipped: $*"; exit 77; }
for program in munged slurmctld slurmd sbatch sinfo squeue runuser; do
  command -v "$program" >/dev/null || PATH=$PATH:/usr/sbin:/sbin
  command -v "$program" >/dev/null || skip "there is no $program (Debian: slurm-wlm, munge)"
done
[ "$(id -u)" -eq 0 ] || skip "only root can start slurmd here"

work=$(mktemp -d /tmp/moma-slurm-XXXXXX)
munged_started=no
finish() {
  for file in "$work"/slurmd.pid "$work"/slurmctld.pid; do
    if [ -f "$file" ]; then kill "$(cat "$file")" 2>/dev/null || true; fi
  done
  if [ "$munged_started" = yes ] && [ -f "$work/munged.pid" ]; then kill "$(cat "$work/munged.pid")" 2>/dev/null || true; fi
  sleep 0.5
  rm -rf "$work"
}
trap finish EXIT

host=$(hostname -s)
port=$((20000 + $$ % 5000 * 2))  # not Slurm's own, and another one than a test's that was killed
mkdir -p "$work"/state "$work"/spool
# A munged of the test's own, with its own key and socket.
mkdir -m 755 "$work/munge"
dd if=/dev/urandom of="$work/munge/key" bs=64 count=1 status=none
chmod 400 "$work/munge/key"
chown -R munge "$work/munge" 2>/dev/null || skip "there is no user munge"
chmod 755 "$work"
runuser -u munge -- munged --force --key-file="$work/munge/key" --socket="$work/munge/socket" \
  --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" || skip "munged does not start"
munged_started=yes
cp "$work/munge/pid" "$work/munged.pid"

cat >"$work/slurm.conf" <<CONF
ClusterName=momatest
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
SlurmctldPort=$port
SlurmdPort=$((port + 1))
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SchedulerParameters=sched_interval=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
slurmctld || skip "slurmctld does not start"
slurmd || skip "slurmd does not start"
for _ in $(seq 100); do
  if sinfo -h -o %T 2>/dev/null | grep -qx idle; then break; fi
  sleep 0.3
done
sinfo -h -o %T 2>/dev/null | grep -qx idle || skip "the node does not become idle: $(tail -n 3 "$work/slurmctld.log")"

# A small suite, as a user would submit it.
cd "$work"
export MOMA=$moma TMPDIR=$work
suite=$source/configs/suites/prototype-kinematic.yaml
options=(--trials 6 --set simulation.time_limit=4 --quiet)
"$moma" run "$suite" -o whole.db "${options[@]}" >/dev/null
hash_of() { "$moma" verify "$1" --fraction 0 --hash --quiet | sed -n 's/^results //p'; }
whole=$(hash_of whole.db)

wait_for() {
  for _ in $(seq 600); do
    if [ -z "$(squeue -h -j "$1" 2>/dev/null)" ]; then return; fi
    sleep 0.3
  done
  echo "job $1 does not end"
  cat "$work"/*.log
  exit 1
}

array=$(sbatch --parsable --cpus-per-task=1 --array=1-3 "$source/configs/slurm/array.sh" "$suite" "$work/shards" "${options[@]}")
merge=$(sbatch --parsable --dependency="afterok:$array" "$source/configs/slurm/merge.sh" "$work/shards")
wait_for "$array"
wait_for "$merge"
[ -f shards.db ] || { echo "the array left no merged store:"; cat moma-*.log; exit 1; }
[ "$(hash_of shards.db)" = "$whole" ] || { echo "array and merge: another hash than one process"; exit 1; }
echo "array of 3 tasks and merge: $whole"

if command -v mpirun >/dev/null; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 MOMA_MPIRUN_FLAGS=--oversubscribe
  mpi=$(sbatch --parsable --ntasks=2 "$source/configs/slurm/mpi.sh" "$suite" "$work/mpi.db" "${options[@]}")
  wait_for "$mpi"
  if grep -q "built without MPI" moma-mpi-*.log; then
    echo "MPI: skipped, this moma was built without it"
  else
    [ -f mpi.db ] || { echo "the MPI job left no store:"; cat moma-mpi-*.log; exit 1; }
    [ "$(hash_of mpi.db)" = "$whole" ] || { echo "MPI: another hash than one process"; cat moma-mpi-*.log; exit 1; }
    echo "MPI job of 2 ranks: $whole"
    # A job that could not begin must not count as done.
    wrong=$(sbatch --parsable --ntasks=2 "$source/configs/slurm/mpi.sh" "$work/missing.yaml" "$work/mpi.db")
    wait_for "$wrong"
    state=$(scontrol show job "$wrong" | tr ' ' '\n' | grep '^ExitCode=')
    [ "$state" = "ExitCode=2:0" ] || { echo "MPI job with bad input: $state"; cat "moma-mpi-$wrong.log"; exit 1; }
  fi
else
  echo "MPI: skipped, there is no mpirun"
fi
