#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Beams that are clamped to members and to each other, against the slope-deflection formulas.
. "$(dirname "$0")/lib.sh"

# An L frame: the tip sinks by P (b^2 h / EI_1 + b^3 / 3 EI_2), of second order in the parts.
yaml corner.yaml <<'END'
parameters: {n: 10}
nodes: {foot: {position: [0, 0], fixed: both}, corner: [0, 1 m], tip: [2 m, 1 m]}
beams:
  post: {nodes: [foot, corner], bending_stiffness: 3 N m^2, axial_stiffness: 10 MN, parts: n, clamped: start, mass: 0.1, damping: 2 ms}
  arm: {nodes: [corner, tip], bending_stiffness: 6 N m^2, axial_stiffness: 10 MN, parts: 2*n, clamped_to: {start: post}, mass: 0.1, damping: 3 ms}
loads: {tip: {node: tip, force: [0, -1e-5]}}
END
for n in 5 10 20; do
  gives '(1 - .points[-1].nodes.tip[1]) * 1e5' '4/3 + 8/18' "0.07 / ($n * $n)" path corner.yaml --set n=$n --load tip --until 1
done
# The same drawn oblique: the angle stays as drawn. Turned the other way round it is the same frame.
sed 's/post: {nodes: \[foot, corner\]/post: {nodes: [corner, foot]/; s/clamped: start/clamped: end/
  s/arm: {nodes: \[corner, tip\]/arm: {nodes: [tip, corner]/; s/clamped_to: {start/clamped_to: {end/' corner.yaml >turned.yaml
gives '(1 - .points[-1].nodes.tip[1]) * 1e5' '4/3 + 8/18' 2e-4 path turned.yaml --set n=20 --load tip --until 1
sed 's/tip: \[2 m, 1 m\]/tip: [1.2 m, 2.6 m]/; s/force: \[0, -1e-5\]/force: [0.8e-5, -0.6e-5]/' corner.yaml >oblique.yaml
expect 0 path oblique.yaml --set n=40 --load tip --until 1 --json
# by virtual work: the moment of the unit load at the height z of the post is 2.8 - 0.8 z
near '(.points[-1].nodes.tip | (.[0] - 1.2) * 0.8 - (.[1] - 2.6) * 0.6) * 1e5' \
  '8/18 + (7.84 - 2.24 + 0.64 / 3) / 3' 1e-3
# Its hinges, with the halves in a row, as they are written; a run keeps the balance of energy.
expect 0 export corner.yaml
grep -q '  arm.start: {nodes: \[post.9, corner, arm.1\], stiffness: 40, damping: 0.0933' out ||
  fail "no hinge at the corner in the written scene"
sed 's/10 MN/10 kN/' corner.yaml >run.yaml
cat >>run.yaml <<'END'
gravity: [0, -9.81]
solver: {step: 1 us}
run: {duration: 5 ms, measure: {quantities: {angle: {of: hinge(arm.start).angle, take: range}}}}
END
gives '.energy.residual / .energy.exchanged' 0 1e-6 run run.yaml --set n=3

# A T frame of three beams at one joint, which turns with the stiffness 4 EI_1/l_1 + 4 EI_2/l_2, less what
# its free rise gives way, (6 EI_1/l_1^2 - 6 EI_2/l_2^2)^2 / (12 EI_1/l_1^3 + 12 EI_2/l_2^3): the tip of the
# third moves by P (h^3 / 3 EI_3 + h^2 / stiffness). The mesh of hinges is of second order, too.
yaml tee.yaml <<'END'
parameters: {n: 10}
nodes: {left: {position: [-1 m, 0], fixed: both}, right: {position: [2 m, 0], fixed: both}, joint: [0, 0],
        tip: [0, 1.5 m]}
beams:
  one: {nodes: [left, joint], bending_stiffness: 2 N m^2, axial_stiffness: 10 MN, parts: n, clamped: start, mass: 0.1}
  two: {nodes: [joint, right], bending_stiffness: 5 N m^2, axial_stiffness: 10 MN, parts: n, clamped: end, clamped_to: {start: one}, mass: 0.1}
  three: {nodes: [joint, tip], bending_stiffness: 3 N m^2, axial_stiffness: 10 MN, parts: n, clamped_to: {start: two}, mass: 0.1}
loads: {tip: {node: tip, force: [1e-5, 0]}}
END
for n in 5 10 20; do
  expect 0 path tee.yaml --set n=$n --load tip --until 1 --json
  near '.points[-1].nodes.tip[0] * 1e5' '3.375 / 9 + 2.25 / (18 - 4.5 * 4.5 / 31.5)' "0.5 / ($n * $n)"
  jq '.points[-1].nodes.tip[0] * 1e5 - 3.375 / 9 - 2.25 / (18 - 4.5 * 4.5 / 31.5) | fabs' out >error.$n
done
jq -en "$(cat error.5) / $(cat error.10) | . > 3.6 and . < 4.4" >/dev/null || fail "not of second order"
jq -en "$(cat error.10) / $(cat error.20) | . > 3.6 and . < 4.4" >/dev/null || fail "not of second order"
expect 0 export tee.yaml
for hinge in 'two.start: {nodes: \[one.9, joint, two.1\]' 'three.start: {nodes: \[two.1, joint, three.1\]' \
  'one.end.three: {nodes: \[three.1, joint, one.9\]'; do
  grep -q "  $hinge" out || fail "no hinge $hinge in the written scene"
done

# A rigid bar on a pin, whose end carries a beam with a roller at its other end: the beam holds it by
# 3 EI / l, so that it swings with the frequency sqrt(3 EI / l / (m a^2)) of the masses that go along.
yaml bar.yaml <<'END'
parameters: {n: 20}
nodes: {pin: {position: [0, 0], fixed: both}, corner: {position: [0, 0.5 m], mass: 3 kg},
        roller: {position: [2 m, 0.5 m], mass: 1 kg, fixed: y}}
members: {bar: {kind: bar, nodes: [pin, corner], stiffness: 100 MN/m}}
beams:
  arm: {nodes: [corner, roller], bending_stiffness: 6 N m^2, axial_stiffness: 10 MN, parts: n, mass: 1 mg, clamped_to: {start: bar}}
END
for n in 10 20; do
  gives '.modes[0].angular_frequency' '3 * 6 / 2 / (4 * 0.25) | sqrt' "2 / ($n * $n)" modes bar.yaml --set n=$n
done
expect 0 export bar.yaml
grep -q '  arm.start: {nodes: \[pin, corner, arm.1\], stiffness: 120}' out || fail "no hinge at the bar"

# At a fixed clamp of the other beam an end is held in that direction.
yaml held.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: [1, 0], c: [0, 1]}
beams: {rod: {nodes: [a, b], bending_stiffness: 3, axial_stiffness: 1e7, clamped: start},
        mast: {nodes: [a, c], bending_stiffness: 3, axial_stiffness: 1e7, clamped_to: {start: rod}}}
loads: {tip: {node: c, force: [1e-5, 0]}}
END
gives '.points[-1].nodes.c[0] * 1e5' '1/9 * (1 + 1 / 200)' 1e-6 path held.yaml --load tip --until 1
near '.points[-1].nodes.b[1]' 0 1e-12
