#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A study in shards, merged, and the script for a cluster.
. "$(dirname "$0")/lib.sh"
cp "$here/hopper.yaml" model.yaml
yaml study.yaml <<'END'
study: hops
model: model.yaml
set: {seconds: 10 ms}
axes:
  - stiffness: {from: 100 N/m, to: 800 N/m, count: 9}
  - friction: [1, 2]
keep: [velocity, steps]
END
sed -i 's/^  seconds: 0.5/&\n  friction: 1/; s/mu: 0.3/mu: 0.3*friction/' model.yaml
expect 0 sweep study.yaml -o whole --quiet
[ "$(wc -l <whole/table.csv)" -eq 19 ] || fail "not a row for each point"

# In any order, each twice; more shards than points; all tables are the same.
for count in 1 2 5 20; do
  shard=$((count - 1))
  while [ $shard -ge 0 ]; do
    expect 0 sweep study.yaml -o "in-$count" --shard "$shard/$count" --quiet
    shard=$((shard - 1))
  done
  shows 0 "computed  0" sweep study.yaml -o "in-$count" --shard "0/$count"
  absent "in-$count/table.csv"
  shows 0 "in-$count/table.csv: 18 points of $count shards" sweep --merge "in-$count"
  same "in-$count/table.csv" whole/table.csv
done
rm whole/table.csv
expect 0 sweep --merge whole --quiet
out_empty
same in-5/table.csv whole/table.csv

# What is wrong is said.
tells 1 "is divided into 5 shards, not 4" sweep study.yaml -o in-5 --shard 1/4
tells 1 "holds 5 shards of the study" sweep study.yaml -o in-5
tells 1 "another study" sweep study.yaml -o in-5 --shard 0/5 --set seconds=0.02
tells 1 "numbered 0 to 4" sweep study.yaml -o new --shard 5/5
tells 1 "not a task of a Slurm job array" sweep study.yaml -o new --shard slurm/5
absent new
rm in-5/shards/shard-0001-of-0005.slots in-5/shards/shard-0003-of-0005.slots
rm in-5/table.csv
tells 4 "2 of 5 shards are missing (1, 3)" sweep --merge in-5
absent in-5/table.csv
shows 0 "0       4     4        0       0" sweep study.yaml -o in-5 --status
expect 0 sweep study.yaml -o in-5 --status --json
jq -e '.shard_count == 5 and .shards[1] == {"shard": 1, "done": 0} and
  .shards[4] == {"shard": 4, "points": 3, "done": 3, "missing": 0, "failed": 0}' out >/dev/null || fail "the status"
expect 0 sweep study.yaml -o in-5 --shard 1/5 --quiet --set seconds=0.02
tells 1 "shards 0 and 1 belong to different studies, which differ in the model" sweep --merge in-5
expect 4 sweep --merge nowhere
expect 1 sweep --merge

# A task of an array.
SLURM_ARRAY_TASK_ID=3 "$strut" sweep study.yaml -o in-5 --shard slurm/5 --quiet >out 2>err ||
  fail "a task of Slurm"
[ -s in-5/shards/shard-0003-of-0005.slots ] || fail "not the task's shard"

# Other systems: the variable of each, counted from where the system begins.
shard=0
for pair in pbs:PBS_ARRAY_INDEX=0 torque:PBS_ARRAYID=1 lsf:LSB_JOBINDEX=3 sge:SGE_TASK_ID=4 \
  kubernetes:JOB_COMPLETION_INDEX=4 env:MINE:MINE=5; do
  env "${pair##*:}" "$strut" sweep study.yaml -o in-6 --shard "${pair%:*}/6" --quiet >out 2>err ||
    fail "a task of $pair"
  [ -s "in-6/shards/shard-000$shard-of-0006.slots" ] || fail "$pair is not shard $shard"
  shard=$((shard + 1))
done
refused() { # WORD SHARD TEXT: with that variable, this shard is refused and says so
  env "$1" "$strut" sweep study.yaml -o in-6 --shard "$2" --quiet >out 2>err
  code=$?
  [ "$code" -eq 1 ] || fail "$1 --shard $2: exit code $code"
  err_has "$3"
}
refused NOTHING=1 lsf/6 'lsf/6: this is not a task of an LSF job array (LSB_JOBINDEX is not set): bsub -J "NAME[1-N]"'
refused LSB_JOBINDEX=0 lsf/6 "LSB_JOBINDEX is '0', expected a number from 1"
refused SGE_TASK_ID=undefined sge/6 "SGE_TASK_ID is 'undefined'"
refused SGE_TASK_ID=7 sge/6 "shards of 6 are numbered 0 to 5"
refused PBS_ARRAY_INDEX=1 pbs "give the number of shards: pbs/N"
refused PBS_ARRAY_INDEX=-1 pbs/6 "PBS_ARRAY_INDEX is '-1'"
refused MINE=1 env:/6 "expected env:VARIABLE/N"
refused MINE=1 env:OTHER/6 "OTHER is not set"
refused MINE=1 oar/6 "kubernetes and env:VARIABLE with /N, not 'oar/6'"

# The script: a shell can read it, and texts arrive as they were given.
expect 0 sweep study.yaml -o "it's here" --emit slurm --shards 7 --cpus 3 --time 1-02:00:00 \
  --memory 1500M --set 'seconds=0.02'
for line in --array=0-6 --cpus-per-task=3 --time=1-02:00:00 --mem=1500M --job-name=hops; do
  grep -qx -- "#SBATCH $line" out || fail "the script lacks $line"
done
sh -n out || fail "the script is none"
absent "it's here"
if command -v shellcheck >/dev/null; then
  shellcheck "$here"/../../engine/study/cluster/*.sh || fail "shellcheck objects to a template"
  "$strut" sweep study.yaml -o "it's here" --emit slurm --shards 7 >slurm.sh
  grep -q '@[a-z]*@' slurm.sh && fail "a placeholder is left in slurm.sh"
  shellcheck slurm.sh || fail "shellcheck objects to slurm.sh"
fi
mkdir bin
printf '#!/bin/sh\nprintf "%%s\\n" "$@" >>%s\necho 12\n' "$work/sent" >bin/sbatch
chmod +x bin/sbatch
cp out job.sh
PATH=$work/bin:$PATH sh job.sh --array=2,5 >out 2>err || fail "the script fails"
out_has "the shards are job 12, their table is job 12"
for word in "--array=2,5" "--dependency=afterany:12" "--output=it's here/slurm-%A-%a.log"; do
  grep -qxF -- "$word" sent || fail "sbatch was not told $word"
done
(SLURM_ARRAY_TASK_ID=6 sh job.sh) >out 2>err || fail "a task of the script fails"
[ -s "it's here/shards/shard-0006-of-0007.slots" ] || fail "the script computes nothing"
for wrong in "--time soon" "--memory much" "--shards 0" "--cpus 0"; do
  expect 1 sweep study.yaml -o x --emit slurm --shards 7 $wrong
done
tells 1 "--shards" sweep study.yaml -o x --emit slurm
expect 1 sweep study.yaml -o x --emit pbs --shards 3
