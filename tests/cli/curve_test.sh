#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Laws that fold back: paths through the folds and motions that jump, against the points of the law themselves.
. "$(dirname "$0")/lib.sh"

yaml single.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [5, 0], fixed: y, mass: 1}}
members:
  s: {kind: spring, nodes: [a, b], law: {kind: curve,
      points: [[-1, -1.5], [0, 0], [1.2, 1.8], [0.8, 0.4], [1.7, 1.3], [2, 0.6], [2.7, 1.7], [3.4, 1.9], [3, 1], [3.5, 0.7], [4, 2]]}}
loads: {f: {node: b, force: [2, 0]}}
YAML
# The load's path is the curve: its kinks are the points, force and elongation, stable where both grow.
expect 0 path single.yaml --json
holds 'def near($a; $b): ($a - $b | fabs) < 1e-13;
  [.events[] | select(.kind | startswith("kink"))] as $kinks |
  [[1.2, 1.8], [0.8, 0.4], [1.7, 1.3], [2, 0.6], [2.7, 1.7], [3.4, 1.9], [3, 1], [3.5, 0.7]] as $points |
  ($kinks | length) == 8 and
  ([range(8) as $k | near($kinks[$k].nodes.b[0] - 5; $points[$k][0]) and
    near(2 * $kinks[$k].factor; $points[$k][1])] | all) and
  ([$kinks[].detail | select(test("fold"))] | length) == 4 and .end == "until" and
  ([.points[].negative_eigenvalues] | max) == 1 and .points[-1].negative_eigenvalues == 0'

# Along a displacement the way between the folds is what is unstable; energies differ by the area between.
edit '/^loads/d' single.yaml expect 0 path --over b.x --until 4 --json
holds '[.points[] | select(.negative_eigenvalues > 0) | .nodes.b[0] - 5] | length > 2 and min > 0.8 - 1e-12 and max < 3.4 + 1e-12'

# A mass with speed v runs over folds; its energy is the integral of the force less what jumps set free. From 0 to
# 3.5 it jumps at 1.2 and 3.4; with E = v^2/2 at first, v^2/2 = E - integral afterwards.
integral='def area($p): [range(($p | length) - 1) as $k |
  0.5 * ($p[$k][1] + $p[$k + 1][1]) * ($p[$k + 1][0] - $p[$k][0])] | add;'
sed '/^loads/d' single.yaml >run.yaml
echo 'initial: {velocities: {b: [4, 0]}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 1.1, measure: {quantities: {v: {of: b.vx, take: final}, x: {of: b.x, take: final}}}}' >>run.yaml
for row in rk4-events:1e-9 adaptive:1e-9 rk4:2e-3 verlet:2e-3; do
  finds "$integral ${row#*:}"' as $near |
    (.measured.x.value - 5) as $x | .measured.v.value as $v |
    # the stable ways from 0 to 1.2, on to 2.7 and 3.4, and from there to 4
    (area([[0, 0], [1.2, 1.8]]) + area([[1.2, 0.8], [1.7, 1.3], [2, 0.6], [2.7, 1.7], [3.4, 1.9]]) +
     area([[3.4, 0.76], [3.5, 0.7]]) +
     ($x - 3.5) * (0.7 + 0.5 * ($x - 3.5) * 1.3 / 0.5)) as $work |
    $x > 3.5 and ($v * $v / 2 + $work - 8 | fabs) < $near and .jumps.s.count == 2 and
    (.jumps.s.energy - (area([[1.2, 0.8], [0.8, 0.4], [1.2, 1.8]]) + area([[3.4, 0.76], [3.5, 0.7], [3, 1], [3.4, 1.9]])) | fabs) < 1e-12 and
    (.energy.dissipated_members - .jumps.s.energy | fabs) < 1e-12 and
    (.energy.residual | fabs) < $near' run run.yaml --integrator ${row%:*}
done
expect 0 run run.yaml --accuracy 0.1% --json
tells 1 'yields or folds' run run.yaml --integrator midpoint
shows 0 'jumps at folds' run run.yaml

# A Bezier curve on both sides: x = t, F = 3 t (1 - t)^2 c1 + 3 t^2 (1 - t) c2 + t^3 c3 where x has no bend.
yaml bezier.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [5, 0], fixed: y, mass: 1}}
members:
  s: {kind: spring, nodes: [a, b], law: {kind: curve, mirrored: yes,
      control_points: [[0, 0], [0.333333333333333333, 2], [0.666666666666666667, -1], [1, 1]]}}
loads: {f: {node: b, force: [-1, 0]}}
YAML
edit '/^loads/d' bezier.yaml expect 0 path --over b.x --until -0.9 --json
holds '[.points[] | (5 - .nodes.b[0]) as $t | .forces.s + (6 * $t * (1 - $t) * (1 - $t) - 3 * $t * $t * (1 - $t) + $t * $t * $t) |
  fabs] | max < 1e-13'
# Rounded corners: between the parabolas the law is straight, at a corner half way between chord and corner.
yaml round.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [5, 0], fixed: y, mass: 1}}
members:
  s: {kind: spring, nodes: [a, b], law: {kind: curve, rounding: 0.5, points: [[0, 0], [2, 2], [1, 1], [4, 2]]}}
loads: {f: {node: b, force: [2, 0]}}
YAML
expect 2 path round.yaml # folds back upon itself: the force does not fall on the way
edit 's/\[1, 1\]/[1, 0]/' round.yaml expect 0 path --json
# The corner (2, 2) becomes P(t) = (2, 2) + (1-t)^2 (-0.5, -0.5) + t^2 (-0.25, -0.5): its x is largest at t = 2/3.
holds '[.events[] | select(.detail | test("fold"))] as $folds | ($folds | length) == 2 and
  ($folds[0].nodes.b[0] - 5 - (2 - 0.5 / 9 - 0.25 * 4 / 9) | fabs) < 1e-14'

# A driven spring with a memory: its path moves as the springs share what is driven, 2/3 to 1/3, until the fold.
yaml driven.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [5, 0], fixed: y, mass: 1}, c: {position: [9, 0], fixed: both}}
members:
  s: {kind: spring, nodes: [a, b], law: {kind: curve, mirrored: yes, points: [[0, 0], [1, 2], [0.8, 0.4], [4, 3]]}}
  k: {kind: spring, nodes: [b, c], stiffness: 1}
actuators: {pull: {member: s, signal: {sine: {amplitude: 1, frequency: 0.1}}}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 20}
YAML
gives '.points[-1].nodes.b[0]' '5 - 2 / 3' 1e-13 path driven.yaml --over pull --until -1
sed 's/law: {kind: curve.*}}$/stiffness: 2, law: {kind: elastic_plastic, yield: 9}}/' driven.yaml >yielding.yaml
gives '.points[-1].nodes.b[0]' '5 - 2 / 3' 1e-13 path yielding.yaml --over pull --until -1

# Stages go on from the piece where the one before ended: pulled over the fold and let go, it stays on the other piece.
sed '$a path: {stages: [{over: b.x, until: 1.5, steps: 2000}, {release: b.x}]}
  s/^loads.*//; s/, \[1.7, 1.3\].*\[4, 2\]/, [2, 1]/; s/\[0.8, 0.4\]/[0.8, -0.4]/' single.yaml >rest.yaml
gives '.points[-1].nodes.b[0] - 5' '0.8 + 0.4 * 1.2 / 1.4' 1e-12 path rest.yaml

# A circle's worth of folds: the extremes of x of a Bezier curve are where x' = 0, and the path turns there.
yaml turning.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [5, 0], fixed: y, mass: 1}}
members: {s: {kind: spring, nodes: [a, b], law: {kind: curve, control_points: [[0, 0], [3, 4], [-2, -4], [1, 0]]}}}
loads: {f: {node: b, force: [3, 0]}}
YAML
# x(t) = 9 t (1-t)^2 - 6 t^2 (1-t) + t^3 = 16 t^3 - 24 t^2 + 9 t: x' = 0 at t = 1/4 and 3/4, where x = 1 and 0.
expect 0 path turning.yaml --json
holds '[.events[] | select(.detail | test("fold")) | .nodes.b[0] - 5] as $x | ($x | length) == 2 and
  ($x[0] - 1 | fabs) < 1e-14 and ($x[1] | fabs) < 1e-14'
holds '[.points[] | .nodes.b[0] - 5] | max >= 1 and min >= -1e-12'

# A search says that it takes one branch; scenes are written as they were read.
tells 0 "may fold back" equilibria single.yaml
shows 0 'mirrored: yes' export "$here/../language/good/elements.yaml"
