#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Running cables with friction at their guides, against closed forms.
. "$(dirname "$0")/lib.sh"

pi=3.141592653589793

# Atwood's machine over a fixed guide, theta = pi. While it slips the tensions are exactly e^(mu pi) apart; on
# average, but for the rope's own oscillation, a = g (m2 - m1 e^(mu pi)) / (m2 + m1 e^(mu pi)).
yaml atwood.yaml <<'YAML'
parameters: {mu: 0.1, m2: 2, h: 1 ms, c: 1e5}
gravity: [0, -9.81]
nodes: {a: {position: [0, -1], mass: 1}, g: {position: [0, 0], fixed: both}, b: {position: [0, -0.5], mass: m2}}
members: {rope: {kind: cable, nodes: [a, g, b], stiffness: c, pretension: 9.81 N, guide_friction: mu}}
solver: {integrator: rk4-events, step: h}
run: {duration: 0.3,
      measure: {quantities: {down: {of: b.y, take: change}, ratio: {of: rope.last_force / rope.force, take: final}}}}
YAML
bound="(0.1 * $pi | exp)"
by "rk4-events adaptive verlet-events euler-events rk4 verlet euler" atwood.yaml \
  .measured.ratio.value "$bound" 2e-10 '.energy.residual / .energy.exchanged' 0 2e-3
gives .measured.down.value "-0.5 * 9.81 * (2 - $bound) / (2 + $bound) * 0.09" 8e-5 run atwood.yaml --set h='0.1 ms' --set c=1e7
near '.energy.dissipated_members / -.measured.down.value' "9.81 * (1 + (2 - $bound) / (2 + $bound)) * ($bound - 1)" 0.02
# The order of the method is kept, and the balance closes at it.
drop() {
  expect 0 run atwood.yaml --set h="$1" --json
  jq .measured.down.value out
}
best=$(drop '0.125 ms') whole=$(drop '2 ms') half=$(drop '1 ms')
jq -ne "($whole - $best | fabs) / ($half - $best | fabs) > 14" >/dev/null || fail "order: $whole $half $best"
gives .energy.residual 0 1e-6 run atwood.yaml
# Within the bound it sticks: both masses hang on springs of their own.
gives .energy.dissipated_members 0 0 run atwood.yaml --set m2=1.15 --set h='0.2 ms'
near .measured.down.value 0 2e-5

# Without friction to speak of it is the running cable without.
for method in rk4-events rk4; do
  expect 0 run atwood.yaml --set mu=0 --integrator $method --json
  gives .measured.down.value "$(jq .measured.down.value out)" 1e-12 run atwood.yaml --set mu=1e-15 --integrator $method
done

# Rows between steps have the energy of the materials there, also just after the rope becomes taut.
sed 's/stiffness: c, pretension: 9.81 N/stiffness: 2000, rest_length: 1.6 m/; s/0.3,$/0.4,/; s/rk4-events/rk4/
  s/^gravity.*/&\noutput: {every: 0.1 ms, channels: [energy]}/' atwood.yaml >falls.yaml
expect 0 run falls.yaml -q -o falls
awk -F, 'NR > 1 { sum = $2 + $3 + $4 + $10; low = n ? (sum < low ? sum : low) : sum; high = n++ ? (sum > high ? sum : high) : sum }
  END { exit !(n > 3900 && high - low < 0.004) }' falls/energy.csv || fail "the balance between steps is open"

# A winch pulls in the rope at its first node, over two fixed posts that turn it by 90 deg each, against a
# spring: the tension that arrives is e^(-mu pi) of that at the winch while it pulls, and the inverse as it
# pays out far enough.
yaml winch.yaml <<'YAML'
parameters: {mu: 0.3}
nodes: {w: {position: [0, 0], fixed: both}, p: {position: [0, 1], fixed: both}, q: {position: [1, 1], fixed: both},
        m: {position: [1, 0.5], mass: 0.1, fixed: x}, e: {position: [1, -1], fixed: both}}
members: {rope: {kind: cable, nodes: [w, p, q, m], stiffness: 5 kN/m, pretension: 10 N, guide_friction: mu},
          load: {kind: spring, nodes: [m, e], stiffness: 200 N/m, damping: 4 N s/m, pretension: 10 N}}
actuators: {winch: {member: rope, signal: {sine: {amplitude: -50 mm, frequency: 0.25 Hz}}}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 0.9, measure: {quantities: {ratio: {of: rope.force / rope.last_force, take: final}}}}
YAML
gives .measured.ratio.value "(0.3 * $pi | exp)" 1e-9 run winch.yaml
near '.energy.residual / .energy.exchanged' 0 1e-8
edit 's/duration: 0.9/duration: 2.5/' winch.yaml gives .measured.ratio.value "(-0.3 * $pi | exp)" 1e-9 run
edit 's/rk4-events/rk4/' winch.yaml gives .measured.ratio.value "(0.3 * $pi | exp)" 1e-9 run
near '.energy.residual / .energy.exchanged' 0 1e-4

# A swinging net of it goes slack and taut, over a free guide that passes straight: the balance closes.
yaml slack.yaml <<'YAML'
gravity: [0, -9.81]
nodes: {a: {position: [-1, 0], fixed: both}, g1: {position: [0, 0.3], fixed: both},
        g2: {position: [1, 0.2], fixed: both}, g3: {position: [1.5, 0.4], mass: 0.1, fixed: x},
        b: {position: [2, -0.2], mass: 0.1}, c: {position: [3, 0], fixed: both}}
members: {rope: {kind: cable, nodes: [a, g1, g2, g3, b, c], stiffness: 2000, pretension: 30 N, guide_friction: 0.2},
          hold: {kind: spring, nodes: [g2, g3], stiffness: 300, damping: 2}}
actuators: {w: {member: rope, signal: {sine: {amplitude: -15 mm, frequency: 2 Hz}}}}
solver: {integrator: rk4-events, step: 0.5 ms}
run: {duration: 1, measure: {quantities: {low: {of: rope.force, take: min}}}}
YAML
gives .measured.low.value 0 0 run slack.yaml
near '.energy.residual / .energy.exchanged' 0 1e-6
edit 's/rk4-events/adaptive/' slack.yaml gives '.energy.residual / .energy.exchanged' 0 1e-6 run
edit 's/integrator: rk4-events/integrator: midpoint/' slack.yaml tells 1 'midpoint cannot step' run
edit 's/guide_friction: 0.2}/guide_friction: 0.2, damping: 2, breaks_at: 31 N}/' slack.yaml gives '.broken.rope.time | if . then 1 else 0 end' 1 0 run
near '.energy.residual / .energy.exchanged' 0 1e-4

# Statics take the guides without friction; everything else shows and writes it.
for command in modes rigidity equilibria check; do expect 0 $command slack.yaml; done
expect 0 path slack.yaml --over b.y --until 10mm
shows 0 'guide_friction: 0.2' export slack.yaml
cp out written.yaml
expect 0 run written.yaml --quiet --plot slack.svg -o slack
expect 0 view slack -o slack.html
expect 0 run slack.yaml --accuracy 1% --json
