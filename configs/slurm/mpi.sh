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

# --enable-recovery: the others outlive a rank that is lost. MOMA_MPIRUN_FLAGS: for instance --oversubscribe.
# shellcheck disable=SC2086
mpirun --enable-recovery ${MOMA_MPIRUN_FLAGS:-} -n "${SLURM_NTASKS:-2}" \
  "$moma" run "$suite" -o "$store" --threads "${SLURM_CPUS_PER_TASK:-1}" "$@" &
run=$!
trap 'kill -TERM "$run" 2>/dev/null || true' TERM
code=0
wait "$run" || code=$?
while kill -0 "$run" 2>/dev/null; do wait "$run" && code=0 || code=$?; done
exit "$code"
