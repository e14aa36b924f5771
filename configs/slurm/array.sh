#!/bin/bash
# One suite over a Slurm array: every task computes a shard into a file on its own node's disk and moves it to the shared
# folder when it is done; configs/slurm/merge.sh joins them.
#
#   array=$(sbatch --parsable --array=1-16 configs/slurm/array.sh configs/suites/demo.yaml results/demo)
#   sbatch --dependency=afterok:$array configs/slurm/merge.sh results/demo
#
# Tasks that were stopped (time limit, --requeue) go on where they were: submit the same line again. Slurm sends TERM a
# minute before the limit; moma then finishes the trials in flight, saves, and exits with 3.
#SBATCH --job-name=moma-shard
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=2
#SBATCH --time=04:00:00
#SBATCH --signal=B:TERM@60
#SBATCH --output=moma-%A_%a.log
set -euo pipefail

suite=${1:?usage: sbatch --array=1-N array.sh SUITE RESULTS [OPTION...]   (options of moma run)}
results=${2:?usage: sbatch --array=1-N array.sh SUITE RESULTS [OPTION...]}
shift 2
: "${SLURM_ARRAY_TASK_ID:?start it with sbatch --array=1-N}"
if [ "$SLURM_ARRAY_TASK_MIN" != 1 ] && [ -z "${MOMA_SHARDS:-}" ]; then
  echo "the array must begin with 1; to run some tasks of it again, say how many shards there are: MOMA_SHARDS=N" >&2
  exit 2
fi
shards=${MOMA_SHARDS:-$SLURM_ARRAY_TASK_MAX}
moma=${MOMA:-build/moma}

mkdir -p "$results"
name=shard-$SLURM_ARRAY_TASK_ID-of-$shards.db
scratch=$(mktemp -d "${TMPDIR:-/tmp}/moma-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
# What an earlier attempt saved is not computed again.
if [ -f "$results/$name" ]; then cp "$results/$name" "$scratch/$name"; fi

"$moma" run "$suite" -o "$scratch/$name" --shard "$SLURM_ARRAY_TASK_ID/$shards" \
  --threads "${SLURM_CPUS_PER_TASK:-1}" "$@" &
run=$!
trap 'kill -TERM "$run" 2>/dev/null || true' TERM
code=0
wait "$run" || code=$?
# A trap ends the first wait before the program has saved.
while kill -0 "$run" 2>/dev/null; do wait "$run" && code=0 || code=$?; done
if [ -f "$scratch/$name" ]; then
  # A program that was killed leaves its newest trials in -wal, which a copy of the one file lacks.
  if [ -s "$scratch/$name-wal" ] && "$moma" merge "$scratch/whole.db" "$scratch/$name"; then
    mv "$scratch/whole.db" "$scratch/$name"
  fi
  cp "$scratch/$name" "$results/.$name.part"
  mv "$results/.$name.part" "$results/$name"
fi
exit "$code"
