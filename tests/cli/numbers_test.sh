#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs that fail numerically: exit code 3, what they say and what they keep.
. "$(dirname "$0")/lib.sh"

expect 3 run "$hopper" --set "step=20 ms" -o refused
out_empty
err_has "above the largest stable step" "--force"
absent refused

tells 3 "dt = 0.02 s" run "$hopper" --set "step=20 ms" --set seconds=60 --force --json -o kept
err_has "t = " "node '"
out_has '"status":	"diverged"' '"wall_time":'
files kept contacts.csv energy.csv members.csv nodes.csv scene.yaml summary.json trajectory.h5
grep -q '"status":	"diverged"' kept/summary.json || fail "summary.json is not marked"
grep -q wall_time kept/summary.json && fail "summary.json knows the wall time"
[ "$(wc -l <kept/nodes.csv)" -gt 1 ] || fail "nothing was kept"
grep -q '^#' kept/nodes.csv && fail "CSV with comments"

shows 3 "Hopper: diverged" run "$hopper" --set "step=20 ms" --set seconds=60 --force

# A stiffness beyond physical sense: no step can be recommended.
yaml stiff.yaml <<'YAML'
parameters: {stiffness: 1e300}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1e-300}}
members: {s: {kind: spring, nodes: [a, b], stiffness: stiffness}}
solver: {step: 1 ms}
run: {duration: 1 s}
YAML
for stiffness in 1e300 1e-265; do
  tells 3 "check their units" run stiff.yaml --set "stiffness=$stiffness"
  ! grep -qF 'solver.step <=' err || fail "a step is recommended"
done

shows 0 "strut run rejects it" check "$hopper" --set "step=20 ms"
