#!/bin/bash
# Joins the shards that configs/slurm/array.sh left in a folder into FOLDER.db, and prints the hash over all results.
#
#   sbatch --dependency=afterok:JOB configs/slurm/merge.sh results/demo
#SBATCH --job-name=moma-merge
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --time=01:00:00
#SBATCH --output=moma-merge-%j.log
set -euo pipefail

results=${1:?usage: sbatch merge.sh RESULTS}
moma=${MOMA:-build/moma}
"$moma" merge "$results.db" "$results"/shard-*.db
"$moma" query "$results.db" @summary
"$moma" verify "$results.db" --fraction 0 --hash
