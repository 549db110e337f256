#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut modes: the table, JSON, files, options and refusals.
. "$(dirname "$0")/lib.sh"

frame frame.yaml 'stiffness: 1000, mass: 0.02, damping: 0.1, force_density: 120' \
  'stiffness: 5e4, mass: 0.3, damping: 0.1, force_density: -120'

expect 0 modes frame.yaml
err_empty
for text in "modes at " "coordinates       8" "rigid-body" \
  "the structure rotates freely" "19.0307 Hz" "elastic" "of the energy"; do out_has "$text"; done
# In LaTeX each line of a table has as many cells as its columns.
sed 's/^name: .*/name: "Two\\nlines"/' frame.yaml >two.yaml
expect 0 modes two.yaml --format latex
out_has '\begin{tabular}{rrrrll}' '\hline' ' \% of the energy' '% modes' '% Two' '% lines'
awk '/begin.tabular/ { sub(/.*tabular}{/, ""); n = length($0) - 1 }
     / & / && gsub(/ & /, "") != n - 1 { print; bad = 1 }
     END { exit bad }' out || fail "a line has other cells than its table"
tells 1 "--format expects text or latex" modes frame.yaml --format tex
expect 0 modes frame.yaml --json
err_empty
out_has '"name":	"Frame"' '"coordinates":	8' '"method":	"dense"' '"contacts":	[]' '"kind":	"rigid-body"' '"shape":	{' \
  '"damping_ratio":	null' '"at_rest":	true'
cp out first
for threads in 1 3; do
  OMP_NUM_THREADS=$threads expect 0 modes frame.yaml --json
  same first out
done
# Beyond 400 coordinates too, where the BLAS would use threads of its own.
OPENBLAS_NUM_THREADS=1 expect 0 modes "$models/parts/x-chain.yaml" --set cells=1000 --json
cp out long
for threads in 2 4; do
  OPENBLAS_NUM_THREADS=$threads expect 0 modes "$models/parts/x-chain.yaml" --set cells=1000 --json
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

# Refusals: wrong use, a scene that is none, a shape that is none; what cannot be known.
tells 1 "--count" modes frame.yaml --count 0
expect 1 modes frame.yaml --count many
tells 1 "nowhere" modes frame.yaml --at nowhere
tells 1 "missing MODEL" modes
edit 's/stiffness: 1000/stifness: 1000/' frame.yaml tells 2 "did you mean 'stiffness'?" modes
edit 's/mass: 0.02, //; s/mass: 0.3, //' frame.yaml refuses 2 "mass" modes
sed 's/, force_density: -*120//' frame.yaml | sed 's/mass: 0.02, //; s/mass: 0.3, //; s/d: \[0, 1\]/d: {position: [0, 1], mass: 1}/' |
  sed '/  bd: /d; /  cd: /d; /  da: /d' >loose.yaml
tells 3 "has no mass and can move without stiffness" modes loose.yaml
printf 'strut: 1\nnodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}}\nmembers: {m: {kind: bar, nodes: [a, b], stiffness: 1, mass: 1}}\n' >held.yaml
tells 2 "no node is free to move" modes held.yaml
yaml string.yaml <<'END'
nodes: {a: {position: [-1, 0], fixed: both}, b: {position: [0, 0], mass: 1}, c: {position: [1, 0], fixed: both}}
members: {ab: {kind: cable, nodes: [a, b], stiffness: 1e13, rest_length: 1 - 1e-13},
          bc: {kind: cable, nodes: [b, c], stiffness: 1e13, rest_length: 1 - 1e-13}}
END
shows 0 "unknown" modes string.yaml
out_has "rounding hides its frequency, about 0.225 Hz"
shows 0 '"kind":	"unknown"' modes string.yaml --json
near '[.modes[] | select(.frequency == null and .eigenvalue == null and .error > 1e-8)] | length' 1 0

# Cables that are just taut pull one way only: they count as slack, whatever their last bits, and this is said.
# Of the arch of N wedges 2 N bars remain for 4 (N - 1) coordinates.
arch=$models/parts/arch.yaml
for cells in 8 16 23; do
  gives '[.modes[] | select(.kind == "mechanism" and .frequency == 0)] | length' "2 * $cells - 4" 0 modes "$arch" --set cells=$cells
  near '[.modes[] | select(.frequency > 0) | .frequency] | min | if . > 1 then 1 else 0 end' 1 0
  near '.just_taut | length' "3 * $cells + 1" 0
done
shows 0 "just taut, without prestress  foot, " modes "$arch" --set cells=16 --count 1
out_has "members are just taut"
shows 0 "without force                            foot, " rigidity "$arch" --set cells=16
tells 3 "396 modes have no stiffness" modes "$arch" --set cells=200 --count 4
# Two ropes as one running cable, and a spring that only pulls, likewise.
yaml vee.yaml <<'END'
nodes: {a: {position: [-1, 1], fixed: both}, b: {position: [1, 1], fixed: both}, c: {position: [0, 0], mass: 1}}
members: {l: {kind: cable, nodes: [a, b, c], stiffness: 100}, r: {kind: spring, law: tension_only, nodes: [b, c], stiffness: 100}}
END
gives '[.modes[] | select(.frequency == 0)] | length' 2 0 modes vee.yaml
near '.just_taut | length' 2 0
# Loads decide it, even where a cable's stretch is below the last bit of its length.
yaml hang.yaml <<'END'
gravity: [0, -10]
parameters: {k: 1e3}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -1], mass: 1}}
members: {s: {kind: cable, nodes: [a, b], stiffness: k, rest_length: 1}}
END
for k in 1e12 1e16 3e16; do
  gives '.just_taut | length' 0 0 modes hang.yaml --set k=$k
  near '.modes[0].angular_frequency' '10 | sqrt' 1e-10
done

# Contacts that touch are closed; --stuck holds them along the ground.
yaml standing.yaml <<'END'
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1}, top: {position: [0.5, 1], mass: 1}}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 1e5}, at: {kind: bar, nodes: [a, top], stiffness: 1e5},
          bt: {kind: bar, nodes: [b, top], stiffness: 1e5}}
gravity: [0, -9.81]
ground: {stiffness: 1e5, damping: 20, nodes: [a, b]}
END
expect 0 modes standing.yaml
for text in "  a, b" "  6" "the structure moves along x" "the ground"; do out_has "$text"; done
shows 0 "coordinates       4" modes standing.yaml --stuck
grep -q rigid-body out && fail "held along the ground it has no rigid motion"

# A name that only the list of all equilibria gives.
shows 0 "modes at          a-b-1" modes standing.yaml --at a-b-1
tells 1 "unknown equilibrium 'a-b-99'" modes standing.yaml --at a-b-99
tells 1 "choose one of: start, drawn" modes standing.yaml --at top-1
