#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut path: the curve, its events, its files, and what it refuses.
. "$(dirname "$0")/lib.sh"

cat >arch.yaml <<'END'
strut: 1
name: Arch
parameters: {side: 0}
nodes:
  left: {position: [-1, 0], fixed: both}
  right: {position: [1, 0], fixed: both}
  top: [0, 0.3]
members:
  a: {kind: bar, nodes: [left, top], stiffness: 1000}
  b: {kind: bar, nodes: [right, top], stiffness: 1000}
loads:
  weight: {node: top, force: [0, -1]}
  wind: {node: top, force: [side, 0]}
END

# The limit load in closed form: 9.94991696 at a height of 0.17071165.
expect 0 path arch.yaml --load weight --until 12
out_has "limit point: the factor can grow no further here"
out_has "9.949917"
expect 0 path arch.yaml --load weight --until 12 --json -o curve
jq -e '.load == "weight" and .end == "until" and (.events | length) == 2 and
  .events[0].kind == "limit point" and (.events[0].factor - 9.94991696 | fabs) < 5e-9 and
  (.events[0].nodes.top[1] - 0.17071165 | fabs) < 5e-9 and
  .points[0].factor == 0 and .points[0].stable and .points[-1].factor == 12 and
  ([.points[] | select(.stable | not)] | length) > 10 and
  ([.points[].arc] | . == sort)' "$work/out" >jq.out || fail "the path in JSON"
files curve path.csv path.json
same curve/path.json "$work/out"
head -n 1 curve/path.csv | grep -qF 'negative_eigenvalues,event,left.x [m],left.y [m],' || fail "header"
[ "$(grep -c 'limit point' curve/path.csv)" -eq 2 ] || fail "events in the table"
expect 0 path arch.yaml --load weight --until 12 --json
same curve/path.json "$work/out"
expect 0 path arch.yaml --load weight --until 12 --steps 5
out_has "5 steps led to the factor"
expect 0 path arch.yaml --load weight --until -3
out_has "stable"

# A load that nothing resists, one that is not there, one that does nothing.
expect 1 path arch.yaml --load wait
err_has "there is no load 'wait'; the scene's loads are: weight, wind"
expect 1 path arch.yaml --load wind
err_has "acts on nothing that can move"
expect 1 path arch.yaml --until "3 N"
err_has "--until expects"
expect 1 path arch.yaml --steps 0
err_has "a whole number from 1 to"
sed '/right: {pos/s/, fixed: both//; s/left: {position: \[-1, 0\], fixed: both}/left: [-1, 0]/' \
  arch.yaml >loose.yaml
expect 3 path loose.yaml --load weight
err_has "nothing holds the structure"
sed '/^loads/,$d; /^parameters/d' arch.yaml >idle.yaml
expect 1 path idle.yaml
err_has "no constant load"
# Stiffnesses that span twelve decades do not make a held chain one that moves as a whole.
cat >chain.yaml <<'END'
strut: 1
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y},
        c: {position: [2, 0], fixed: y}, d: {position: [3, 0], fixed: y}}
members:
  ab: {kind: spring, nodes: [a, b], stiffness: 1}
  bc: {kind: spring, nodes: [b, c], stiffness: 1e12}
  cd: {kind: spring, nodes: [c, d], stiffness: 1}
loads: {tip: {node: d, force: [1, 0]}}
END
expect 0 path chain.yaml
out_has "2 m             0 m  stable"
done_testing
