#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Relays with hysteresis as controllers, against closed forms.
. "$(dirname "$0")/lib.sh"

# A thermostat: T' = (u - T) / tau, u = U until T rises to its upper threshold, then 0 until it falls to
# the lower one. A cycle lasts tau (ln((U - low) / (U - high)) + ln(high / low)), 0.884 s.
yaml thermostat.yaml <<'END'
parameters: {low: 18, high: 22, full: 60, tau: 3 s}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}}
members: {m: {nodes: [a, b], kind: spring, stiffness: 1}}
states: {T: {rate: "(heater - T)/tau", start: low}}
controllers: {heater: {kind: relay, of: T, on_below: low, off_above: high, on_value: full, on_at_start: yes}}
solver: {integrator: rk4-events, step: 10 ms}
run: {duration: 10 s,
      measure: {quantities: {T: {of: T, take: final}, top: {of: T, take: max}, u: {of: heater, take: final}}}}
END
cycle='(3 * ((42/38 | log) + (22/18 | log))) as $p | (3 * (42/38 | log)) as $up
  | (10 - (10 / $p | floor) * $p) as $t
  | if $t < $up then 60 - 42 * (-$t/3 | exp) else 22 * (($up - $t)/3 | exp) end'
by "rk4-events:1e-9 adaptive:1e-10 verlet-events:3e-3 euler-events:0.3 rk4:0.5 verlet:0.5 midpoint:0.5 euler:0.5" \
  thermostat.yaml .measured.T.value "$cycle" own .measured.top.value 22 0.2
# Off at the start it cools to the lower threshold first, which is where it starts.
edit 's/, on_at_start: yes//; s/start: low/start: 20/; s/duration: 10 s/duration: 3*log(20\/18)*1 s/' \
  thermostat.yaml gives '[.measured.T.value, .measured.top.value]' '[18, 20]' 1e-10 run
# Sampled it switches at the samples only: T(n) by the exact map.
sed 's/on_at_start: yes/on_at_start: yes, every: 200 ms/' thermostat.yaml >run.yaml
map='(-0.2/3 | exp) as $e | reduce range(50) as $n ([18, 60];
  (if .[0] < 18 then 60 elif .[0] > 22 then 0 else .[1] end) as $u
  | [$u + (.[0] - $u) * $e, $u]) | .[0]'
by "rk4 rk4-events adaptive midpoint" run.yaml .measured.T.value "$map" 1e-3

# A mass on a spring whose rest length a relay moves by d to either side, when the mass has passed h beyond
# the middle. About the present rest length it swings with an amplitude A, which each of the 8 switches
# turns into sqrt(A^2 + 4 h d): the drive does the work 2 k h d, at once.
yaml swing.yaml <<'END'
parameters: {k: 40 N/m, h: 0.1 m, d: 0.02 m}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: 2 kg}}
members: {m: {nodes: [a, b], kind: spring, stiffness: k}}
sensors: {l: {length: m}}
controllers: {kick: {kind: relay, of: l - 1 m, on_above: h, off_below: -h, on_value: -d, off_value: d}}
actuators: {drive: {member: m, signal: kick}}
initial: {velocities: {b: [0.8, 0]}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 5 s, measure: {quantities: {e: {of: energy.total, take: final}, w: {of: work.drives, take: final}}}}
END
by "rk4-events:1e-10 adaptive:1e-9 verlet-events:1e-5 euler-events:1e-2 rk4:1e-2 verlet:1e-2 midpoint:1e-2 euler:1e-2" \
  swing.yaml '[.measured.e.value, .measured.w.value, .energy.residual]' '[0.648 + 8 * 0.16, 8 * 0.16, 0]' own
# The same by a force, which does its work along the path: 2 k d between the two values.
edit 's/on_value: -d, off_value: d/on_value: k*d, off_value: -k*d/; s/signal: kick/force: kick/' swing.yaml gives .energy.residual 0 1e-10 run
# Thresholds nearer than positions are located do not switch it back; of a start at 1e6 sizes per second `implicit` finds
# slopes by differences; columns of signals and sensors have their units.
edit 's/h: 0.1 m/h: 1e-10 m/' swing.yaml gives .measured.e.value 0.648 1e-5 run --integrator verlet-events
edit 's/\[0.8, 0\]/[1e6, 0]/' swing.yaml gives .measured.e.value 1e12 1e5 run --integrator implicit
edit '$aoutput: {channels: [signal, sensor, position]}' swing.yaml expect 0 run -o units
head -qn 1 units/s*.csv >out && out_has 'kick.signal [m]' 'l.sensor [m]'
# As written it is the same scene.
expect 0 export swing.yaml
sed '/^parameters/,/^mass_model/{/^mass_model/!d}' out >once.yaml
gives .measured.e.value '0.648 + 8 * 0.16' 1e-10 run once.yaml
writes_back once.yaml
# Statics leave it out.
for command in equilibria modes; do expect 0 $command swing.yaml; done
# An accuracy that is asked for.
gives .measured.e.value '0.648 + 8 * 0.16' 2e-3 run swing.yaml --accuracy '0.1 %'
# What a relay drives may take its own input past the other threshold at once: that is refused where it
# happens, unless the relay is sampled.
yaml chatter.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: 2 kg}}
members: {m: {nodes: [a, b], kind: spring, stiffness: 40}}
sensors: {f: {force: m}}
controllers: {hold: {kind: relay, of: f, on_above: 3 N, off_below: 2 N, on_value: 0.1 m}}
actuators: {drive: {member: m, signal: hold}}
initial: {velocities: {b: [0.8, 0]}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 1 s}
END
for method in rk4-events rk4 adaptive; do
  tells 3 "relay 'hold' switches at t = 0.09" run chatter.yaml --integrator $method
  err_has "what it drives takes its own input past the other threshold at once"
done
edit 's/0.1 m}/0.1 m, every: 10 ms}/' chatter.yaml expect 0 run
edit 's/off_below: 2 N/off_below: -2 N/' chatter.yaml expect 0 run

# A bang-bang crawler: its muscle follows the relay with a lag of 1 s between +-20 mm, and the relay turns
# at +-10 mm. Its feet slide forward only: each cycle is one stroke of 20 mm. Friction of a foot, 98 mN,
# bends the muscle by 0.2 mm and damping by 0.04 mm, so that a cycle lasts 2 ln(30.24 / 9.76) s.
yaml crawler.yaml <<'END'
name: a crawler with a bang-bang drive
gravity: [0, -9.81]
nodes: {rear: {position: [0, 0], mass: 0.1 kg}, front: {position: [100 mm, 0], mass: 0.1 kg}}
members: {body: {kind: spring, nodes: [rear, front], stiffness: 500 N/m, damping: 2 N s/m}}
sensors: {l: {length: body}}
controllers: {pump: {kind: relay, of: l, on_below: 90 mm, off_above: 110 mm, on_value: 20 mm, off_value: -20 mm, on_at_start: yes}}
actuators: {muscle: {member: body, signal: {expression: pump, lag: 1 s}}}
ground: {stiffness: 1e5 N/m, damping: 100 N s/m, friction: {mu_forward: 0.1, mu_backward: 1, stick_velocity: 0.01 mm/s}}
solver: {integrator: rk4-events, step: 0.5 ms}
run: {duration: 5*2*log(3)*1 s, measure: {last: 4*2*log(3)*1 s, quantities: {rear: {of: rear.x, take: change},
        front: {of: front.x, take: change}, back: {of: rear.vx, take: min}}}}
END
by "rk4-events verlet-events" crawler.yaml .measured.back.value 0 2e-5 .energy.residual 0 1e-5 \
  '.measured | (.rear.value + .front.value) / 2' '4 * 0.02 * (3 | log) / (30.24/9.76 | log)' 8e-4
