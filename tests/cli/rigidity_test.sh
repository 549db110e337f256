#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut rigidity: the table, the JSON, files, shapes, and what is refused.
. "$(dirname "$0")/lib.sh"

frame x.yaml 'stiffness: 100 N/m, force_density: 5 N/m' 'stiffness: 1000 N/m, force_density: -5 N/m'
expect 0 rigidity x.yaml
err_empty
out_has "self stress s                            1" "mechanisms rigid body                    3" \
  "Maxwell-Calladine members - coordinates  -2" "yes, by the self-stress state"
out_has "structure with tensegrity features of class 2"
expect 0 rigidity x.yaml --json
for text in '"rank":	5' '"method":	"svd"' '"rigid_body":	3' '"super_stable":	true' '"equilibrium":	true' \
  '"class":	1' '"ac":	-1.4142135623730'; do out_has "$text"; done
cp out printed
expect 0 rigidity x.yaml --json -o results
same printed results/rigidity.json
files results rigidity.json
expect 0 rigidity x.yaml --at drawn

cp x.yaml piped.yaml
"$strut" rigidity - --json <piped.yaml >out 2>err || fail "from the standard input"
same printed out

# Refused: an unknown shape, an unknown option, a scene that is none, a directory that cannot be.
refuses 1 "nowhere" rigidity x.yaml --at nowhere
tells 1 "--accuracy cannot be used here: equilibria are computed to rounding errors" rigidity x.yaml --accuracy 1%
edit 's/kind: bar/kind: rod/' x.yaml tells 2 "rod" rigidity
echo text >taken
tells 4 "taken" rigidity x.yaml -o taken

# A four-bar linkage moves, and says how far it was followed.
grep -v 'ac:\|bd:\|bar' x.yaml | sed 's/force_density: 5 N.m},/rest_length_ratio: 1}}/' >loop.yaml
shows 0 "mechanisms finite                        1" rigidity loop.yaml
out_has "lengths constant within"

# Nodes alone, all held: an answer, not a failure.
printf 'strut: 1\nnodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1}}\n' >nodes.yaml
shows 0 "mechanisms finite                        1" rigidity nodes.yaml
printf 'strut: 1\nnodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}}\nmembers: {m: {kind: bar, nodes: [a, b], stiffness: 1}}\n' >held.yaml
shows 0 "self stress s                            1" rigidity held.yaml
out_has "mechanisms f                             0"

# At an equilibrium by its name: the crawler lies on the ground, its forces balance there.
shows 0 '"at":	"I"' rigidity "$crawler" --at I --json
out_has '"equilibrium":	true' '"rank":	7'
tells 1 "IV" rigidity "$crawler" --at IV
# More states than are listed have no table.
shows 0 "self stress s                            400" rigidity "$here/../bench/chain.yaml" --set cells=400
finds '.self_stress | .count == 400 and .states == null' rigidity "$here/../bench/chain.yaml" --set cells=400
