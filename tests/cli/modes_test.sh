#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut modes: the table, JSON, files, options and refusals.
. "$(dirname "$0")/lib.sh"

cat >frame.yaml <<'END'
strut: 1
name: Frame
groups:
  cable: {kind: cable, stiffness: 1000, mass: 0.02, damping: 0.1, force_density: 120}
  bar: {kind: bar, stiffness: 5e4, mass: 0.3, damping: 0.1, force_density: -120}
nodes: {a: [0, 0], b: [1, 0], c: [1, 1], d: [0, 1]}
members:
  ab: {group: cable, nodes: [a, b]}
  bc: {group: cable, nodes: [b, c]}
  cd: {group: cable, nodes: [c, d]}
  da: {group: cable, nodes: [d, a]}
  ac: {group: bar, nodes: [a, c]}
  bd: {group: bar, nodes: [b, d]}
END

expect 0 modes frame.yaml
err_empty
for text in "Frame: modes at" "8 coordinates, all modes computed" "rigid-body" \
  "the structure rotates freely" "19.0307 Hz" "elastic" "of the energy"; do out_has "$text"; done
expect 0 modes frame.yaml --json
err_empty
for key in '"name":	"Frame"' '"coordinates":	8' '"method":	"dense"' '"contacts":	[]' \
  '"kind":	"rigid-body"' '"shape":	{' '"damping_ratio":	null' '"at_rest":	true'; do
  out_has "$key"
done
cp out first
OMP_NUM_THREADS=1 expect 0 modes frame.yaml --json
same first out
OMP_NUM_THREADS=3 expect 0 modes frame.yaml --json
same first out
# Beyond 400 coordinates too, where the BLAS would use threads of its own.
OPENBLAS_NUM_THREADS=1 expect 0 modes "$here/../../models/parts/x-chain.yaml" --set cells=1000 --json
cp out long
for threads in 2 4; do
  OPENBLAS_NUM_THREADS=$threads expect 0 modes "$here/../../models/parts/x-chain.yaml" --set cells=1000 --json
  same long out
done
cp first out
[ "$(grep -c '"frequency"' out)" -eq 8 ] || fail "not all 8 modes"
expect 0 modes frame.yaml --count 4 --json
[ "$(grep -c '"frequency"' out)" -eq 4 ] || fail "not 4 modes"
expect 0 modes frame.yaml -o results
files results modes.json modes.csv
same results/modes.json first
[ "$(wc -l <results/modes.csv)" -eq 9 ] || fail "modes.csv has not 9 lines"

# Refusals: wrong use, a scene that is none, a shape that is none, what cannot be computed.
expect 1 modes frame.yaml --count 0
err_has "--count"
expect 1 modes frame.yaml --count many
expect 1 modes frame.yaml --at nowhere
err_has "nowhere"
expect 1 modes
err_has "missing MODEL"
sed 's/stiffness: 1000/stifness: 1000/' frame.yaml >bad.yaml
expect 2 modes bad.yaml
err_has "did you mean 'stiffness'?"
sed 's/mass: 0.02, //; s/mass: 0.3, //' frame.yaml >light.yaml
expect 2 modes light.yaml
err_has "mass"
out_empty
sed 's/, force_density: -*120//' frame.yaml | sed 's/mass: 0.02, //; s/mass: 0.3, //; s/d: \[0, 1\]/d: {position: [0, 1], mass: 1}/' |
  sed '/  bd: /d; /  cd: /d; /  da: /d' >loose.yaml
expect 3 modes loose.yaml
err_has "has no mass and can move without stiffness"
printf 'strut: 1\nnodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}}\nmembers: {m: {kind: bar, nodes: [a, b], stiffness: 1, mass: 1}}\n' >held.yaml
expect 2 modes held.yaml
err_has "no node is free to move"
cat >string.yaml <<'END'
strut: 1
nodes: {a: {position: [-1, 0], fixed: both}, b: {position: [0, 0], mass: 1}, c: {position: [1, 0], fixed: both}}
members:
  ab: {kind: cable, nodes: [a, b], stiffness: 1e13, rest_length: 1 - 1e-13}
  bc: {kind: cable, nodes: [b, c], stiffness: 1e13, rest_length: 1 - 1e-13}
END
expect 3 modes string.yaml
err_has "not to 1e-8"
err_has "condition"
out_empty

# Contacts that touch are closed; --stuck holds them along the ground.
cat >standing.yaml <<'END'
strut: 1
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1}, top: {position: [0.5, 1], mass: 1}}
members:
  ab: {kind: bar, nodes: [a, b], stiffness: 1e5}
  at: {kind: bar, nodes: [a, top], stiffness: 1e5}
  bt: {kind: bar, nodes: [b, top], stiffness: 1e5}
gravity: [0, -9.81]
ground: {stiffness: 1e5, damping: 20, nodes: [a, b]}
END
expect 0 modes standing.yaml
for text in "on a, b" "6 coordinates" "the structure moves along x" "the ground"; do out_has "$text"; done
expect 0 modes standing.yaml --stuck
out_has "4 coordinates"
grep -q rigid-body out && fail "held along the ground it has no rigid motion"

# A name that only the list of all equilibria gives.
expect 0 modes standing.yaml --at a-b-1
out_has "modes at a-b-1, on"
expect 1 modes standing.yaml --at a-b-99
err_has "unknown equilibrium 'a-b-99'"
expect 1 modes standing.yaml --at top-1
err_has "choose one of: start, drawn"
done_testing
