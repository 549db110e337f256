#!/bin/sh
# Statics on circles and profiles: paths and form finding, against closed forms.
peers=$(cd "$(dirname "$0")/../peers" && pwd)
. "$(dirname "$0")/lib.sh"

# ---- inside of a circle: the ground pushes against weight and load, so that both set the angle ----
yaml pipe.yaml <<'END'
parameters: {radius: 1 m}
nodes: {a: {position: [0, -1 m], mass: 1 kg}}
ground: {circle: {centre: [0, 0], radius: radius, inside: yes}, stiffness: 10 kN/m, nodes: [a]}
gravity: [0, -10 m/s^2]
loads: {p: {node: a, force: [1 N, 0]}}
END
expect 0 path pipe.yaml --until 20 --json
holds '[.points[] | (.factor * .factor + 100 | sqrt) as $n | (1 + $n / 10000) as $r |
  .contacts.a - $n, .nodes.a[0] - $r * .factor / $n, .nodes.a[1] + $r * 10 / $n | fabs] | max < 1e-12'
expect 0 path pipe.yaml --over radius --until '2 m' --json
holds '[.points[] | (101 | sqrt) as $n | .contacts.a - $n, .nodes.a[0] - (.value / $n + 1e-4) | fabs] | max < 1e-11'

# ---- on top of a circle: springs of 20 N/m sideways hold until the normal force by the radius is as much ----
yaml ball.yaml <<'END'
nodes: {l: {position: [-3 m, 1 m], fixed: both}, r: {position: [3 m, 1 m], fixed: both}, a: [0, 1.2 m]}
members: {sl: {kind: spring, nodes: [l, a], stiffness: 10 N/m, rest_length: 2.5 m},
          sr: {kind: spring, nodes: [r, a], stiffness: 10 N/m, rest_length: 2.5 m}}
ground: {circle: {centre: [0, 0], radius: 1 m}, stiffness: 100 kN/m, nodes: [a]}
loads: {w: {node: a, force: [0, -10 N]}}
END
expect 0 path ball.yaml --until 3 --json
holds '.events | length == 1 and .[0].kind == "bifurcation" and
  (.[0] | (1 - .nodes.a[1]) as $d | (9 + $d * $d | sqrt) as $l |
   20 * (9 + (1 - 2.5 / $l) * $d * $d) / ($l * $l) - 1e5 * $d / .nodes.a[1] | fabs < 1e-7)'

# ---- over a convex corner: on each of its sides the forces along the facet balance ----
yaml hill.yaml <<'END'
nodes: {l: {position: [-3 m, 1 m], fixed: both}, r: {position: [3 m, 1 m], fixed: both}, a: {position: [0, 1.2 m], mass: 1 kg}}
members: {sl: {kind: spring, nodes: [l, a], stiffness: 10 N/m, rest_length: 2 m},
          sr: {kind: spring, nodes: [r, a], stiffness: 10 N/m, rest_length: 2 m}}
ground: {stiffness: 100 kN/m, nodes: [a], profile: [[-3, 0], [-1, 0.5], [0.5, 1], [1, 0.5], [1.5, 0.4], [3, 1]]}
gravity: [0, -10 m/s^2]
loads: {p: {node: a, force: [1 N, 0]}}
END
expect 0 path hill.yaml --until 30 --json
holds '
  def pull($x): . as $p | [$x - $p[0], 1 - $p[1]] | (.[0] * .[0] + .[1] * .[1] | sqrt) as $l |
    map(. * 10 * ($l - 2) / $l);
  def along($t; $load): (pull(-3) as $u | pull(3) as $v | ($u[0] + $v[0] + $load) * $t[0] + ($u[1] + $v[1] - 10) * $t[1]) | fabs;
  [.events[] | .kind] == ["corner", "touchdown", "lift-off", "touchdown"] and
  (.events[0].factor as $f | [.points[] | select(.nodes.a[0] < 0.7 and .factor > 10)] | last |
    .factor as $before | .nodes.a | along([3, 1]; $before) < 1e-9) and
  (.events[0] | .factor as $after | .nodes.a | along([1, -1]; $after) < 1e-9) and
  (.events[1] | .factor as $f | .nodes.a | along([1, -1]; $f) < 1e-9) and
  (.events[2] | .factor as $f | .nodes.a | along([5, -1]; $f) < 1e-9)'
out_has "passes a corner of the ground: the factor jumps from"
# carried over the same corner by its displacement, the node stays at it
finds '[.events[] | .kind] == ["corner", "touchdown", "lift-off"]' path hill.yaml --over a.x --until '1.5 m'
# a corner at the same place, whether the profile is drawn or moved there by a parameter
sed -e 's/^nodes:/parameters: {at: 0 m}\nnodes:/' -e 's/\[-3, 0\].*/[at - 3, 0], [at - 1, 0.5], [at + 0.5, 1], [at + 1, 0.5], [at + 1.5, 0.4], [at + 3, 1]]}/' \
  hill.yaml >moved.yaml
expect 0 path moved.yaml --over at --until '-0.3 m' --json
gives '.points[0].nodes.a' "$(jq -c '.points[-1].nodes.a' out)" 1e-8 path moved.yaml --set 'at=-0.3 m' --from 1 --until 1.001

# ---- form finding in a pipe and between a floor and walls: the forces drawn for hold the shape ----
yaml hung.yaml <<'END'
nodes: {a: {position: [-0.6, -0.8], mass: 1}, b: {position: [0.6, -0.8], mass: 1}, c: {position: [0, -0.4], mass: 1}}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 10 kN/m}, ac: {kind: bar, nodes: [a, c], stiffness: 10 kN/m},
          bc: {kind: bar, nodes: [b, c], stiffness: 10 kN/m}}
ground: {circle: {centre: [0, 0], radius: 1, inside: yes}, stiffness: 100 kN/m, nodes: [a, b]}
gravity: [0, -10]
END
expect 0 form hung.yaml --given prestress --json
# the pipe carries 30 N on two normals whose y is 0.8; c hangs on two bars
holds '[.forces.ac + 5 * (0.6 * 0.6 + 0.4 * 0.4 | sqrt) / 0.4, .forces.ab + 15 / 0.8 * 0.6 - 7.5 | fabs] | max < 0.002'
sed -e 's/^ground:.*/grounds:\n  floor: {height: -0.8, stiffness: 100 kN\/m, nodes: [a, b]}\n  wall: {through: [0.6, 0], normal: [-1, 0], stiffness: 100 kN\/m, nodes: [b]}\n  other: {through: [-0.6, 0], normal: [1, 0.2], stiffness: 100 kN\/m, nodes: [a]}/' \
  hung.yaml >between.yaml
finds '.residual < 1e-6' form between.yaml --given prestress

# A path does not depend on how long its steps are: none of them ends at a switch of another branch.
for until in 0.9 1 1.1 3; do
  gives '.points[-1].factor' 0.61767117038817 1e-12 path "$peers/beam-between-walls.yaml" --stop link.14.head.x=-4.51 --until $until
  near '.events | length' 22 0
done
gives '.points[-1].factor' 0.5110687 2e-6 path "$peers/gripper.yaml" --stop n22.x=0.39954 --steps 3000

# ---- between two points of a path: a cable pulls at the top of a swing, the ground pushes at its bottom, the path ----
# ---- stops; a law dips, so that its load turns twice, or what it pushes bifurcates twice ----
yaml swing.yaml <<'END'
parameters: {d: 1e-9, side: 1}
nodes: {o: {position: [0, 0], fixed: both}, e: {position: [0, -0.5], fixed: both}, t: [-0.6, 0.8*side]}
members: {rod: {kind: bar, nodes: [o, t], stiffness: 1 MN/m},
          rope: {kind: cable, nodes: [e, t], stiffness: 1 kN/m, rest_length: 1.5 - d}}
ground: {stiffness: 100 kN/m, height: d - 1, nodes: [t]}
END
yaml dip.yaml <<'END'
parameters: {half: 0.04}
nodes: {w: {position: [0, 0], fixed: both}, u: {position: [1, 0], fixed: y}}
members: {m: {kind: spring, nodes: [w, u], law: {kind: polynomial, coefficients: [0.5137^2 - half^2, -0.5137, 1/3]}}}
loads: {p: {node: u, force: [1, 0]}}
END
sed 's/fixed: y/fixed: x/; s/law:.*/rest_length: 1.5137 - half, law: {kind: polynomial, coefficients: [-2*half, 1]}}}/' dip.yaml >pushed.yaml
# twice KIND KIND MIDDLE HALF WORD...: a path has two events, at equal distances from the middle.
twice() {
  kinds="[\"$1\", \"$2\"]" places="[$3 - ($4), $3 + ($4)]" && shift 4
  finds ".end == \"until\" and [.events[].kind] == $kinds and
    ([[.events[] | .value // .nodes.u[0] - 1], $places] | transpose | [.[] | .[0] - .[1] | fabs] | max < 1e-7)" path "$@"
}
for d in 1e-2 1e-4 1e-6; do
  twice taut slack 0.6 "(1.5 - $d) * (1.5 - $d) - 1.25 | 1 - . * . | sqrt" swing.yaml --set d=$d --over t.x=0..1.13
  twice touchdown lift-off 0.6 "1 - $d | 1 - . * . | sqrt" swing.yaml --set d=$d --set side=-1 --over t.x=0..1.13
  finds '.end == "stop"' path swing.yaml --over t.x=0..1.13 --stop t.y="$(awk "BEGIN { print 0.2 - $d }")"
done
for half in 0.04 0.004 0.001; do
  twice 'limit point' 'limit point' 0.5137 $half dip.yaml --set half=$half --until 0.2
  twice bifurcation bifurcation 0.5137 $half pushed.yaml --set half=$half --over u.x=0..1.5
done
