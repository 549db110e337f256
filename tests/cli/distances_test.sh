#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Distances along a direction and from a line, against closed forms and the contact of the ground.
. "$(dirname "$0")/lib.sh"

# A mass on a distance along 30 deg: 1 Hz along it, nothing across it.
yaml along.yaml <<'YAML'
nodes: {a: {position: [1, 2], fixed: both}, b: {position: [3, 1], mass: 1}}
distances: {d: {nodes: [a, b], along: 30 deg, stiffness: "4 * pi^2", rest_distance: 1 m}}
initial: {velocities: {b: [-0.5, 0.8660254037844386]}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 0.25 s, measure: {quantities: {at: {of: d.distance, take: final}, rate: {of: d.rate, take: final},
  f: {of: d.force, take: max}, across: {of: (b.y - a.y) * cos(30 deg) - (b.x - a.x) * sin(30 deg), take: final}}}}
YAML
drawn='(3 | sqrt) - 0.5'
by "rk4 adaptive midpoint verlet rk4-events" along.yaml .measured.at.value 1 1e-4 \
  .measured.rate.value "-2 * 3.141592653589793 * ($drawn - 1)" 1e-4 \
  .measured.f.value "4 * 3.141592653589793 * 3.141592653589793 * ($drawn - 1)" 1e-9 \
  .measured.across.value '-1 - 0.5 * (3 | sqrt) + 0.25' 1e-9 '.energy.residual / .energy.exchanged' 0 1e-5
gives '.modes[1].frequency' 1 1e-9 modes along.yaml
near '.modes[0].frequency' 0 1e-9
expect 0 run along.yaml --quiet --plot along.svg -o out-along
expect 0 view out-along -o along.html

# In copies of a part the direction turns and lengths grow; a line keeps its side where it is flipped.
yaml parts.yaml <<'YAML'
parts:
  leg:
    nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0.5], mass: 1}, t: {position: [2, 0], fixed: both}}
    distances: {d: {nodes: [a, b], along: x, stiffness: 5, rest_distance: 0.8 m}, o: {node: b, line: [a, t], stiffness: 5, rest_distance: 0.2 m}}
place: {one: {part: leg}, two: {part: leg, flip: y, turn: 90 deg, at: [5, 0], scale: 2}}
YAML
gives '.distances | [.["one.d"].drawn, .["one.o"].drawn]' '[1, 0.5]' 0 check parts.yaml
near '.distances | [.["two.d"].drawn, .["two.d"].rest, .["two.o"].drawn]' '[2, 1.6, 1]' 1e-15
shows 0 'one.d: {nodes: [one.a, one.b], along: x, stiffness: 5, rest_distance: 0.8}' export parts.yaml
out_has 'two.d: {nodes: [two.a, two.b], along: y, stiffness: 5, rest_distance: 1.6}'
out_has 'two.o: {node: two.b, line: [two.t, two.a], stiffness: 5, rest_distance: 0.4}'
writes_back parts.yaml
expect 0 modes parts.yaml --json # each node by itself: 2 and 2 frequencies
near '.modes[3].frequency' '(5 | sqrt) / 2 / 3.141592653589793' 1e-9

# A ball that falls on a line of fixed nodes bounces as on the ground.
yaml ball.yaml <<'YAML'
gravity: [0, -10]
nodes:
  left: {position: [-1, -0.2], fixed: both}
  right: {position: [3, 0.6], fixed: both}
  ball: {position: [0, 0.5], mass: 1}
distances: {hit: {node: ball, line: [left, right], rest_distance: 0, stiffness: 1e4, law: compression_only}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 1 s, measure: {quantities: {x: {of: ball.x, take: final}, y: {of: ball.y, take: final}, f: {of: hit.force, take: min}}}}
YAML
sed -e '/distances/d' -e '/left/d' -e '/right/d' -e 's/hit.force, take: min/ball.normal, take: max/' ball.yaml >ground.yaml
echo 'ground: {slope: "atan(0.2)", stiffness: 1e4, contacts: {ball: {}}}' >>ground.yaml
expect 0 run ground.yaml --json
for what in x y f; do eval "$what=\$(jq .measured.$what.value out)"; done
gives .measured.x.value "$x" 1e-9 run ball.yaml
near .measured.y.value "$y" 1e-9 .measured.f.value "-$f" 1e-6 '.energy.residual / .energy.exchanged' 0 1e-5

# Three free nodes: a line gives neither momentum nor, about any point, a moment; work and losses are balanced.
yaml free.yaml <<'YAML'
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [2, 0.3], mass: 2}, c: {position: [0.7, 0.9], mass: 3}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100}}
distances: {o: {node: c, line: [a, b], damping: 2, law: {kind: bilinear, knee: 20 mm, second_stiffness: 90}, stiffness: 30, rest_distance: 0.5 m}}
solver: {integrator: rk4-events, step: 1 ms}
run:
  duration: 2 s
  measure: {quantities: {vx: {of: com.vx, take: rms}, vy: {of: com.vy, take: rms},
    turn: {of: 1 kg * (a.x * a.vy - a.y * a.vx) + 2 kg * (b.x * b.vy - b.y * b.vx) + 3 kg * (c.x * c.vy - c.y * c.vx), take: rms}}}
YAML
gives .measured.vx.value 0 1e-13 run free.yaml
near .measured.vy.value 0 1e-13 .measured.turn.value 0 1e-11 .energy.residual 0 1e-9

# Two springs pull against each other: both have their own force, and it balances.
yaml pulled.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [2, 0], mass: 1, fixed: y}, c: {position: [5, 0], fixed: both}}
members: {m: {nodes: [a, b], kind: spring, stiffness: 100, rest_length: 1}}
distances: {d: {nodes: [b, c], along: x, stiffness: 100, rest_distance: 2 m}}
YAML
gives .distances_at.d.force 100 1e-12 rigidity pulled.yaml
near .residual 0 1e-12

# Statics: a node on two crossed distances; it moves by F / k, has no mechanism, and one with a bar has self-stress.
yaml held.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 1], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 1}}
distances: {x: {nodes: [a, b], along: x, stiffness: 50}, y: {nodes: [a, b], along: y, stiffness: 20, rest_distance: 0.9 m}}
loads: {f: {node: b, force: [3 N, 0]}}
YAML
gives .rank 2 0 rigidity held.yaml
near '[.distances, .self_stress.count, .mechanisms.count]' '[2, 1, 0]' 0 .distances_at.y.force 2 1e-12
sed '/^members/d' held.yaml >crossed.yaml
gives '.points[-1].nodes.b[0]' '1 + 6 / 50' 1e-9 path crossed.yaml --load f --until 2
near '[.points[-1].nodes.b[1], .points[-1].distance_forces.x]' '[0.9, 6]' 1e-9
gives '.points[-1].nodes.b[0]' 1.02 1e-9 path crossed.yaml --load f --until 2 --stop 'b.x=2 cm'
near '.points[-1].factor' '50 * 0.02 / 3' 1e-9
[ "$(jq -r .end out)" = stop ] || fail 'the path does not say that it stops'
gives '.points[-1].factor' 2 0 path crossed.yaml --load f --until 2 --stop b.x=1
for stop in b.x b.z=1 c.x=1 b.x=0 b.x=1N b.x= =1; do
  tells 1 "--stop expects a node's displacement, not 0, such as a.x=10mm, not '$stop'" path crossed.yaml --stop $stop
done
gives '.equilibria | length' 1 0 equilibria crossed.yaml
tells 2 'x is a distance' form held.yaml --given densities

edit 's/along: 30 deg/along: x/; s/d.force/d.forse/' along.yaml tells 2 "distance 'd' has no column 'forse'; did you mean 'force'?" check
