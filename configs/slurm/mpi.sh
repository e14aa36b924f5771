#!/bin/bash
# One suite over the ranks of one MPI job: rank 0 hands out trials and writes the only store.
#
#   sbatch --ntasks=64 configs/slurm/mpi.sh configs/suites/demo.yaml results/demo.db
#
# The store should lie on a disk of rank 0's node; where it is on a network file system, moma warns. Slurm sends TERM a
# minute before the limit; the same line submitted again goes on.
#SBATCH --job-name=moma-mpi
#SBATCH --ntasks=2
#SBATCH --cpus-per-task=1
#SBATCH --time=04:00:00
#SBATCH --signal=B:TERM@60
#SBATCH --output=moma-mpi-%j.log
set -euo pipefail

suite=${1:?usage: sbatch --ntasks=N mpi.sh SUITE STORE [OPTION...]   (options of moma run)}
store=${2:?usage: sbatch --ntasks=N mpi.sh SUITE STORE [OPTION...]}
shift 2
moma=${MOMA:-build/moma}

# How the run ended is asked of the store: mpirun --enable-recovery exits with 0 whatever its ranks exited with.
ask() {
  if [ -s "$store" ]; then "$moma" query "$store" "$1" --format csv | tail -n 1; fi
}
before=$(ask "SELECT ifnull(max(id), 0) FROM invocation")

# --enable-recovery: the others outlive a rank that is lost. MOMA_MPIRUN_FLAGS: for instance --oversubscribe.
# shellcheck disable=SC2086
mpirun --enable-recovery ${MOMA_MPIRUN_FLAGS:-} -n "${SLURM_NTASKS:-2}" \
  "$moma" run "$suite" -o "$store" --threads "${SLURM_CPUS_PER_TASK:-1}" "$@" &
run=$!
trap 'kill -TERM "$run" 2>/dev/null || true' TERM
code=0
wait "$run" || code=$?
while kill -0 "$run" 2>/dev/null; do wait "$run" && code=0 || code=$?; done
if [ "$code" -eq 0 ]; then
  case $(ask "SELECT status FROM invocation WHERE id > ${before:-0} ORDER BY id DESC LIMIT 1") in
    finished) ;;
    stopped) code=3 ;;
    running | failed) code=1 ;;
    *) code=2 ;;  # it never began: bad input, as the log says
  esac
fi
exit "$code"
