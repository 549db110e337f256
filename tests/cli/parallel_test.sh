#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A study through GNU parallel: killed half way, begun again, merged; the same table as in one piece.
# shellcheck disable=SC2016  # a name with a dollar is meant
parallel --version 2>/dev/null | grep -q '^GNU parallel' || {
  echo "skipped: GNU parallel is not installed"
  exit 77
}
. "$(dirname "$0")/lib.sh"
export HOME="$work" # where GNU parallel keeps its things

mkdir "a folder" && cd "a folder" || exit 1
cp "$here/hopper.yaml" "it's a model.yaml"
cat >'study {} $HOME.yaml' <<'END'
strut: 1
study: hops & falls
model: it's a model.yaml
axes: [{stiffness: {from: 100 N/m, to: 800 N/m, count: 8}}, {seconds: [20, 1e-9, 30]}]
keep: [velocity, steps]
END
expect 3 sweep 'study {} $HOME.yaml' -o whole --quiet --set 'step=0.2 ms'
expect 0 sweep 'study {} $HOME.yaml' -o "the results" --emit parallel --shards 6 --cpus 1 \
  --set 'step=0.2 ms'
cp "$work/out" job.sh
sh -n job.sh || fail "the script is none"
absent "the results"

# Killed with all it started, as a machine that fails.
setsid sh job.sh --jobs 2 >"$work/log" 2>&1 &
job=$!
tries=200
until ls "the results/shards/"*.slots >/dev/null 2>&1; do
  tries=$((tries - 1))
  [ $tries -gt 0 ] || break
  sleep 0.05
done
# GNU parallel gives each job a process group of its own, in the session of the script
pkill -KILL -s "$job" || fail "the script did not run"
wait "$job" 2>/dev/null
absent "the results/table.csv"

# From another folder, with words for GNU parallel; some points fail, which the merge tells.
cd / || exit 1
sh "$work/a folder/job.sh" --jobs 2 --joblog "$work/joblog" >"$work/out" 2>"$work/err"
code=$?
cd "$work/a folder" || exit 1
[ "$code" -eq 3 ] || fail "exit code $code, expected 3"
out_has "24 points of 6 shards"
err_has "8 of 24 points failed"
same "the results/table.csv" whole/table.csv
[ "$(wc -l <"$work/joblog")" -eq 7 ] || fail "not a job for each shard"
sh job.sh >"$work/out" 2>"$work/err"
same "the results/table.csv" whole/table.csv

# Inside an allocation of Slurm each shard is a step of it: srun is told so, and runs it.
mkdir "$work/bin"
printf '#!/bin/sh\necho "$@" >>%s\nshift 3\nexec "$@"\n' "$work/steps" >"$work/bin/srun"
chmod +x "$work/bin/srun"
rm -r "the results"
SLURM_JOB_ID=1 SLURM_NTASKS=2 PATH=$work/bin:$PATH sh job.sh >"$work/out" 2>"$work/err"
same "the results/table.csv" whole/table.csv
[ "$(grep -c -- '--exact --nodes=1 --ntasks=1 sh .*job.sh --this-shard [0-5]' "$work/steps")" -eq 6 ] ||
  fail "not a step for each shard"

# A shard that is missing is reported.
rm "the results/shards/shard-0003-of-0006.slots"
sed 's/^last=5/last=2/' job.sh >short.sh
sh short.sh >"$work/out" 2>"$work/err"
[ $? -eq 4 ] || fail "a shard is missing"
err_has "1 of 6 shards is missing (3)"

# Wrong use.
tells 1 "--shards" sweep 'study {} $HOME.yaml' -o x --emit parallel
tells 1 "for --emit slurm" sweep 'study {} $HOME.yaml' -o x --emit parallel --shards 2 --time 1:00
expect 1 sweep 'study {} $HOME.yaml' -o x --emit pbs --shards 2
expect 1 sweep 'study {} $HOME.yaml' -o x --emit parallel --shards 0
absent x
done_testing
