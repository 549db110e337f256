#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Searches by several workers at once: the files of one process, byte for byte, no point computed twice, whoever
# is killed and when; and the searches that workers cannot share.
#
#   sh workers_test.sh STRUT METHOD...     cma, nsga2, multistart
. "$(dirname "$0")/lib.sh"
shift
sed 's/^  seconds: 0.5/&\n  friction: 0.3/; s/mu: 0.3/mu: friction/' "$here/hopper.yaml" >model.yaml

# study METHOD GOAL REST: a search over two numbers as METHOD.yaml.
study() {
  yaml "$1.yaml" <<END
study: hops by $1
model: model.yaml
set: {seconds: 12}
search:
  maximise: $2
  over: {stiffness: {from: 100 N/m, to: 800 N/m}, step: {from: 0.1 ms, to: 0.2 ms}}
  method: $1
  $3
keep: [velocity, cost_of_transport]
figures: {points: {kind: points, x: stiffness, y: velocity}, beside: {kind: winner}}
END
}
study cma velocity "evaluations: 48"
study nsga2 "[velocity, -cost_of_transport]" "evaluations: 48"
study multistart velocity "starts: 4
  evaluations: 8
  worst_over: {friction: [0.3, 0.2]}"

# compare METHOD DIR: the same files as those of one process; .strut-files also lists files that are gone.
compare() {
  diff -r -x .strut-files "$1-alone" "$2" >out 2>&1 || fail "$1-alone and $2 differ"
}
# work METHOD DIR K/N: a worker in the background, its process in $worker.
work() {
  "$strut" sweep "$1.yaml" -o "$2" --shard "$3" --threads 1 --json >"report-${3%/*}" 2>"err-${3%/*}" &
  worker=$!
}
# work_together METHOD DIR: three workers in the background, worker 0 as $worker and all in $workers.
work_together() {
  workers=
  for k in 1 2 0; do
    work "$1" "$2" $k/3
    workers="$workers $worker"
  done
}
# end_well PROCESS...: the workers end without a failure.
end_well() {
  for process; do
    wait "$process" || fail "worker $process ends with $?"
  done
}
# done_points METHOD DIR: how many points have rows.
done_points() {
  "$strut" sweep "$1.yaml" -o "$2" --status --json 2>/dev/null | jq .done
}
# wait_for_points METHOD DIR COUNT
wait_for_points() {
  left=600
  until [ "$(done_points "$1" "$2")" -ge "$3" ] 2>/dev/null; do
    left=$((left - 1))
    [ $left -gt 0 ] || { fail "$2 does not get $3 points"; return; }
    sleep 0.02
  done
}

for method; do
  expect 0 sweep $method.yaml -o $method-alone --quiet
  points=$(done_points $method $method-alone)

  # One worker, then three at once: each point once, and a share for each.
  expect 0 sweep $method.yaml -o $method-1 --shard 0/1 --quiet
  compare $method $method-1
  work_together $method $method-3
  end_well $workers
  compare $method $method-3
  [ "$(cat report-0 report-1 report-2 | jq -s 'map(.computed) | add')" -eq "$points" ] ||
    fail "$method: $(cat report-0 report-1 report-2 | jq .computed) computed of $points"
  for k in 0 1 2; do
    [ "$(jq .computed "report-$k")" -gt 0 ] || fail "$method: worker $k has computed nothing"
  done
  shows 0 "$method-3/table.csv: the searches are finished" sweep --merge $method-3

  # One of three is stopped with what it has claimed, then killed; the others finish.
  work_together $method $method-killed
  wait_for_points $method $method-killed 5
  kill -STOP "$worker" || fail "$method: worker 0 has ended"
  sleep 0.3
  kill -KILL "$worker"
  end_well ${workers% *}
  compare $method $method-killed

  # All are killed; the search is not finished, and one process resumes it.
  work_together $method $method-resumed
  wait_for_points $method $method-resumed 5
  kill -KILL $workers
  wait
  absent $method-resumed/table.csv
  tells 4 "the searches are not finished" sweep --merge $method-resumed
  before=$(done_points $method $method-resumed)
  work $method $method-resumed 2/4
  end_well "$worker"
  [ "$(jq .computed report-2)" -eq $((points - before)) ] || fail "$method: points were computed again"
  compare $method $method-resumed
  expect 0 sweep $method.yaml -o $method-3 --json
  [ "$(jq .computed out)" -eq 0 ] || fail "a finished search was computed again"
done

# A process that wants the file alone, and one of another study.
work cma cma-shared 0/2
wait_for_points cma cma-shared 5
kill -STOP "$worker"
tells 4 "($worker) is writing 'cma-shared/points.slots'" sweep cma.yaml -o cma-shared
tells 1 "another study" sweep cma.yaml -o cma-shared --shard 1/2 --set seconds=3
kill -KILL "$worker"
tells 1 "shards of 2 are numbered 0 to 1" sweep cma.yaml -o cma-shared --shard 2/2
tells 1 "depends on those before it" sweep cma.yaml -o cma-shared --shard 0/2 --retry

# What workers cannot share is refused by name, where the study says so.
for method in crs2 direct sbplx; do
  study $method velocity "evaluations: 10"
  expect 2 sweep $method.yaml -o no --shard 0/2
  err_has "$method.yaml:8:11: error: workers cannot share a search by '$method', which computes one point after another"
  err_has "give 'starts'"
done
sed '/method/d' sbplx.yaml >usual.yaml
tells 2 "usual.yaml:6:3: error: workers cannot share a search by 'multistart'" sweep usual.yaml -o no --emit slurm --shards 4
out_empty
absent no
edit 's/evaluations: 10/starts: 2/' crs2.yaml expect 0 sweep -o no --emit slurm --shards 2
