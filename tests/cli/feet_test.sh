#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Feet that roll, against closed forms: rockers, a wheel on a slope, statics, and what is refused.
. "$(dirname "$0")/lib.sh"

# A rocker with feet of 1 m and its centre of mass 0.4 m high swings about the point of contact where it rolls,
# I = 1.92 + 4 * 0.4^2 kg m^2, and about its centre where nothing rubs; m g (r - h) is its stiffness.
yaml rocker.yaml <<'YAML'
gravity: [0, -10]
parameters: {tilt: 0.005, mu: 2}
nodes: {n: {position: ["-sin(tilt)", "1 - cos(tilt)"], mass: 3},
        o: {position: ["0.6*sin(tilt)", "1 + 0.6*cos(tilt)"], mass: 1}}
members: {body: {kind: bar, nodes: [n, o], stiffness: 1e5, damping: 100}}
feet: {f: {member: body, node: n, radius: 1 m}}
ground: {height: 4e-4, stiffness: 1e5, damping: 1000, friction: {law: smooth, mu: mu, width: 1 mm/s}, nodes: [n]}
solver: {integrator: rk4, step: 0.03 ms}
run: {duration: 0.8 s,
      measure: {quantities: {quarter: {of: n.x - o.x, take: arrival, target: 0}, n: {of: n.normal, take: final}}}}
YAML
for method in rk4 adaptive verlet rk4-events; do
  gives .measured.quarter.value '1.5707963267948966 / (24 / 2.56 | sqrt)' 2e-4 run rocker.yaml --integrator $method
  near .measured.n.value 40 1e-3
  gives .measured.quarter.value '1.5707963267948966 / (24 / 1.92 | sqrt)' 2e-4 run rocker.yaml --integrator $method --set mu=0
done
near '.energy.residual / (.energy.exchanged + 1e-9)' 0 1e-6

# Its modes are those without friction, and standing it has 40 N on its foot; a push of its head rolls it freely.
gives '.modes[0].frequency' 0 1e-9 modes rocker.yaml
near '.modes[1].frequency' '(24 / 1.92 | sqrt) / 6.283185307179586' 1e-4
gives '[.equilibria[] | select(.outcome == "stands") | .energy] | min' 16 1e-2 equilibria rocker.yaml

# A wheel of two feet rolls down a slope without slipping: 2/3 g sin(slope) of a disc becomes g sin / (1 + I / m r^2).
yaml wheel.yaml <<'YAML'
parameters: {slope: 10 deg}
gravity: [10*sin(slope), -10*cos(slope)]
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [0, 2], mass: 1}, top: {position: [0, 1], mass: 2}}
members: {down: {kind: bar, nodes: [a, top], stiffness: 1e5, damping: 200},
          up: {kind: bar, nodes: [b, top], stiffness: 1e5, damping: 200}}
hinges: {straight: {nodes: [a, top, b], stiffness: 1e4, damping: 20, rest_angle: 180 deg}}
feet: {one: {member: down, node: a, radius: 0.9999 m}, two: {member: up, node: b, radius: 0.9999 m}}
ground: {height: 4e-4, stiffness: 1e5, damping: 500, friction: {law: smooth, mu: 1, width: 1 mm/s}, nodes: [a, b]}
solver: {integrator: rk4, step: 0.03 ms}
run: {duration: 1 s, measure: {quantities: {x: {of: top.x, take: final}}}}
YAML
gives .measured.x.value '0.5 * 10 * 0.17364817766693033 / (1 + 2 / 4)' 5e-3 run wheel.yaml

# Pictures, writing, parts, and what cannot be.
expect 0 run rocker.yaml -o out-rocker --quiet --plot rocker.svg
expect 0 view out-rocker -o page.html
writes_back rocker.yaml
grep -q "f: {member: body, node: n, radius: 1}" written.yaml || fail "the foot was not written"
expect 1 run rocker.yaml --integrator midpoint
refused() { # sed command, message
  edit "$1" rocker.yaml tells 2 "$2" check
}
refused 's/node: n, radius/node: x, radius/' "unknown node 'x'"
refused 's/law: smooth, mu: mu, width: 1 mm.s/law: coulomb, mu: 1/' "no friction that sticks exactly"
refused 's/nodes: .n..$/nodes: [o]}/' "may touch no ground"
refused 's/radius: 1 m/radius: -1 m/' "'radius' of foot 'f' must be above zero"
