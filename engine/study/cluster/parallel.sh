#!/bin/sh
# Runs a study in @shards@ shards with GNU parallel, and merges their results into one table.
#
#   sh FILE                     on this machine
#   sh FILE --sshlogin one,two  on machines that share this folder
#
# In a Slurm job of several tasks each shard is a step of the job. Further options go to GNU
# parallel. Finished points are not computed again: after any failure the same command continues.
strut=@strut@
folder=@folder@
study=@study@
results=@results@
cpus=@cpus@
last=@last@
case $0 in /*) script=$0 ;; *) script=$PWD/$0 ;; esac
cd "$folder" || exit 4

# The script calls itself for each shard, so that no other shell has to quote the paths.
if [ "${1:-}" = --this-shard ]; then
  exec "$strut" sweep "$study" -o "$results" --threads "$cpus" --quiet \
    @words@ \
    --shard "$2/@shards@"
fi

parallel --version 2>/dev/null | grep -q '^GNU parallel' || {
  echo 'GNU parallel is not installed (the package parallel)' >&2
  exit 4
}
mkdir -p "$results" || exit 4
if [ -n "${SLURM_JOB_ID:-}" ] && [ "${SLURM_NTASKS:-1}" -gt 1 ]; then
  jobs=$SLURM_NTASKS
  step='srun --exact --nodes=1 --ntasks=1'
else
  jobs=$(($(nproc) / cpus))
  [ "$jobs" -gt 0 ] || jobs=1
  step=
fi
# shellcheck disable=SC2046,SC2086  # several words are meant
parallel --will-cite --quote --jobs "$jobs" "$@" \
  $step sh "$script" --this-shard {} ::: $(seq 0 "$last") </dev/null
exec "$strut" sweep --merge "$results" # reports missing shards and points
