#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Sensors and signals that follow them, against closed forms.
. "$(dirname "$0")/lib.sh"

# near FILTER EXPECTED TOLERANCE: the JSON in out through jq, and a number that jq computes.
near() {
  jq -e "($1) as \$got | ($2) as \$want | (\$got - \$want | fabs) <= $3" out >jq.out 2>&1 ||
    fail "$1 is $(jq -c "$1" out 2>&1), expected $(jq -n "$2") within $3"
}

# A mass under PD control, -k (x - 1 m) - c v by a load: the damped oscillator with the poles
# -c/2m +- i sqrt(k/m - (c/2m)^2), by every method at its order.
cat >pd.yaml <<'END'
strut: 1
parameters: {k: 40 N/m, c: 0.8 N s/m}
nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [1, 0], fixed: y, mass: 2 kg}
members:
  m: {nodes: [a, b], kind: spring, stiffness: 1e-12}
sensors:
  x: {position: b, along: x}
  v: {velocity: b, along: x}
loads:
  pd: {node: b, force: [1 N, 0], signal: {expression: "-(k*(x - 1 m) + c*v)/(1 N)"}}
initial: {velocities: {b: [1, 0]}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 2 s, measure: {quantities: {x: {of: x - 1 m, take: final}, v: {of: v, take: final}}}}
END
poles='(0.2) as $a | (20 - 0.04 | sqrt) as $w | '
while read -r method tolerance; do
  sed "s/integrator: rk4/integrator: $method/" pd.yaml >run.yaml
  expect 0 run run.yaml --json
  near '.measured.x.value' "$poles"'(-2*$a | exp) * (2*$w | sin) / $w' "$tolerance"
  near '.measured.v.value' "$poles"'(-2*$a | exp) * ((2*$w | cos) - $a/$w * (2*$w | sin))' "$tolerance"
  near '.energy.residual' 0 "$tolerance"
done <<'END'
rk4 1e-11
rk4-events 1e-11
adaptive 1e-8
verlet 1e-5
verlet-events 1e-5
midpoint 2e-5
euler 2e-2
euler-events 2e-2
END

# A rest length that follows its own member's length: k (1 + g) and c (1 + g), since the damper feels
# the rate that is derived from the expression. The energy balance closes with the drive's work.
cat >length.yaml <<'END'
strut: 1
parameters: {k: 40 N/m, c: 0.8 N s/m, g: 0.75}
nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [1, 0], fixed: y, mass: 2 kg}
members:
  m: {nodes: [a, b], kind: spring, stiffness: k, damping: c}
sensors:
  l: {length: m}
signals:
  error: {expression: "1 m - l"}
actuators:
  pd: {member: m, signal: {expression: g*error}}
initial: {velocities: {b: [1, 0]}}
solver: {integrator: rk4, step: 1 ms}
run:
  duration: 2 s
  measure:
    quantities: {x: {of: l - 1 m, take: final}, e: {of: error, take: final}}
END
poles='(0.35) as $a | (35 - 0.1225 | sqrt) as $w | '
while read -r method tolerance; do
  sed "s/integrator: rk4/integrator: $method/" length.yaml >run.yaml
  expect 0 run run.yaml --json
  near '.measured.x.value' "$poles"'(-2*$a | exp) * (2*$w | sin) / $w' "$tolerance"
  near '.measured.e.value' "$poles"'-(-2*$a | exp) * (2*$w | sin) / $w' "$tolerance"
  near '.energy.residual' 0 "$tolerance"
done <<'END'
rk4 1e-10
rk4-events 1e-10
adaptive 1e-8
verlet 4e-5
verlet-events 4e-5
midpoint 4e-5
euler 2e-2
euler-events 2e-2
END

# Every function in an expression has its derivative: a driven length whose value is that of a sine
# moves its mass as the sine does, through the damper alone.
cat >functions.yaml <<'END'
strut: 1
nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [1, 0], fixed: y, mass: 2 kg}
members:
  m: {nodes: [a, b], kind: spring, damping: 3}
actuators:
  d:
    member: m
    signal: {sine: {amplitude: 0.3 m, frequency: 1 Hz}}
solver: {integrator: rk4, step: 2 ms}
run: {duration: 0.7 s, measure: {quantities: {x: {of: b.x, take: final}}}}
END
expect 0 run functions.yaml --json
want=$(jq .measured.x.value out)
while read -r expression; do
  sed "s|signal: .*|signal: {expression: \"$expression\"}|" functions.yaml >run.yaml
  expect 0 run run.yaml --json
  near '.measured.x.value' "$want" 1e-8
done <<'END'
0.3 m*sin(2*pi*1 Hz*t)
0.3 m*cos(360 deg*1 Hz*t - 90 deg)
-(0.3 m)*(-sin(360 deg*t/(1 s)))
0.15*(3 m - 1 m)*sin(2*pi*1 Hz*t)^1
0.3 m*tan(2*pi*1 Hz*t)*cos(2*pi*1 Hz*t)
0.3 m*exp(log(5 + sin(2*pi*1 Hz*t))) - 1.5 m
0.3 m*10^(log10(5 + sin(2*pi*1 Hz*t))) - 1.5 m
0.3 m*sqrt((2 + sin(2*pi*1 Hz*t))^2) - 0.6 m
0.3 m*hypot(sin(2*pi*1 Hz*t) + 2, 0) - 0.6 m
0.3 m*asin(0.5*sin(2*pi*1 Hz*t))/(1 rad)*0 + 0.3 m*sin(asin(0.5*sin(2*pi*1 Hz*t)))*2
0.3 m*cos(acos(0.5*sin(2*pi*1 Hz*t)))*2
0.3 m*tan(atan(sin(2*pi*1 Hz*t)))
0.3 m*tan(atan2(sin(2*pi*1 Hz*t), 1))
max(0.3 m*sin(2*pi*1 Hz*t), -1 m) + min(0 m, abs(1 m)) + floor(0.5)*1 m
END

# Sensors of a hinge and a contact, and energies as drives of loads: all methods say the same.
cat >all.yaml <<'END'
strut: 1
gravity: [0, -9.81]
nodes:
  a: {position: [0, 0.5], fixed: both}
  b: {position: [0.3, 0.5], mass: 0.2}
  c: {position: [0.6, 0.4], mass: 0.2}
members:
  ab: {nodes: [a, b], kind: spring, stiffness: 900, damping: 2}
  bc: {nodes: [b, c], kind: spring, stiffness: 900, damping: 2}
hinges:
  h: {nodes: [a, b, c], stiffness: 1, damping: 0.01}
ground: {stiffness: 1e4, damping: 5, nodes: [c]}
sensors:
  touch: {contact: c}
  angle: {angle: h}
  tension: {force: ab}
  kinetic: {energy: kinetic}
  elastic: {energy: elastic}
  total: {energy: total}
actuators:
  bend: {hinge: h, signal: {expression: "0.2*(angle - 180 deg)"}}
loads:
  lift: {node: c, force: [0, 1 N], signal: {expression: 2*touch + tension/(10 N)}}
  push: {node: b, force: [1 N, 0], signal: {expression: (kinetic + elastic - total)/(1 J)}}
solver: {integrator: rk4-events, step: 0.25 ms}
run: {duration: 0.5 s, measure: {quantities: {y: {of: b.y, take: final}}}}
END
expect 0 run all.yaml --json
want=$(jq .measured.y.value out)
near '.energy.residual' 0 1e-6
for method in adaptive verlet-events rk4; do
  sed "s/integrator: rk4-events/integrator: $method/" all.yaml >run.yaml
  expect 0 run run.yaml --json
  near '.measured.y.value' "$want" 2e-4
done

# What is written reads back to the same run; statics, figures, sweeps and pages know such scenes.
for scene in pd length all; do
  expect 0 run $scene.yaml --json
  jq 'del(.wall_time, .scene, .source)' out >first
  expect 0 write $scene.yaml
  cp out written.yaml
  expect 0 write written.yaml
  sed 1d out >twice
  sed 1d written.yaml | cmp -s - twice || fail "$scene written twice differs"
  expect 0 check $scene.yaml
  out_has "  sensors              for a sensor"
done
expect 0 run length.yaml -o results --plot run.svg
expect 0 view results -o page.html
expect 0 equilibria length.yaml
expect 0 modes length.yaml

[ $failures -eq 0 ] || exit 1
