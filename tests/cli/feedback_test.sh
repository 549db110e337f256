#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Sensors and signals that follow them, against closed forms.
. "$(dirname "$0")/lib.sh"

# beside FILE MEMBER [MASS]: a mass of 2 kg, or MASS, on the x axis, 1 m from a wall, which a spring with the keys
# MEMBER ties to it; the rest of the scene from the standard input.
beside() {
  { cat <<END && cat; } | yaml "$1"
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: ${3:-2 kg}}}
members: {m: {nodes: [a, b], kind: spring, $2}}
END
}

# kicked FILE MEMBER [MASS]: the same, which starts at 1 m/s, by rk4 with a step of 1 ms.
kicked() {
  { printf 'initial: {velocities: {b: [1, 0]}}\nsolver: {integrator: rk4, step: 1 ms}\n' && cat; } | beside "$@"
}

# A mass under PD control, -k (x - 1 m) - c v by a load: the damped oscillator with the poles
# -c/2m +- i sqrt(k/m - (c/2m)^2), by every method at its order.
kicked pd.yaml 'stiffness: 1e-12' <<'END'
parameters: {k: 40 N/m, c: 0.8 N s/m}
sensors: {x: {position: b, along: x}, v: {velocity: b, along: x}}
loads: {pd: {node: b, force: [1 N, 0], signal: {expression: "-(k*(x - 1 m) + c*v)/(1 N)"}}}
run: {duration: 2 s, measure: {quantities: {x: {of: x - 1 m, take: final}, v: {of: v, take: final}}}}
END
poles='(0.2) as $a | (20 - 0.04 | sqrt) as $w | '
by "rk4:1e-11 rk4-events:1e-11 adaptive:1e-8 verlet:1e-5 verlet-events:1e-5 midpoint:2e-5 euler:2e-2 euler-events:2e-2" pd.yaml \
  .measured.x.value "$poles"'(-2*$a | exp) * (2*$w | sin) / $w' own \
  .measured.v.value "$poles"'(-2*$a | exp) * ((2*$w | cos) - $a/$w * (2*$w | sin))' own .energy.residual 0 own

# A rest length that follows its own member's length: k (1 + g) and c (1 + g), since the damper feels
# the rate that is derived from the expression. The energy balance closes with the drive's work.
kicked length.yaml 'stiffness: k, damping: c' <<'END'
parameters: {k: 40 N/m, c: 0.8 N s/m, g: 0.75}
sensors: {l: {length: m}}
signals: {error: {expression: "1 m - l"}}
actuators: {pd: {member: m, signal: {expression: g*error}}}
run: {duration: 2 s, measure: {quantities: {x: {of: l - 1 m, take: final}, e: {of: error, take: final}}}}
END
poles='(0.35) as $a | (35 - 0.1225 | sqrt) as $w | '
by "rk4:1e-10 rk4-events:1e-10 adaptive:1e-8 verlet:4e-5 verlet-events:4e-5 midpoint:4e-5 euler:2e-2 euler-events:2e-2" length.yaml \
  .measured.x.value "$poles"'(-2*$a | exp) * (2*$w | sin) / $w' own \
  .measured.e.value "$poles"'-(-2*$a | exp) * (2*$w | sin) / $w' own .energy.residual 0 own

# The same poles from an actuator that gives a force, by the length and its rate.
kicked force.yaml 'stiffness: 1e-12' <<'END'
sensors: {l: {length: m}}
actuators: {pd: {member: m, force: {expression: "70 N/m*(l - 1 m) + 1.4 N s/m*rate(l)"}}}
run: {duration: 2 s, measure: {quantities: {x: {of: l - 1 m, take: final}}}}
END
by "rk4:1e-10 rk4-events:1e-10 adaptive:1e-8 verlet:4e-5 midpoint:4e-5 euler:2e-2" force.yaml \
  .measured.x.value "$poles"'(-2*$a | exp) * (2*$w | sin) / $w' own .energy.residual 0 own

# Every function in an expression has its derivative: a driven length whose value is that of a sine
# moves its mass as the sine does, through the damper alone.
beside functions.yaml 'damping: 3' <<'END'
actuators: {d: {member: m, signal: {sine: {amplitude: 0.3 m, frequency: 1 Hz}}}}
solver: {integrator: rk4, step: 2 ms}
run: {duration: 0.7 s, measure: {quantities: {x: {of: b.x, take: final}}}}
END
expect 0 run functions.yaml --json
want=$(jq .measured.x.value out)
while read -r expression; do
  edit "s|signal: .*|signal: {expression: \"$expression\"}}}|" functions.yaml gives '.measured.x.value' "$want" 1e-8 run
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
yaml all.yaml <<'END'
gravity: [0, -9.81]
nodes: {a: {position: [0, 0.5], fixed: both}, b: {position: [0.3, 0.5], mass: 0.2},
        c: {position: [0.6, 0.4], mass: 0.2}}
members: {ab: {nodes: [a, b], kind: spring, stiffness: 900, damping: 2},
          bc: {nodes: [b, c], kind: spring, stiffness: 900, damping: 2}}
hinges: {h: {nodes: [a, b, c], stiffness: 1, damping: 0.01}}
ground: {stiffness: 1e4, damping: 5, nodes: [c]}
sensors: {touch: {contact: c}, angle: {angle: h}, tension: {force: ab}, kinetic: {energy: kinetic},
          elastic: {energy: elastic}, total: {energy: total}}
actuators: {bend: {hinge: h, signal: {expression: "0.2*(angle - 180 deg)"}}}
loads: {lift: {node: c, force: [0, 1 N], signal: {expression: 2*touch + tension/(10 N)}},
        push: {node: b, force: [1 N, 0], signal: {expression: (kinetic + elastic - total)/(1 J)}}}
solver: {integrator: rk4-events, step: 0.25 ms}
run: {duration: 0.5 s, measure: {quantities: {y: {of: b.y, take: final}}}}
END
expect 0 run all.yaml --json
want=$(jq .measured.y.value out)
near '.energy.residual' 0 1e-6
by "adaptive verlet-events rk4" all.yaml .measured.y.value "$want" 2e-4

# A lag of a constant that begins at 0: 1 - e^{-t/tau}, by every method at its order.
yaml lag.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both, mass: 2 kg}}
members: {m: {nodes: [a, b], kind: spring, stiffness: 40, damping: 0.3}}
signals: {slow: {constant: 10 mm, lag: 0.5 s}}
actuators: {d: {member: m, signal: slow}}
solver: {integrator: rk4, step: 10 ms}
run: {duration: 1 s, measure: {quantities: {z: {of: slow, take: final}, f: {of: m.force, take: final}}}}
END
by "rk4:1e-10 rk4-events:1e-10 adaptive:1e-10 verlet:1e-6 verlet-events:1e-6 midpoint:1e-6 euler:1e-4 euler-events:1e-4" lag.yaml \
  .measured.z.value '0.01 * (1 - (-2 | exp))' own \
  .measured.f.value '-40 * 0.01 * (1 - (-2 | exp)) - 0.3 * 0.02 * (-2 | exp)' '40 * own' .energy.residual 0 own

# Two oscillators lock where their frequencies differ by less than twice the coupling, with the phase
# difference arcsin(dw / 2K); else they drift apart at sqrt(dw^2 - 4 K^2) on average.
beside oscillators.yaml 'stiffness: 40, damping: 0.3' <<'END'
parameters: {df: 0.4 Hz}
oscillators: {o1: {frequency: 1 Hz, coupling: {o2: 2 rad/s}},
              o2: {frequency: 1 Hz + df, phase: 20 deg, coupling: {o1: 2 rad/s}}}
actuators: {d: {member: m, signal: {expression: 10 mm*sin(o1)}}}
solver: {integrator: rk4, step: 5 ms}
run: {duration: 100 s, measure: {quantities: {x: {of: b.x - 1 m, take: final},
        lag: {of: o2 - o1, take: final}, drift: {of: o2 - o1, take: rate}}}}
END
by "rk4 verlet euler midpoint rk4-events adaptive" oscillators.yaml \
  .measured.lag.value '0.4 * 6.283185307179586 / 4 | asin' 1e-8
gives '.measured.drift.value' '6.283185307179586 * 6.283185307179586 - 16 | sqrt' 0.05 run oscillators.yaml --set 'df=1 Hz'
sed 's/coupling: {o2: 2 rad\/s}/coupling: {o2: 2 rad\/s}, bias: 90 deg/; s/coupling: {o1: 2 rad\/s}/coupling: {o1: 2 rad\/s}, bias: -90 deg/' \
  oscillators.yaml >run.yaml
gives '.measured.lag.value' '1.5707963267948966' 1e-8 run run.yaml --set 'df=0 Hz'
sed 's/coupling: {o2: 2 rad\/s}/feedback: 0.5 rad\/s/; s/coupling: {o1: 2 rad\/s}/feedback: -0.5 rad\/s/' \
  oscillators.yaml >run.yaml
gives '.measured.drift.value' '0.4 * 6.283185307179586 - 1' 1e-8 run run.yaml

# Sampled P control of a damped mass by a load, x'' = -x' + u, u = -K x at the samples: with e = e^{-T}
# stable below K = (1 - e) / (1 - e - T e), 4.362 for T = 0.5 s; each sample is that of the exact map.
beside sampled.yaml 'damping: 1' '1 kg' <<'END'
parameters: {K: 4.3}
sensors: {x: {position: b, along: x}}
loads: {p: {node: b, force: [1 N, 0], signal: {expression: -K*(x - 1 m)/(1 m), every: 500 ms}}}
initial: {velocities: {b: [1, 0]}}
solver: {integrator: rk4, step: 10 ms}
run: {duration: 100 s,
      measure: {last: 10 s, quantities: {x: {of: x - 1 m, take: final}, most: {of: abs(x - 1 m), take: max}}}}
END
map='(-0.5 | exp) as $e | reduce range(200) as $n ([0, 1];
  (-$K * .[0]) as $u | [.[0] + (1 - $e) * .[1] + (0.5 - 1 + $e) * $u, $e * .[1] + (1 - $e) * $u]) | .[0]'
for method in rk4 rk4-events adaptive; do
  for gain in 4.2 4.5; do
    gives '.measured.x.value' "$gain as \$K | $map" 1e-5 run sampled.yaml --integrator $method --set "K=$gain"
  done
done
for gain in 4.2 4.5; do
  finds ".measured.most.value | if $gain < 4.362 then . < 0.3 else . > 1.2 end" run sampled.yaml --set "K=$gain"
done
# Samples that a fixed step would miss are refused; a method with events stops at them.
sed 's/every: 500 ms/every: 125 ms/' sampled.yaml >run.yaml
expect 1 run run.yaml
err_has 'is sampled every 0.125 s, which is no multiple of the step of 0.01 s that rk4 takes; choose a step of 0.00961538462 s, or a method with events'
edit 's/integrator: rk4/integrator: rk4-events/' run.yaml expect 0 run --set K=1 --json
want=$(jq .measured.x.value out)
edit 's/step: 10 ms/step: 12.5 ms/' run.yaml gives '.measured.x.value' "$want" 1e-9 run --set K=1

# A held rest length jumps at each sample; what that does to the elastic energy is work of the drive.
kicked held.yaml 'stiffness: 40, damping: 1' '1 kg' <<'END'
sensors: {x: {position: b, along: x}}
actuators: {d: {member: m, signal: {expression: -0.3*(x - 1 m), every: 100 ms}}}
run: {duration: 2.05 s, measure: {quantities: {x: {of: x, take: final}}}}
END
expect 0 run held.yaml --json
want=$(jq .measured.x.value out)
by "rk4:1e-9 rk4-events:1e-9 adaptive:1e-9 verlet:2e-5 verlet-events:2e-5 midpoint:2e-5 euler:1e-2 euler-events:1e-2" held.yaml \
  .energy.residual 0 own .measured.x.value "$want" own

# A PI controller of a length against the poles of the loop: m x'' + c x' + k x = k u with
# u = g e + i I, I' = e: in rest e = 0. And with limits it does not wind up.
beside pi.yaml 'stiffness: 40, damping: 4' <<'END'
sensors: {l: {length: m}}
controllers: {c: {sensor: l, target: 1.1 m, gain: 0.5, integral: 1 Hz, most: 0.3 m, least: -0.3 m}}
actuators: {d: {member: m, signal: c}}
solver: {integrator: rk4, step: 5 ms}
run: {duration: 40 s,
      measure: {quantities: {x: {of: l, take: final}, i: {of: c_integral, take: final}, s: {of: c, take: max}}}}
END
by "rk4 midpoint rk4-events" pi.yaml .measured.x.value 1.1 1e-9 .measured.i.value 0.1 1e-9
gives '.energy.residual' 0 1e-7 run pi.yaml
edit 's/target: 1.1 m/target: 1.6 m/' pi.yaml expect 0 run --json
near '.measured.s.value' 0.3 1e-12 '.measured.x.value' 1.3 1e-6
edit 's/most: 0.3 m, least: -0.3 m/every: 50 ms, derivative: 0.01 s/' pi.yaml gives '.measured.x.value' 1.1 1e-6 run

# A state of one's own: van der Pol's oscillator, by all methods of high order alike.
beside state.yaml 'stiffness: 40, damping: 0.3' <<'END'
sensors: {f: {force: m}}
states: {z: {rate: w, start: 1 m}, w: {rate: "(1 - (z/(1 m))^2)*w/(1 s) - z/(1 s^2) + 1e-3*f/(1 kg)", start: 0 m/s}}
actuators: {d: {member: m, signal: {expression: 0.05*z}}}
solver: {integrator: rk4-events, step: 5 ms}
run: {duration: 10 s, measure: {quantities: {z: {of: z, take: final}}}}
END
sed 's/0.05\*z/0.05*w*1 s/' state.yaml >damped.yaml
tells 2 "the rate of the rest length that actuator 'd' drives follows sensor 'f', the force of a member with a damper" check damped.yaml
sed 's/, damping: 0.3//' damped.yaml >free.yaml
for scene in state free; do
  gives '.energy.residual' 0 1e-8 run $scene.yaml
  by "rk4 adaptive" $scene.yaml .measured.z.value "$(jq .measured.z.value out)" 1e-7
done

# A Maxwell branch between held nodes relaxes as e^{-t k/c}; what it has stored is lost in the dashpot.
yaml maxwell.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both, mass: 1 kg}}
members: {m: {nodes: [a, b], kind: spring, stiffness: 10, maxwell: {stiffness: 50 N/m, damping: 25 N s/m, force: 2 N}}}
solver: {integrator: rk4, step: 10 ms}
run: {duration: 1 s, measure: {quantities: {f: {of: m.force, take: final}, e: {of: energy.elastic, take: final}, l: {of: losses.members, take: final}}}}
END
by "rk4:1e-8 rk4-events:1e-8 adaptive:1e-8 verlet:1e-4 verlet-events:1e-4 midpoint:1e-4 euler:1e-2 euler-events:1e-2" maxwell.yaml \
  .measured.f.value '2 * (-2 | exp)' own \
  '.measured | [.e, .l | .value]' '[(4 * (-4 | exp) / 100), (0.04 * (1 - (-4 | exp)))]' own
# Shaken by its rest length with amplitude A at w it loses pi A^2 k w T / (1 + w^2 T^2) in a cycle, which
# the drive does; and a free mass on it keeps the balance.
sed 's/, force: 2 N//; s/damping: 25 N s\/m/time: 0.5 s/; s/duration: 1 s/duration: 10 s/
  s/^solver:/actuators: {d: {member: m, signal: {sine: {amplitude: 10 mm, frequency: 1 Hz}}}}\n&/
  s/quantities: {/last: 1 s, quantities: {cycle: {of: losses.members, take: change}, /' maxwell.yaml >shaken.yaml
expect 0 run shaken.yaml --json
near '.measured.cycle.value' \
  '(3.141592653589793 * 1e-4 * 50) as $a | 3.141592653589793 as $wt | $a * $wt / (1 + $wt * $wt)' 1e-8
near '.energy.residual' 0 1e-7
sed 's/b: {position: \[1, 0\], fixed: both/b: {position: [1, 0], fixed: y/' shaken.yaml >loose.yaml
gives '.energy.residual' 0 1e-6 run loose.yaml
want=$(jq .measured.cycle.value out)
sed -i 's/step: 10 ms/step: 1 ms/' loose.yaml
by "midpoint rk4-events adaptive verlet" loose.yaml .measured.cycle.value "$want" 4e-6 .energy.residual 0 1e-5

# A signal that a touchdown starts plays from that moment on, sqrt(2 h / g), exactly with events, and one that
# a sensor starts from where that passes its level.
yaml starts.yaml <<'END'
gravity: [0, -9.81]
nodes: {a: {position: [0, 1], mass: 1}, c: {position: [3, 0], fixed: both},
        d: {position: [4, 0], fixed: both, mass: 1}}
members: {m: {nodes: [c, d], kind: spring, stiffness: 40, damping: 1}}
ground: {stiffness: 1e5, nodes: [a]}
sensors: {y: {position: a, along: y}}
signals: {kick: {sine: {amplitude: 10 mm, frequency: 1 Hz}, starts: {contact: a}},
          late: {ramp: {amplitude: 5 mm, stop: 1 s}, starts: {sensor: y, below: 0.5 m}}}
actuators: {d: {member: m, signal: {sum: [kick, late]}}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 0.6 s, measure: {quantities: {kick: {of: kick, take: final}, late: {of: late, take: final}}}}
END
by "rk4-events:1e-13 verlet-events:1e-8 adaptive:1e-13" starts.yaml .measured.late.value '0.005 * (0.6 - (1 / 9.81 | sqrt))' own \
  .measured.kick.value '0.01 * (6.283185307179586 * (0.6 - (2 / 9.81 | sqrt)) | sin)' 1e-12
edit 's/position: \[0, 1\]/position: [0, 0]/' starts.yaml gives '.measured.kick.value' '0.01 * (6.283185307179586 * 0.6 | sin)' 1e-9 run
by rk4 starts.yaml .measured.kick.value '0.01 * (6.283185307179586 * (0.6 - (2 / 9.81 | sqrt)) | sin)' 4e-5
# A node touches whichever of its grounds it falls on, not the first alone.
yaml grounds.yaml <<'END'
gravity: [0, -9.81]
nodes: {a: {position: [0, 10 mm], mass: 1}}
grounds: {wall: {slope: 90 deg, through: [1, 0], stiffness: 1e4}, floor: {stiffness: 1e4, damping: 200}}
sensors: {touch: {contact: a}}
signals: {go: {constant: 1, starts: {contact: a}}}
loads: {push: {node: a, force: [1, 0], signal: go}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 1 s, measure: {quantities: {touch: {of: touch, take: final}, x: {of: a.x, take: final}}}}
END
by "rk4-events:1e-9 adaptive:1e-9 rk4:1e-3" grounds.yaml .measured.touch.value 1 0 \
  .measured.x.value '0.5 * (1 - (0.02 / 9.81 | sqrt)) * (1 - (0.02 / 9.81 | sqrt))' own
# With `each` it starts again at every touchdown; the energy of the jumps is work of the drive.
sed 's/starts: {contact: a}/starts: {contact: a, each: yes}/; s/duration: 0.6 s/duration: 1.6 s/
  s/integrator: rk4-events/integrator: adaptive/; s/sine: {amplitude: 10 mm, frequency: 1 Hz}/constant: 10 mm/' starts.yaml >run.yaml
gives '.energy.residual' 0 1e-4 run run.yaml
sed 's/starts: {contact: a}/starts: {contact: a, each: yes}/; s/duration: 0.6 s/duration: 1.6 s/
  s/integrator: rk4-events/integrator: adaptive/' starts.yaml >run.yaml
gives '.measured.kick.value' '0.01 * (6.283185307179586 * (1.6 - 3 * (2 / 9.81 | sqrt)) | sin)' 1e-3 run run.yaml

# Settling knows nothing of signals and states, whose time begins with the run; a Maxwell branch has
# relaxed there, and begins with its own force.
sed 's/^solver:/initial: {settle: true}\n&/; s/fixed: y/fixed: y, mass: 1 kg/; s/, mass: 1 kg, mass: 2 kg/, mass: 2 kg/' pi.yaml >run.yaml
gives '.measured.x.value' 1.1 1e-9 run run.yaml
edit 's/^solver:/initial: {settle: {limit: 1000 s}}\n&/' oscillators.yaml gives '.measured.lag.value' '0.4 * 6.283185307179586 / 4 | asin' 1e-8 run
edit 's/^solver:/initial: {settle: true}\n&/' maxwell.yaml gives '.measured.f.value' '2 * (-2 | exp)' 1e-8 run

# Loops that are unstable, and states that run away, are stopped with name and time.
edit 's/-0.3\*/-10*/; s/duration: 2.05 s/duration: 60 s/' held.yaml tells 3 "node 'b' left all bounds at t = " run
err_has 'look for a loop of sensors and drives that is unstable'
sed 's/{rate: w, start/{rate: "z^2\/(1 m s)", start/; s/z\/(1 s^2)/w*0\/(1 s)/; s/0.05\*z/0.05*w*0*1 s/; s/1e-3\*f/0*f/' free.yaml >run.yaml
tells 3 "state 'z' is no longer a finite number at t = " run run.yaml

# The largest step counts Maxwell branches, as stiff as they are in fast motions, sqrt((k + K)/m), and
# what relaxes by itself; it knows nothing of feedback, and so do modes, and both say so.
beside branch.yaml 'stiffness: 10, maxwell: {stiffness: 10 kN/m, time: 0.5 s}' '1' <<'END'
initial: {velocities: {b: [0.1, 0]}}
solver: {integrator: rk4, step: 20 ms}
run: {duration: 1 s}
END
gives .step_limit '8 / 10010 | sqrt' 1e-9 run branch.yaml
edit 's/20 ms/29 ms/' branch.yaml tells 3 'is above the largest stable step of rk4, 0.02827 s' run
edit 's/time: 0.5 s/time: 5 ms/' branch.yaml tells 3 'is above the largest stable step of rk4, 0.01393 s' run
shows 0 'Maxwell branches, which have relaxed' modes branch.yaml
edit 's/constant: 10 mm, lag: 0.5 s/constant: 10 mm, lag: 2 ms/' lag.yaml tells 3 'is above the largest stable step of rk4, 0.005571 s' run
shows 0 'the feedback of sensors' modes pd.yaml
shows 0 'not counted in this frequency and these steps' check pd.yaml
shows 0 'without feedback' run pd.yaml

# Sensors of cells, distances, contacts and collisions are the columns of the same things, all the way.
yaml sensed.yaml <<'END'
gravity: [0, -9.81]
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}, top: {position: [0.5, 1], mass: 1},
        ball: {position: [0.5, 1.1], mass: 0.3}}
members: {left: {kind: spring, nodes: [a, top], stiffness: 30, damping: 0.3},
          right: {kind: spring, nodes: [b, top], stiffness: 30}}
cells: {air: {nodes: [a, b, top], gas: {kind: isothermal, pressure: 5 N/m, outside: 5 N/m}}}
collisions: {hit: {nodes: [top, ball], thickness: 0.15, stiffness: 500, damping: 2}}
distances: {wide: {nodes: [ball, top], along: x, stiffness: 3}}
ground: {height: 0.93, stiffness: 200, damping: 3, friction: {law: none}, nodes: [top]}
sensors: {area: {area: air}, p: {pressure: air}, d: {distance: wide}, c: {collision_force: hit},
          n: {contact_force: top}}
signals: {lift: {expression: "(n + c + 0.1*p*(1 m))/(10 N) + rate(area)/(1 m^2/s) + rate(d)/(1 m/s)"}}
loads: {lift: {node: ball, force: [0.2 N, 1 N], signal: lift}}
initial: {velocities: {ball: [0.1, 0], top: [0, 0.5]}}
solver: {integrator: rk4, step: 0.1 ms}
run: {duration: 1 s, measure: {quantities: {
  area: {of: abs(area/(1 m^2) - air.area/(1 m^2)), take: max}, p: {of: abs(p/(1 N/m) - air.pressure/(1 N/m)), take: max},
  d: {of: abs(d/(1 m) - wide.distance/(1 m)), take: max}, c: {of: abs(c/(1 N) - hit.force/(1 N)), take: max},
  n: {of: abs(n/(1 N) - top.normal/(1 N)), take: max}, pushed: {of: n, take: max}, hit: {of: c, take: max}, y: {of: ball.y, take: final}}}}
END
gives '.measured | [.area, .p, .d, .c, .n | .value]' '[0, 0, 0, 0, 0]' 1e-12 run sensed.yaml
holds '.measured.pushed.value > 1 and .measured.hit.value > 1'
by "rk4-events adaptive verlet" sensed.yaml .measured.y.value "$(jq .measured.y.value out)" 1e-4
# a load that lifts a weight from the ground as the ground pushes: it carries half of it
yaml half.yaml <<'END'
gravity: [0, -10]
nodes: {a: {position: [0, 0], mass: 2}}
ground: {stiffness: 1000, damping: 50}
sensors: {n: {contact_force: a}}
loads: {lift: {node: a, force: [0, 1 N], signal: {expression: n/(1 N)}}}
solver: {integrator: rk4, step: 0.1 ms}
run: {duration: 3 s, measure: {quantities: {n: {of: n, take: final}}}}
END
gives .measured.n.value 10 1e-6 run half.yaml

# A network is its formula.
cat >brain.csv <<'END'
# two inputs, two neurons with their biases
0.5, -1.2, 0.1
0.8, 0.3 ,-0.4

# two outputs
1.5, -0.7, 0
-0.3,0.9,0.2
END
kicked brain.yaml 'stiffness: 40 N/m, damping: 0.1 N s/m' <<'END'
sensors: {l: {length: m}, v: {velocity: b, along: x}}
signals: {one: {expression: "tanh(0.5*l/(1 m) - 1.2*v/(1 m/s) + 0.1)"},
          two: {expression: "tanh(0.8*l/(1 m) + 0.3*v/(1 m/s) - 0.4)"}}
controllers: {push: {network: brain.csv, inputs: [l/(1 m), v/(1 m/s)], scale: 3 N},
              pull: {network: brain.csv, inputs: [l/(1 m), v/(1 m/s)], output: 2, last: linear, scale: 2 N}}
actuators: {push: {member: m, force: push}, pull: {member: m, force: pull}}
run: {duration: 2 s, measure: {quantities: {push: {of: "abs(push/(1 N) - 3*tanh(1.5*one - 0.7*two))", take: max},
        pull: {of: "abs(pull/(2 N) - (0.9*two - 0.3*one + 0.2))", take: max}, x: {of: b.x, take: final}}}}
END
gives '.measured | [.push, .pull | .value]' '[0, 0]' 1e-12 run brain.yaml
by "rk4-events adaptive verlet" brain.yaml .measured.x.value "$(jq .measured.x.value out)" 1e-4
broken() { # CSV of the first layer, message
  printf '%s\n' "$1" >brain.csv
  tells 2 "$2" check brain.yaml
}
cp brain.csv whole.csv
broken '0.5, -1.2' "line 1: 2 numbers, expected 3: a weight for each of 2 values, and a bias"
broken '0.5, -1.2, x' "line 1: expected a number, found x"
broken '' "there is no neuron in this file"
broken '1, 2, 3' "controller 'pull' is output 2 of a network that has 1"
rm brain.csv
tells 2 "brain.csv" check brain.yaml
cp whole.csv brain.csv
edit 's/inputs: .l.(1 m), /inputs: [l, /' brain.yaml tells 2 "expected a number without unit for 'inputs' of controller 'push', found a length" check

# What is written reads back to the same run; statics, figures, sweeps and pages know such scenes.
for scene in pd length force all lag oscillators sampled held pi free maxwell shaken starts sensed half brain; do
  expect 0 run $scene.yaml --json
  jq 'del(.wall_time, .scene, .source)' out >first
  writes_back $scene.yaml
  expect 0 check $scene.yaml
done
expect 0 run length.yaml -o results --plot run.svg
expect 0 view results -o page.html
expect 0 equilibria length.yaml
expect 0 modes length.yaml
