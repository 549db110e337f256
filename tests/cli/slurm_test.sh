#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A study through a real Slurm of its own on this machine: an array of shards of which one is killed
# half way and another runs out of time, sent again, merged; the table is that of an undisturbed run. Then a
# search by workers of which one is killed.
for program in slurmctld slurmd sbatch munged; do
  command -v $program >/dev/null || {
    echo "skipped: Slurm is not installed (no $program)"
    exit 77
  }
done
[ "$(id -u)" -eq 0 ] || {
  echo "skipped: only root can start a Slurm that runs jobs"
  exit 77
}
. "$(dirname "$0")/lib.sh"

# stop PIDFILE: ends the process that left it.
stop() {
  [ -s "$1" ] || return 0
  process=$(cat "$1")
  kill "$process" 2>/dev/null
  for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    kill -0 "$process" 2>/dev/null || return 0
    sleep 0.1
  done
  kill -KILL "$process" 2>/dev/null
}
stop_slurm() {
  scancel --user=root 2>/dev/null && sleep 0.5
  stop "$work/slurmd.pid"
  stop "$work/slurmctld.pid"
  stop "$work/munged.pid"
}
trap 'stop_slurm; finish' EXIT
trap 'exit 1' INT TERM

# A cluster of one machine, with keys, sockets, ports and state of its own.
host=$(hostname -s)
port=$((20000 + $$ % 20000))
SLURM_CONF=$work/slurm.conf
export SLURM_CONF
mkdir munge state spool
chmod 755 "$work" munge # munged insists
(umask 077 && head -c 1024 /dev/urandom >munge/key)
cat >slurm.conf <<END
ClusterName=strut
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SwitchType=switch/none
SchedulerParameters=sched_interval=1,batch_sched_delay=0
KillWait=1
ReturnToService=2
$(slurmd -C | head -n 1) NodeAddr=127.0.0.1
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
munged --force --key-file="$work/munge/key" --socket="$work/munge/socket" \
  --pid-file="$work/munged.pid" --log-file="$work/munged.log" --seed-file="$work/munge/seed" \
  >out 2>err || fail "munged does not start"
slurmctld -i -f "$SLURM_CONF" >out 2>err || fail "slurmctld does not start"
slurmd -f "$SLURM_CONF" >out 2>err || fail "slurmd does not start"

# give_up TEXT: what follows would only wait in vain.
give_up() {
  fail "$*"
  tail -n 20 out/*.log 2>/dev/null
  exit 1
}
# wait_for SECONDS WORD...: until the command succeeds.
wait_for() {
  left=$((5 * $1))
  shift
  until "$@" >/dev/null 2>&1; do
    left=$((left - 1))
    [ $left -gt 0 ] || return 1
    sleep 0.2
  done
}
is_up() { sinfo --noheader -o %t | grep -qE 'idle|mix|alloc'; }
# over JOB: nothing of the job waits or runs.
over() { [ -z "$(squeue --noheader --jobs="$1" 2>/dev/null)" ]; }
# state JOB: its state and exit code, such as "COMPLETED 0:0".
state() {
  scontrol show job "$1" |
    sed -n 's/.*JobState=\([A-Z]*\).*/\1/p; s/.*ExitCode=\([0-9:]*\).*/\1/p' | tr '\n' ' '
}
if ! wait_for 20 is_up; then
  tail -n 5 slurmctld.log slurmd.log
  echo "skipped: Slurm does not come up on this machine"
  exit 77
fi

# The study: 24 points, some of which fail, and what it is without a cluster.
mkdir "a folder" && cd "a folder" || exit 1
cp "$here/hopper.yaml" "it's a model.yaml"
yaml study.yaml <<'END'
study: hops & falls
model: it's a model.yaml
axes:
  - stiffness: {from: 100 N/m, to: 800 N/m, count: 8}
  - seconds: [200, 1e-9, 150] # long enough to be killed in between
keep: [velocity, steps]
END
expect 3 sweep study.yaml -o whole --quiet
[ -s whole/table.csv ] || give_up "no table of the whole"

# submit WORD...: runs the script; the two jobs in $shards and $table.
submit() {
  sh job.sh "$@" >"$work/out" 2>"$work/err" || fail "the script does not send itself"
  shards=$(sed -n 's/^the shards are job \([0-9]*\), .*/\1/p' "$work/out")
  table=$(sed -n 's/.*their table is job \([0-9]*\)$/\1/p' "$work/out")
  { [ -n "$shards" ] && [ -n "$table" ]; } || give_up "the script does not name its jobs"
}
# kill_task TASK: kills its strut, not its script.
kill_task() {
  for process in $(scontrol listpids "$(squeue --noheader --jobs="${shards}_$1" -o %A)" |
    awk 'NR > 1 && $1 > 0 { print $1 }'); do
    [ "$(cat "/proc/$process/comm")" != strut ] || kill -KILL "$process"
  done
}
# begun SHARD: some points of it are done, but not all.
begun() {
  "$strut" sweep study.yaml -o out --shard "$1/4" --status --json |
    jq -e '.done >= 1 and .done <= 5' >/dev/null
}

"$strut" sweep study.yaml -o out --emit slurm --shards 4 --time 10 --memory 200M >job.sh ||
  give_up "no script"
grep -q '^#SBATCH --array=0-3$' job.sh || fail "no array"
submit
wait_for 60 begun 1 || give_up "shard 1 does not begin"
kill_task 1
wait_for 60 begun 2 || give_up "shard 2 does not begin"
scancel --signal=USR1 --batch "${shards}_2" # what Slurm sends before the time is over
requeued() { [ "$(scontrol show job "${shards}_2" | grep -c 'Restarts=1')" -eq 1 ]; }
wait_for 20 requeued || give_up "shard 2 does not go back to the queue"
# Slurm would let it wait for minutes. It is hurried only when nothing of its first run is left.
waits() { [ "$(squeue --noheader --jobs="${shards}_2" -o %t)" = PD ]; }
wait_for 60 waits || give_up "shard 2 does not wait in the queue"
sleep 2
scontrol update job="${shards}_2" StartTime=now 2>/dev/null
wait_for 300 over "$shards" || give_up "the shards do not end"
wait_for 30 over "$table" || give_up "the merge does not end"
[ "$(state "${shards}_2")" = "FAILED 3:0 " ] ||
  fail "shard 2: $(state "${shards}_2"); $(tail -n 5 "out/slurm-$shards-2.log")"
grep -q 'interrupted after' "out/slurm-$shards-2.log" || fail "shard 2 was not interrupted"
[ "$(state "${shards}_1")" = "FAILED 137:0 " ] || fail "shard 1: $(state "${shards}_1")"
cp "out/slurm-$table-merge.log" "$work/out"
out_has "shard 1 lacks"
out_has_not "shard 2"
[ "$(state "$table")" = "FAILED 4:0 " ] || fail "the merge: $(state "$table")"
absent out/table.csv

submit --array=1 # only what is missing
wait_for 60 over "$shards" || give_up "the shard does not end"
wait_for 30 over "$table" || give_up "the merge does not end"
cp "out/slurm-$table-merge.log" "$work/out"
out_has "out/table.csv: 24 points of 4 shards"
same out/table.csv whole/table.csv
[ "$(state "$table")" = "FAILED 3:0 " ] || fail "the merge: $(state "$table")"

yaml search.yaml <<'END'
study: best hops
model: it's a model.yaml
set: {seconds: 150}
search: {maximise: velocity, over: {stiffness: {from: 100 N/m, to: 800 N/m}}, method: cma, evaluations: 64}
keep: [velocity]
END
expect 0 sweep search.yaml -o best-alone --quiet
"$strut" sweep search.yaml -o best --emit slurm --shards 3 --time 10 >job.sh || give_up "no script"
submit
searching() { "$strut" sweep search.yaml -o best --status --json | jq -e '.done >= 5' >/dev/null; }
wait_for 60 searching || give_up "the search does not begin"
kill_task 0
wait_for 300 over "$shards" || give_up "the search does not end"
wait_for 30 over "$table" || give_up "the last job does not end"
[ "$(state "${shards}_0")" = "FAILED 137:0 " ] || fail "worker 0: $(state "${shards}_0")"
for task in 1 2; do
  [ "$(state "${shards}_$task")" = "COMPLETED 0:0 " ] || fail "worker $task: $(state "${shards}_$task")"
done
[ "$(state "$table")" = "COMPLETED 0:0 " ] || fail "the last job: $(state "$table")"
rm best/slurm-*.log
diff -r -x .strut-files best-alone best >"$work/out" 2>&1 || fail "the workers find something else"
