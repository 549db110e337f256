#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Beams, which are chains of bars and hinges, through the program, against closed forms.
. "$(dirname "$0")/lib.sh"

# Euler's load of a pinned beam of n parts, 4 n^2 sin^2(pi / 2n) EI / L^2: the lowest stiffness falls to
# zero there, as a line of the load.
column() {
  jq -nr --argjson n "$1" --argjson factor "$2" '
    (4 * $n * $n * (3.141592653589793 / 2 / $n | sin | . * .) * 3) as $critical
    | "strut: 1", "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y}}",
      "beams: {rod: {nodes: [a, b], bending_stiffness: 3 N m^2, axial_stiffness: 1e9, parts: \($n), mass: 1}}",
      "loads: {press: {node: b, force: [-\($critical * $factor), 0]}}"'
}
for n in 2 4 10; do
  column $n 0.5 >column.yaml
  expect 0 modes column.yaml --json
  half=$(jq '.modes[0].eigenvalue' out)
  column $n 0.99 >column.yaml
  gives "(.modes[0].eigenvalue) as \$most | (0.99 * $half - 0.5 * \$most) / ($half - \$most)" 1 1e-4 modes column.yaml
done

# The tip of a cantilever under a small end force: P L^3 / 3 EI (1 + 1 / 2n^2), of second order in n.
cantilever() {
  yaml <<END
nodes: {a: {position: [0, 0], fixed: both}, b: [2, 0]}
beams: {rod: {nodes: $3, bending_stiffness: 3 N m^2, axial_stiffness: 1e6, parts: $1, mass: 0.5, clamped: $2}}
loads: {tip: {node: b, force: [0, 1e-5]}}
END
}
for n in 1 3 10 40; do
  cantilever $n start "[a, b]" >tip.yaml
  gives '.points[-1].nodes.b[1] * 3 * 3 / (1e-5 * 8)' "1 + 1 / (2 * $n * $n)" 1e-6 path tip.yaml --load tip --until 1
  near '.points[-1].moments["rod.start"]' '2e-5' 1e-9
done
cantilever 10 end "[b, a]" >turned.yaml
gives '.points[-1].nodes.b[1] * 3 * 3 / (1e-5 * 8)' '1 + 1 / 200' 1e-6 path turned.yaml --load tip --until 1

# Its first frequency, 3.516015 sqrt(EI / m L^3), with the consistent mass of bars; second order.
for n in 10 20 40; do
  cantilever $n start "[a, b]" | sed '/loads/d' >tip.yaml
  gives '.modes[0].angular_frequency / (3 / (0.5 * 8) | sqrt) / 3.5160153' 1 "0.6 / ($n * $n)" modes tip.yaml
  jq ".modes[0].angular_frequency / (3 / (0.5 * 8) | sqrt) / 3.5160153 - 1 | fabs" out >error.$n
done
jq -en "$(cat error.10) / $(cat error.20) | . > 3.5 and . < 4.5" >/dev/null || fail "not of second order"
jq -en "$(cat error.20) / $(cat error.40) | . > 3.5 and . < 4.5" >/dev/null || fail "not of second order"

# An end moment, by two forces on a stiff cross-bar, bends it into a circle: every
# hinge turns by M h / EI, the one at the clamp by half of it.
yaml moment.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: [1, 0], u: [1, 0.2], w: [1, -0.2]}
beams: {rod: {nodes: [a, b], bending_stiffness: 1 N m^2, axial_stiffness: 1e9, parts: 8, clamped: start}}
members: {ub: {kind: bar, nodes: [u, b], stiffness: 1e9}, wb: {kind: bar, nodes: [w, b], stiffness: 1e9}}
hinges: {straight: {nodes: [u, b, w], stiffness: 1e6}, square: {nodes: [rod.7, b, u], stiffness: 1e6}}
loads: {one: {node: u, force: [-2.5, 0]}, two: {node: w, force: [2.5, 0]}}
END
expect 0 path moment.yaml --until 1 --json
jq '.points[-1] as $p | [$p.nodes.a, $p.nodes["rod.1"], $p.nodes["rod.2"], $p.nodes["rod.3"], $p.nodes["rod.4"],
  $p.nodes["rod.5"], $p.nodes["rod.6"], $p.nodes["rod.7"], $p.nodes.b] as $n
  | [range(8) | atan2($n[. + 1][1] - $n[.][1]; $n[. + 1][0] - $n[.][0])] as $angle
  | ($p.nodes.u[0] - $p.nodes.w[0]) as $x | ($p.nodes.u[1] - $p.nodes.w[1]) as $y
  | {moment: (2.5 * $y), first: $angle[0], turns: [range(7) | $angle[. + 1] - $angle[.]]}' out >bent
cp bent out
for k in 0 3 6; do near ".turns[$k]" "$(jq .moment bent) / 8" 1e-6; done
near .first "$(jq .moment bent) / 16" 1e-6

# A frame corner by a plain hinge: it stays square, and a run keeps its energy balance.
yaml frame.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, 1], mass: 0.1}, c: {position: [1, 1], mass: 0.1}}
beams:
  post: {nodes: [a, b], bending_stiffness: 5, axial_stiffness: 1e4, parts: 4, mass: 0.2, clamped: start, damping: 1 ms}
  beam: {nodes: [b, c], bending_stiffness: 5, axial_stiffness: 1e4, parts: 4, mass: 0.2, damping: 1 ms}
hinges: {corner: {nodes: [post.3, b, beam.1], stiffness: 500}}
gravity: [0, -9.81]
solver: {integrator: rk4, step: 50 us}
run: {duration: 1, measure: {quantities: {bent: {of: hinge(corner).angle, take: range}, root: {of: post.start.moment, take: min}}}}
END
expect 0 run frame.yaml -o frame --quiet
cp frame/summary.json out
near '.energy.residual / .energy.exchanged' 0 1e-6 .measured.bent.value 0 0.05
holds '.measured.root.value < -0.5 or .measured.root.value > 0.5'

# A clamp on a shaken support moves with it.
yaml shaken.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both, moves: {y: {sine: {amplitude: 10 mm, frequency: 3 Hz}}}},
        b: {position: [1, 0], mass: 0.1}}
beams: {rod: {nodes: [a, b], bending_stiffness: 5, axial_stiffness: 1e4, parts: 4, mass: 0.2, clamped: start}}
solver: {integrator: rk4, step: 50 us}
run: {duration: 1, measure: {quantities: {apart: {of: a.y - node(rod.start).y, take: range}, shaken: {of: node(rod.start).y, take: max}}}}
END
expect 0 run shaken.yaml -o shaken --quiet
cp shaken/summary.json out
near .measured.apart.value 0 1e-12 '[.measured.shaken.value, .energy.residual / .energy.exchanged]' '[0.01, 0]' 1e-6

# The scene as written names the parts, and runs with the same bits.
expect 0 export frame.yaml
cp out flat.yaml
grep -q '  post.start: {nodes: \[post.start, a, post.1\], stiffness: 40, damping: 0.04, rest_angle: 3.14159' flat.yaml ||
  fail "no hinge at the clamp in the written scene"
grep -q '  beam.4: {nodes: \[beam.3, c\], kind: bar, axial_stiffness: 10000, damping: 40, mass: 0.05, rest_length_ratio: 1}' flat.yaml ||
  fail "no last bar in the written scene"
expect 0 run flat.yaml -o flat --quiet
same frame/members.csv flat/members.csv
shows 0 "post.start" check frame.yaml
