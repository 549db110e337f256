#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Friction whose coefficient is a signal, against closed forms.
. "$(dirname "$0")/lib.sh"

# A block that slides: v = u - g int mu dt, with mu = 0.2 sin(2 pi t), and 0 where that is negative.
yaml slide.yaml <<'YAML'
gravity: [0, -9.81]
nodes: {a: {position: [0, -9.81e-5], mass: 1}}
ground: {stiffness: 1e5, friction: {law: coulomb, mu: {sine: {amplitude: 0.2, frequency: 1}}}}
initial: {velocities: {a: [2, 0]}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 1.25, measure: {quantities: {v: {of: a.vx, take: final}, x: {of: a.x, take: final}}}}
YAML
loss='9.81 * 0.2 / (2 * 3.141592653589793)'
for method in rk4-events adaptive; do
  expect 0 run slide.yaml --integrator $method --json
  near .measured.v.value "2 - $loss * 3" 2e-9 # half a period, a pause, a quarter
  near .energy.residual 0 1e-9
done
sed 's/law: coulomb/law: karnopp, stick_velocity: 1e-6/' slide.yaml >band.yaml
by "rk4 rk4-events verlet verlet-events euler" band.yaml .measured.v.value "2 - $loss * 3" 2e-3
edit 's/law: coulomb/law: smooth, width: 1e-2/' slide.yaml gives .measured.v.value "2 - $loss * 3" 5e-5 run
expect 0 run slide.yaml --accuracy 0.01%

# On a slope it begins to slide when mu = 0.6 (1 - t) falls below the slope, and is then x = g cos 0.6 (t - t0)^3 / 6
# further down.
yaml slope.yaml <<'YAML'
gravity: [0, -9.81]
nodes: {a: {position: [0, -9.81e-5], mass: 1}}
ground: {stiffness: 1e5, damping: 300, slope: 20 deg, friction: {law: coulomb, mu: fading}}
signals: {fading: {table: [[0, 0.6], [1, 0]]}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 0.9, measure: {quantities: {x: {of: a.x, take: final}}}}
YAML
tangent='(0.3490658503988659 | sin) / (0.3490658503988659 | cos)'
way="(0.9 - (1 - ($tangent) / 0.6)) as \$t | (0.3490658503988659 | cos) as \$c | 9.81 * \$c * 0.6 * \$t * \$t * \$t / 6 * \$c"
expect 0 run slope.yaml --integrator adaptive --json
begin=$(jq '.measured.x.value' "$work/out")
edit 's/duration: 0.9/duration: 0.1/' slope.yaml expect 0 run --json
rest=$(jq '.measured.x.value' "$work/out")
jq -n -e --argjson x "$begin" --argjson x0 "$rest" "($way) as \$way | (\$x0 - \$x - \$way | fabs) < 1e-10" >jq.out ||
  fail "a block that begins to slide: from $rest to $begin"
by "rk4-events verlet-events" slope.yaml .measured.x.value "$begin" 1e-6

# Feet that hold in turn: a link that swells by a sine advances by its stroke in each period.
yaml walk.yaml <<'YAML'
gravity: [0, -9.81]
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1}}
members: {s: {kind: spring, nodes: [a, b], stiffness: 2e4, damping: 200}}
actuators: {drive: {member: s, signal: {sine: {amplitude: 20 mm, frequency: 0.2}}}}
ground:
  stiffness: 1e5
  damping: 200
  contacts: {a: {friction: {law: coulomb, mu: {square: {amplitude: 0.6, frequency: 0.2, phase: 90 deg}}}},
             b: {friction: {law: coulomb, mu: {square: {amplitude: 0.6, frequency: 0.2, phase: -90 deg}}}}}
solver: {integrator: rk4-events, step: 1 ms}
run: {periods: 4, of: drive}
YAML
gives .velocity '2 * 0.02 * 0.2 * 2 / 2' 1e-4 run walk.yaml

# A scene is written as it was read.
"$strut" export walk.yaml >written.yaml
"$strut" export written.yaml | cmp -s - written.yaml || fail "writing friction that follows a signal"
