#!/bin/sh
#SBATCH --job-name=@job@
#SBATCH --array=0-@last@
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=@cpus@
#SBATCH --time=@time@
#SBATCH --mem=@memory@
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
# Runs a study as an array of @shards@ jobs (shards), and merges their results into one table.
#
#   sh FILE                 submits both
#   sh FILE --array=2,5     the same for some shards only
#
# Further options go to sbatch; SBATCH_PARTITION, SBATCH_ACCOUNT, ... apply to both jobs. Finished
# points are not computed again, so after any failure the same command continues. A shard that
# runs out of time requeues itself.
strut=@strut@
folder=@folder@
study=@study@
results=@results@
case $0 in /*) script=$0 ;; *) script=$PWD/$0 ;; esac
cd "$folder" || exit 4

if [ -z "${SLURM_ARRAY_TASK_ID:-}" ]; then # not in the queue yet
  mkdir -p "$results" || exit 4
  shards=$(sbatch --parsable --chdir="$folder" --output="$results/slurm-%A-%a.log" \
    "$@" "$script") || exit
  table=$(sbatch --parsable --chdir="$folder" --output="$results/slurm-%j-merge.log" \
    --dependency="afterany:${shards%%;*}" --job-name=@job@-merge \
    --time=@time@ \
    <<'END'
#!/bin/sh
exec @strut@ sweep --merge @results@
END
  ) || exit
  echo "the shards are job ${shards%%;*}, their table is job ${table%%;*}"
  exit
fi

again=
"$strut" sweep "$study" -o "$results" \
  @words@ \
  --shard "slurm/@shards@" &
child=$!
trap 'again=yes; kill -TERM "$child"' USR1 # the time limit is near
trap 'kill -TERM "$child"' TERM
wait "$child"
code=$?
while kill -0 "$child" 2>/dev/null; do # a signal ended the wait, not the shard
  wait "$child"
  code=$?
done
if [ -n "$again" ] && [ "$code" -eq 130 ] &&
  [ "${SLURM_RESTART_COUNT:-0}" -lt 1000 ]; then
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
