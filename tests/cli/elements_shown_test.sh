#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Running cables, laws, stops and hinges in what is printed, recorded, drawn, exported and written.
. "$(dirname "$0")/lib.sh"

yaml all.yaml <<'YAML'
name: all elements
nodes: {a: {position: [0, 0], fixed: both}, p: {position: [0.1, -0.06], mass: 0.1},
        b: {position: [0.3, 0], fixed: both}, d: {position: [0.1, -0.16], mass: 0.1}}
gravity: [0, -9.81]
members: {rope: {kind: cable, nodes: [a, p, b], stiffness: 500, damping: 1, rest_length: 0.31},
          rod: {kind: bar, nodes: [p, d], stiffness: 2000, damping: 1, longest: 0.1002},
          soft: {kind: spring, nodes: [a, d], law: {kind: table, points: [[-0.1, -1], [0, 0], [0.1, 2]]}},
          prop: {kind: spring, nodes: [b, d], stiffness: 10, law: compression_only}}
hinges: {elbow: {nodes: [a, p, d], stiffness: 0.05, damping: 0.001, rest_angle: 100 deg}}
actuators: {motor: {hinge: elbow, signal: {sine: {amplitude: 10 deg, frequency: 5 Hz}}}}
solver: {integrator: rk4-events, step: 0.1 ms}
run:
  duration: 0.1 s
  measure:
    quantities: {bend: {of: elbow.angle, take: final}, spin: {of: elbow.rate, take: max},
                 moment: {of: hinge(elbow).moment, take: final}, stretch: {of: rope.stretch, take: final},
                 length: {of: rope.length, take: final},
                 balance: {of: energy.total - work.drives + losses.total, take: range}}
output: {every: 1 ms, channels: [position, length, force, angle, moment]}
YAML

# What check prints: a table of each kind.
expect 0 check all.yaml
out_has "running cables                 1" "elbow" "a, p, b" "compression" "table" \
  "stop stiffness" "200 kN/m" "100 deg"
expect 0 check all.yaml --json
holds '.running_cables == 1 and .laws == 2 and .stops == 1 and .members.rope.nodes == ["a", "p", "b"]
  and .members.rod.stop_stiffness == 200000 and .members.soft.law == "table"
  and (.hinges.elbow.moment - 0.05 * (.hinges.elbow.drawn_angle - .hinges.elbow.rest_angle) | fabs) < 1e-15
  and (.hinges.elbow.rest_angle - 100 * 3.141592653589793 / 180 | fabs) < 1e-15'

# Recorded: the channels of the hinge, and of the members their sums.
expect 0 run all.yaml --quiet -o run --plot run.svg
[ "$(head -n 1 run/hinges.csv)" = "time [s],elbow.angle [rad],elbow.moment [N m]" ] || fail "hinges.csv"
[ "$(wc -l <run/hinges.csv)" -eq 102 ] || fail "rows of hinges.csv"
expect 0 run all.yaml --json
jq -r '.measured[] | .value' out >measured
holds '.measured.bend.value == .hinges.elbow.angle and .measured.moment.value == .hinges.elbow.moment'
holds '.measured | map(.value) | .[3] as $stretch | .[4] as $length
  | ($length - $stretch - 0.31 | fabs) < 1e-12 and .[5] < 1e-7'
last=$(tail -n 1 run/hinges.csv)
awk -F, -v bend="$(sed -n 1p measured)" -v moment="$(sed -n 3p measured)" \
  'function far(a, b) { return a - b > 1e-12 || b - a > 1e-12 }
   { exit far($2, bend) || far($3, moment) }' <<END || fail "the last row is $last"
$last
END

# The effective scene is the scene.
expect 0 export all.yaml
mv out written.yaml
expect 0 export run/scene.yaml
same out written.yaml
expect 0 run run/scene.yaml --quiet -o again
same run/hinges.csv again/hinges.csv
same run/members.csv again/members.csv

# Drawn and exported: the cable over its guide in VTK (three points of nine), on the page, in CSV.
expect 0 view run -o page.html --quiet
grep -q '"guides":\[1\]' page.html || fail "the page has no guides"
grep -q '"name":"elbow","nodes":\[0, 1, 3\]' page.html || fail "the page has no hinge"
if formats 0 vtk run -o vtk; then
  grep -q '<Lines>' vtk/structure_00000.vtp || fail "no lines"
  sed -n 's/.*Name="offsets"[^>]*>\([^<]*\)<.*/\1/p' vtk/structure_00000.vtp | base64 -d 2>/dev/null |
    od -An -v -t d4 -j 8 | tr -s ' \n' '  ' | grep -q '^ 3 5 7 9 $' || fail "offsets of the lines"
  formats 0 matrices all.yaml -o m
  grep -qx '1,rope,cable,a,b,p' m/columns.csv || fail "columns.csv lacks the guide"
  grep -qx '5,elbow,hinge,a,d,p' m/columns.csv || fail "columns.csv lacks the hinge"
fi
for draw in snapshots curves; do expect 0 run all.yaml --quiet --draw $draw --plot $draw.svg; done
for what in equilibria "modes --at start" rigidity; do
  set -- $what
  command=$1
  shift
  expect 0 "$command" all.yaml "$@" --quiet --plot "$command.svg"
done

# Velocities between steps h are off by 1/13416 h^5 w^6 at most, here 2.4e-5 m/s.
yaml free.yaml <<'YAML'
nodes: {w: {position: [0, 0], fixed: both}, b: {position: [2 m, 0], fixed: y, mass: 1}}
members: {s: {kind: spring, nodes: [w, b], stiffness: 100, rest_length: 1}}
solver: {integrator: adaptive8, step: 50 ms, tolerance: 1e-9}
run: {duration: 2 s}
output: {every: 3 ms, channels: [velocity]}
YAML
expect 0 run free.yaml --quiet -o free
awk -F, 'NR > 1 { bad += ($4 + 10 * sin(10 * $1)) ^ 2 > 2.4e-5 ^ 2 } END { exit !(NR > 600 && !bad) }' free/nodes.csv ||
  fail "a velocity between steps is off"

# A member that yields at 5 N has that force in each row while it does, also where samples are closer than steps.
yaml yields.yaml <<'YAML'
nodes: {w: {position: [0, 0], fixed: both}, b: {position: [1 m, 0], fixed: y, moves: {x: {ramp: {amplitude: 20 mm, stop: 0.2 s}}}}}
members: {s: {kind: spring, nodes: [w, b], stiffness: 1 kN/m, law: {kind: elastic_plastic, yield: 5 N}}}
solver: {integrator: rk4-events, step: 10 ms}
run: {duration: 0.2 s}
output: {every: 2.5 ms, channels: [force, plastic]}
YAML
for method in rk4-events rk4 adaptive; do # of 0.1 m/s * t the spring takes 5 mm, and rows are at exact times
  expect 0 run yields.yaml --quiet --integrator $method --step "10 ms" -o yields-$method
  awk -F, 'NR > 1 { x = 0.1 * $1; p = x > 0.005 ? x - 0.005 : 0; f = 1000 * (x - p)
    bad += ($1 - 0.0025 * (NR - 2)) ^ 2 > 1e-24 || ($2 - f) ^ 2 > 1e-18 || ($3 - p) ^ 2 > 1e-24 }
    END { exit !(NR == 82 && !bad) }' yields-$method/members.csv || fail "$method: a row of a yielding member is wrong"
done
