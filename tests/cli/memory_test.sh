#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What breaks, is released or yields, against closed forms.
. "$(dirname "$0")/lib.sh"

# A latch K holds a spring k pressed by d. Released, the spring's energy goes into the mass, v = d sqrt(k/m);
# that of the latch, F^2 / 2K, is lost.
yaml latch.yaml <<'YAML'
parameters: {at: 103.7 ms}
nodes: {wall: {position: [0, 0], fixed: both}, m: {position: [0.9, 0], mass: 2, fixed: y}}
members: {push: {kind: spring, nodes: [wall, m], stiffness: 800, rest_length: 1, law: compression_only},
          latch: {kind: cable, nodes: [wall, m], stiffness: 1e5, pretension: 80, released_at: at}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 0.5, measure: {quantities: {v: {of: m.vx, take: final}, f: {of: latch.force, take: max}}}}
YAML
gives .measured.v.value 2 1e-9 run latch.yaml
near .energy.dissipated_members 0.032 1e-12 .broken.latch.time 0.1037 1e-15
near '.broken.latch.released | if . then 1 else 0 end' 1 0 .energy.residual 0 1e-8
by "adaptive verlet-events" latch.yaml .measured.v.value 2 2e-4
for method in rk4 verlet euler; do # at the end of the step, at rest until then
  edit "s/rk4-events/$method/" latch.yaml gives .measured.v.value 2 1e-3 run --set at='104 ms'
  near .broken.latch.time 0.104 1e-15 .energy.dissipated_members 0.032 1e-12
done
shows 0 'latch            103.7 ms  yes' run latch.yaml
gives '.broken | if . then 1 else 0 end' 0 0 run latch.yaml --set at='10 s' # not within the run
edit 's/rk4-events/midpoint/' latch.yaml expect 1 run
err_has 'midpoint cannot step over what breaks, is released, yields or folds; use solver.integrator rk4-events'

# A mass at the end of a string at speed u: it breaks at the force F, F^2 / 2k is lost.
yaml string.yaml <<'YAML'
nodes: {top: {position: [0, 0], fixed: both}, m: {position: [0, -1], mass: 1}}
members: {string: {kind: cable, nodes: [top, m], stiffness: 100, rest_length: 1, breaks_at: 5 N, longest: 1.5}}
initial: {velocities: {m: [0, -1]}}
solver: {integrator: rk4-events, step: 2 ms}
run: {duration: 0.7, measure: {quantities: {v: {of: m.vy, take: final}, most: {of: string.force, take: max}}}}
YAML
gives .measured.v.value '-(0.75 | sqrt)' 1e-9 run string.yaml
near '[.broken.string.time, .energy.dissipated_members]' '[(0.5 | asin / 10), 0.125]' 1e-9 .energy.elastic 0 0
by "adaptive verlet-events euler-events rk4 verlet euler" string.yaml .measured.v.value '-(0.75 | sqrt)' 0.02 \
  .broken.string.time '0.5 | asin / 10' 2.1e-3 '.energy.residual / .energy.exchanged' 0 0.03
expect 0 run string.yaml --quiet --plot string.svg -o out-string
expect 0 view out-string -o string.html
expect 0 export string.yaml
cp out written.yaml
out_has 'breaks_at: 5'
gives .measured.v.value '-(0.75 | sqrt)' 1e-9 run written.yaml
shows 0 'breaks at' check string.yaml
out_has '5 N'

# The stop carries its share of what breaks a member: 5 N = k e + 100 k (e - 20 mm).
edit 's/longest: 1.5/longest: 1.02/' string.yaml expect 0 run --json
near .energy.dissipated_members '(205 / 10100) as $e | 50 * $e * $e + 5000 * ($e - 0.02) * ($e - 0.02)' 1e-9
near .energy.residual 0 1e-9

# A hinge breaks by its moment, on either side: the arm flies on with what is left of its speed.
yaml hinge.yaml <<'YAML'
nodes: {a: {position: [-1, 0], fixed: both}, b: {position: [0, 0], fixed: both}, c: {position: [1, 0], mass: 1}}
members: {bc: {kind: bar, nodes: [b, c], stiffness: 1e5}}
hinges: {h: {nodes: [a, b, c], stiffness: 4, rest_angle: 180 deg, breaks_at: 1 N m}}
initial: {velocities: {c: [0, -1]}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 1 s, measure: {quantities: {v: {of: c.vx, take: mean}}}}
YAML
gives .broken.h.time '0.5 | asin / 2' 1e-4 run hinge.yaml
near .energy.dissipated_members 0.125 1e-9 .hinges.h.moment 0 0

# Elastic-plastic, driven by its rest length: each cycle of amplitude D loses 4 Fy (D - Fy/k).
yaml loop.yaml <<'YAML'
parameters: {h: 1 ms}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}, c: {position: [0, 1], mass: 1},
        d: {position: [1, 1], fixed: both}}
members: {e: {kind: spring, nodes: [a, b], stiffness: 1000, rest_length: 1, law: {kind: elastic_plastic, yield: 5 N}},
          f: {kind: spring, nodes: [c, d], stiffness: 10}}
actuators: {x: {member: e, signal: {sine: {amplitude: 20 mm, frequency: 1 Hz}}}}
solver: {integrator: rk4-events, step: h}
run: {duration: 3.25, measure: {quantities: {f: {of: e.force, take: final}, p: {of: e.plastic, take: final}}}}
YAML
gives .energy.dissipated_members '3 * 4 * 5 * (0.02 - 0.005) + 5 * (0.02 - 0.005)' 1e-9 run loop.yaml
near '[.measured.f.value, .measured.p.value, .energy.residual]' '[-5, -(0.02 - 0.005), 0]' 1e-9
by "adaptive verlet-events rk4 verlet euler" loop.yaml .energy.dissipated_members 0.975 2e-3 .measured.f.value -5 1e-6

# A mass that is caught: force, permanent set and losses of a bilinear hysteresis. Until it turns the work
# of the spring takes all the energy: k y^2/2 + F (x - y) + k2 (x - y)^2/2 with y = F/k.
yaml catch.yaml <<'YAML'
parameters: {h: 2 ms}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: 1}}
members:
  e: {kind: spring, nodes: [a, b], stiffness: 1000, rest_length: 1,
      law: {kind: elastic_plastic, yield: 10 N, second_stiffness: 100}}
initial: {velocities: {b: [1, 0]}}
solver: {integrator: rk4-events, step: h}
run:
  duration: 0.5
  measure: {quantities: {far: {of: b.x - 1, take: max}, x: {of: b.x, take: final}, p: {of: e.plastic, take: max}}}
YAML
far='0.01 + (-10 + (100 + 4 * 50 * (0.5 - 0.05) | sqrt)) / 100'
gives .measured.far.value "$far" 1e-7 run catch.yaml --set h='10 us'
# The set at the turn: the elongation x less (yield + k2 (x - yield / k)) / k, which is elastic.
near .measured.p.value "($far - 0.01) * 0.9" 1e-7
x_of() {
  edit "s/rk4-events/$1/" catch.yaml expect 0 run --set h="$2" --json
  jq '.measured.x.value' out
}
best=$(x_of rk4-events '0.1 ms')
order() { # METHOD STEP HALF GAIN: halving the step divides the error by GAIN at least
  one=$(x_of "$1" "$2") half=$(x_of "$1" "$3")
  jq -ne "($one - $best | fabs) / ($half - $best | fabs) >= $4" >/dev/null ||
    fail "$1: errors $(jq -nc "[$one - $best, $half - $best]")"
}
order rk4-events '4 ms' '2 ms' 12
order verlet-events '1 ms' '0.5 ms' 3
order rk4 '2 ms' '0.5 ms' 4 # of second order on average, but not from step to step
order verlet '2 ms' '0.5 ms' 4
order euler '2 ms' '0.5 ms' 4
gives .energy.residual 0 1e-6 run catch.yaml
gives .measured.far.value "$far" 1e-4 run catch.yaml --set h='2 ms' --accuracy 0.1%
near .measured.x.value "$best" 1e-3

# A cable that yields is longer afterwards; it is slack then, and pulls again only beyond its set.
edit 's/kind: spring/kind: cable/; s/second_stiffness: 100/second_stiffness: 0/' catch.yaml expect 0 run --json
near .energy.dissipated_members '0.5 - 0.05' 1e-8 # it flies back with what the spring gave, 10^2 / 2k
near '[.energy.kinetic, .measured.p.value]' '[0.05, 0.045]' 1e-8

# Pulled by 4 N and let go slowly, it keeps the set it had: 4 N are just twice the yield, no more.
yaml set.yaml <<'YAML'
nodes: {wall: {position: [0, 0], fixed: both}, hand: {position: [1, 0], mass: 1e-3, fixed: y}}
members:
  e: {kind: spring, nodes: [wall, hand], stiffness: 1000, damping: 1,
      law: {kind: elastic_plastic, yield: 2, second_stiffness: 500}}
loads: {p: {node: hand, force: [4 N, 0], signal: {table: [[0, 0], [1, 1], [2, 0]]}}}
solver: {integrator: rk4-events, step: 0.1 ms}
run: {duration: 2.5 s, measure: {quantities: {left: {of: e.stretch, take: final}, p: {of: e.plastic, take: final}}}}
YAML
gives .measured.left.value 0.002 5e-6 run set.yaml
near .measured.p.value "$(jq .measured.left.value out)" 1e-9

# A hinge likewise.
yaml bend.yaml <<'YAML'
nodes: {a: {position: [-1, 0], fixed: both}, b: {position: [0, 0], fixed: both}, c: {position: [1, 0], mass: 1}}
members: {bc: {kind: bar, nodes: [b, c], stiffness: 1e6}}
hinges: {h: {nodes: [a, b, c], stiffness: 100, rest_angle: 180 deg, law: {kind: elastic_plastic, yield: 1 N m}}}
initial: {velocities: {c: [0, 0.5]}}
solver: {integrator: rk4-events, step: 0.2 ms}
run: {duration: 0.8, measure: {quantities: {p: {of: h.plastic, take: final}}}}
YAML
gives .measured.p.value '0.125 - 0.005' 1e-4 run bend.yaml
near .energy.dissipated_members '0.125 - 0.005' 1e-4
# Stiffening as it yields: F z + k2 z^2/2 beyond the yield, of which (1 - k2/k) z remains.
sed 's/yield: 1 N m/&, second_stiffness: 20/; s/take: final/take: max/' bend.yaml >stiff.yaml
gives .measured.p.value '0.8 * (-1 + (1 + 40 * 0.12 | sqrt)) / 20' 1e-4 run stiff.yaml

# Statics take it as whole and elastic, and warn.
yaml rest.yaml <<'YAML'
gravity: [0, -10]
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -1], mass: 1}}
members: {e: {kind: spring, nodes: [a, b], stiffness: 1000, rest_length: 1, breaks_at: 8 N, damping: 5}}
initial: {settle: yes}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 0.1}
YAML
for command in equilibria modes; do
  tells 0 "member 'e' carries 10 N, above the 8 N at which it breaks; statics take it as whole" $command rest.yaml
done
tells 0 "'e' carries more than it can" path rest.yaml --over b.x --until 10mm
expect 0 rigidity rest.yaml
tells 0 "member 'e' carries 10 N at the start, above the 8 N at which it breaks; it does so at once" run rest.yaml --json
near .broken.e.time 0 0 .energy.residual 0 1e-9
sed 's/breaks_at: 8 N/law: {kind: elastic_plastic, yield: 8}/' rest.yaml >yields.yaml
tells 0 "above the 8 N at which it yields; statics take it as elastic" modes yields.yaml
tells 0 'above the 8 N at which it yields; it does so at once' run yields.yaml --json
