#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut form: what it writes stands still when it is run; what it refuses, and how.
. "$(dirname "$0")/lib.sh"

# drift FILE: farthest that a coordinate in nodes.csv goes from its first value.
drift() {
  awk -F, 'NR == 2 { for (i = 2; i <= NF; i++) first[i] = $i }
    NR > 1 { for (i = 2; i <= NF; i++) { d = $i - first[i]; if (d < 0) d = -d; if (d > most) most = d } }
    END { printf "%.3g\n", most }' "$1"
}

# stays MODEL SIZE OPTION...: the form found, run for 10 s, stays within 1e-9 of its size.
stays() {
  model=$1
  size=$2
  shift 2
  shows 0 "residual force" form "$model" "$@" -o form.yaml
  grep -qF 'run: {duration: 10}' form.yaml || fail "$model: no run of 10 s was added"
  expect 0 run form.yaml -o results --quiet
  moved=$(drift results/nodes.csv)
  awk -v moved="$moved" -v size="$size" 'BEGIN { exit !(moved <= 1e-9 * size) }' ||
    fail "$model $*: drifts by $moved m"
}

# A requested accuracy stays, without a step beside it, and so do groups.
frame asked.yaml 'stiffness: 500 N/m, damping: 1' 'stiffness: 100 kN/m, mass: 50 g'
cat >>asked.yaml <<'YAML'
ground: {stiffness: 100 kN/m, damping: 50 N s/m}
gravity: [0, -9.81]
solver: {accuracy: 1 %}
run: {duration: 10 ms}
YAML
expect 0 form asked.yaml -o found.yaml
grep -qx 'solver: {accuracy: 1 %}' found.yaml && grep -q 'ac: {group: bar, nodes: \[a, c\], rest_length' found.yaml ||
  fail "groups or accuracy are lost: $(cat found.yaml)"
expect 0 run found.yaml --quiet

# The measure itself sees a drift.
printf 'time [s],a.x [m]\n0,1\n1,1.5\n2,1.25\n' >moves.csv
[ "$(drift moves.csv)" = 0.5 ] || fail "drift does not see what moves"

yaml frame.yaml <<'END'
name: Frame
parameters: {push: -2}
gravity: [0, -9.81]
nodes: {n1: {position: [0, 0], mass: 0.1}, n2: {position: [1, 0], mass: 0.1},
        n3: {position: [1.2, 1], mass: 0.1}, n4: {position: [0, 0.8], mass: 0.1}}
members: {c12: {kind: cable, nodes: [n1, n2], stiffness: 1000},
          c23: {kind: cable, nodes: [n2, n3], stiffness: 1000},
          c34: {kind: cable, nodes: [n3, n4], stiffness: 1000},
          c41: {kind: cable, nodes: [n4, n1], stiffness: 1000},
          b24: {kind: bar, nodes: [n2, n4], stiffness: 1e5, mass: 0.2},
          b13: {kind: bar, nodes: [n1, n3], axial_stiffness: 1e5, mass: 0.2}}
ground: {stiffness: 1e5, damping: 10, friction: {mu: 0.3, stick_velocity: 0.1 mm/s}}
loads: {down: {node: n3, force: [0, push]}}
END

stays frame.yaml 1.2 --least-tension "3 N"
stays frame.yaml 1.2 --objective sum
stays frame.yaml 1.2 --objective squares
stays "$models/gallery/arm.yaml" 4
stays "$models/gallery/spine.yaml" 0.3 --given prestress --objective squares
stays "$models/gallery/hexagon-two-struts.yaml" 2.3 --given prestress
stays "$models/gallery/hexagon-two-struts.yaml" 2.3 --given lengths
stays "$models/gallery/x-frame.yaml" 1 --given lengths
stays "$models/gallery/cauchy-hexagon.yaml" 2 --given densities

# The same bytes again; without -o the model alone is on stdout.
expect 0 form frame.yaml -o once.yaml --quiet
out_empty
expect 0 form frame.yaml
same once.yaml "$work/out"
err_empty
expect 0 check once.yaml
# What it found it finds again: the shape is in equilibrium, to the last bits of its forces.
shows 0 "displacement" form once.yaml --given lengths -o again.yaml

# The same as JSON: tiso's spine, least squares of densities of at least 0.5 N/m.
expect 0 form "$models/gallery/spine.yaml" --given prestress --objective squares --least-density "0.5 N/m" --json
holds '.from == "prestress" and .moved == 0 and (.densities.lower - 4.149565 | fabs) < 5e-7 and
  .densities.front_upper >= 0.4999999 and (.forces | length) == 16 and (.nodes | length) == 8 and
  .rest_lengths.lower < .lengths.lower'

# GLPK's own choice of scaling calls this one infeasible.
for objective in sum largest squares; do
  stays "$here/pentagon.yaml" 2 --given prestress --objective "$objective"
done

# Refusals.
tells 1 "expects densities, lengths or prestress, not 'densitis'; did you mean 'densities'?" form frame.yaml --given densitis
tells 1 "--least-tension expects a force, such as" form frame.yaml --least-tension "3 m"
tells 1 "must not be negative" form frame.yaml --least-tension -3
tells 3 "no member has a force density" form frame.yaml --given densities
tells 3 "stiffness does not allow" form frame.yaml --least-tension 1e6
edit '/b24/d' frame.yaml tells 3 "no forces with every cable at" form
err_has "are missing"
out_empty
edit '/^ground/d' frame.yaml tells 3 "nothing holds the structure" form --given lengths
tells 4 "nowhere" form frame.yaml -o "$work/nowhere/form.yaml"
absent "$work/nowhere"
