#!/bin/sh
# Runs a study as @shards@ jobs (shards) of HTCondor, and merges their results into one table.
#
#   sh FILE                 submits all
#   sh FILE -maxjobs 10     the same with further options of condor_submit_dag
#
# The machines share this folder with the one that submits. Finished points are not computed again,
# so after any failure, and after a machine was wanted back, the same shard continues.
strut=@strut@
folder=@folder@
study=@study@
results=@results@
cpus=@cpus@
case $0 in /*) script=$0 ;; *) script=$PWD/$0 ;; esac
cd "$folder" || exit 4

# The jobs call this script, so that only its own path has to be quoted for HTCondor.
case ${1:-} in
  --this-shard)
    "$strut" sweep "$study" -o "$results" --threads "$cpus" --quiet \
      @words@ \
      --shard "$2/@shards@" &
    child=$!
    trap 'kill -TERM "$child"' TERM # the machine is wanted back
    wait "$child"
    code=$?
    while kill -0 "$child" 2>/dev/null; do # a signal ended the wait, not the shard
      wait "$child"
      code=$?
    done
    [ "$code" -ne 3 ] || code=0 # points that failed are rows of the table; the merge tells
    exit "$code"
    ;;
  --merge) exec "$strut" sweep --merge "$results" ;;
esac

mkdir -p "$results/condor" || exit 4
cd "$results/condor" || exit 4
quoted=$(printf '%s\n' "$script" | sed "s/'/''/g; s/\"/\"\"/g")
cat >shards.sub <<END
universe = vanilla
executable = /bin/sh
transfer_executable = false
should_transfer_files = NO
arguments = "'$quoted' --this-shard \$(Process)"
batch_name = @job@
request_cpus = @cpus@
request_memory = @memory@
kill_sig = SIGTERM
job_max_vacate_time = 120
max_retries = 3
log = shards.log
output = shard-\$(Process).out
error = shard-\$(Process).err
queue @shards@
END
cat >table.sub <<END
universe = local
executable = /bin/sh
transfer_executable = false
arguments = "'$quoted' --merge"
batch_name = @job@-merge
log = table.log
output = table.out
error = table.err
queue
END
cat >study.dag <<'END'
JOB shards shards.sub
FINAL table table.sub
END
exec condor_submit_dag -f "$@" study.dag
