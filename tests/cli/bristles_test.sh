#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Friction by bristles (LuGre), against a closed form and its equations integrated apart.
. "$(dirname "$0")/lib.sh"

# A block on a belt sticks and slips against a spring.
yaml belt.yaml <<'YAML'
gravity: [0, -9.81]
nodes: {wall: {position: [-1, -98.1 um], fixed: both}, block: {position: [0, -98.1 um], mass: 1 kg}}
members: {spring: {kind: spring, nodes: [wall, block], stiffness: 200 N/m}}
ground: {belt_speed: 10 mm/s, stiffness: 1e5 N/m, damping: 300 N s/m, nodes: [block], friction: {law: lugre,
           mu_static: 0.15, mu_kinetic: 0.1, decay_velocity: 1 mm/s, presliding: 15 um, relaxation: 3 ms}}
sensors: {push: {contact_force: block}, down: {contact: block}}
solver: {integrator: rk4, step: 20 us}
run: {duration: 3 s, measure: {quantities: {x: {of: block.x, take: final}, way: {of: block.x, take: max},
        friction: {of: block.friction, take: final}, push: {of: push, take: final}, down: {of: down, take: min}}}}
YAML
cat >apart.py <<'PY'
m, k, V, N, mu0, mu, v0, d, tau = 1.0, 200.0, 0.01, 9.81, 0.15, 0.1, 1e-3, 15e-6, 3e-3
s0 = mu0 / d

def rates(y):  # position, speed, bristles' deflection in metres, as in the paper
    u = y[1] - V
    g = (mu + (mu0 - mu) / (1 + (u / v0) ** 2)) / s0
    z = u - abs(u) * y[2] / g
    return y[1], (-k * y[0] - N * s0 * (y[2] + tau * z)) / m, z

y, h, most = (0.0, 0.0, 0.0), 2e-5, 0.0
for _ in range(150000):
    a = rates(y)
    b = rates([p + h / 2 * q for p, q in zip(y, a)])
    c = rates([p + h / 2 * q for p, q in zip(y, b)])
    e = rates([p + h * q for p, q in zip(y, c)])
    y = [p + h / 6 * (q + 2 * r + 2 * s + t) for p, q, r, s, t in zip(y, a, b, c, e)]
    most = max(most, y[0])
print(y[0], most, -N * s0 * (y[2] + tau * rates(y)[2]))
PY
python3 apart.py >apart
read -r x way friction <apart
by "rk4:1e-8 rk4-events:1e-8 adaptive:1e-8 verlet:3e-5" belt.yaml .measured.x.value "$x" own .measured.way.value "$way" own \
  .measured.friction.value "$friction" 3e-4 .measured.push.value 9.81 1e-9 .measured.down.value 1 0
near '.energy.residual / .energy.exchanged' 0 1e-6
gives .measured.way.value "$way" 1e-3 run belt.yaml --accuracy 0.1%
writes_back belt.yaml
gives .measured.x.value "$x" 1e-8 run written.yaml
holds '.caveat == null or (.caveat | contains("sticking") | not)'

# Steps that are too long for sliding bristles are told.
finds '[.warnings[] | select(.code == "bristles")] | length == 1' run belt.yaml --step 1.5ms
finds '[.warnings[] | select(.code == "bristles")] | length == 0' run belt.yaml

# Steps far too long for them end the run, by whichever number grows first, and nothing is said of sensors.
sed 's|10 mm/s|50 m/s|' belt.yaml >fast.yaml
expect 3 run fast.yaml --integrator rk4-events
grep -qE "the bend of bristles is no longer a finite number at t = |node 'block' left all bounds at t = " "$work/err" ||
  fail "a run of long steps over bristles: $(cat "$work/err")"
tells 3 "look for a member or contact that is far too stiff" run fast.yaml

# Pushed slowly, bristles give way like Dahl's law: x = -d ln(1 - F / (mu_0 N)).
yaml push.yaml <<'YAML'
gravity: [0, -10]
nodes: {block: {position: [0, -0.1 mm], mass: 1 kg}, far: {position: [1, 0], fixed: both}}
members: {none: {kind: cable, nodes: [block, far], stiffness: 1e-6, rest_length: 2}}
ground: {stiffness: 1e5 N/m, nodes: [block], friction: {law: lugre,
           mu_static: 0.2, mu_kinetic: 0.2, decay_velocity: 1, presliding: 20 um, relaxation: 1 ms}}
loads: {push: {node: block, force: [1, 0], signal: {ramp: {amplitude: 1, stop: 20 s}}}}
solver: {integrator: adaptive, step: 10 ms, tolerance: 1e-9}
run: {duration: 20 s, measure: {quantities: {x: {of: block.x, take: final}}}}
YAML
gives .measured.x.value '20e-6 * (2 | log)' 2e-4 run push.yaml

# A foot with bristles holds its member where smooth friction creeps.
yaml foot.yaml <<'YAML'
gravity: [1, -10]
nodes: {n: {position: [0, -0.2 mm], mass: 1}, o: {position: [0, 0.5], mass: 1}}
members: {body: {kind: bar, nodes: [n, o], stiffness: 1e5, damping: 100}}
feet: {f: {member: body, node: n, radius: 0.3 m}}
ground: {stiffness: 1e5, damping: 100, nodes: [n], friction: {law: lugre,
           mu_static: 0.5, mu_kinetic: 0.4, decay_velocity: 10 mm/s, presliding: 50 um, relaxation: 1 ms}}
sensors: {push: {contact_force: n}}
solver: {integrator: adaptive, step: 1 ms}
run: {duration: 0.2 s, measure: {quantities: {push: {of: push, take: mean}, rub: {of: n.friction, take: mean}}}}
YAML
gives .measured.push.value 20 0.05 run foot.yaml

# A foot that comes down starts a signal, by methods with events and without.
yaml fall.yaml <<'YAML'
gravity: [0, -10]
nodes: {n: {position: [0, 0.05], mass: 1}, o: {position: [0.3, 0.45], mass: 1}}
members: {body: {kind: bar, nodes: [n, o], stiffness: 1e4, damping: 20}}
feet: {f: {member: body, node: n, radius: 0.1 m}}
ground: {stiffness: 1e4, damping: 50, nodes: [n]}
loads: {lift: {node: o, force: [0, 1], signal: {ramp: {amplitude: 1, stop: 1 ms}, starts: {contact: n}}}}
solver: {integrator: rk4, step: 0.1 ms}
run: {duration: 0.095 s, measure: {quantities: {lifted: {of: work.loads, take: final}}}}
YAML
for method in rk4 rk4-events adaptive; do
  finds '.measured.lifted.value < -1e-3' run fall.yaml --integrator $method
done

# Without friction bristles hold nothing.
edit 's/mu_static: 0.15, mu_kinetic: 0.1/mu: 0/' belt.yaml gives .measured.x.value 0 1e-12 run
edit 's/mu_static: 0.15/mu_static: 0/' belt.yaml tells 2 "bristles that hold nothing" check

# What has no bristles says so.
sed 's|belt_speed: 10 mm/s|profile: [[-2, 0], [2, 0]]|' belt.yaml >bad.yaml
tells 2 "the contact of node 'block' needs a straight ground, and 'ground' is none" check bad.yaml
edit 's/mu_static: 0.15, mu_kinetic: 0.1/mu_forward: 0.1, mu_backward: 0.2/' belt.yaml tells 2 "rubs in both directions alike" check
edit 's/, relaxation: 3 ms//' belt.yaml tells 2 "relaxation" check
edit 's/presliding: 15 um/presliding: 0/' belt.yaml expect 2 check
edit 's/^run:/initial: {settle: {friction: kept}}\nrun:/' belt.yaml tells 2 "not by bristles (lugre)" run
