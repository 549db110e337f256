#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Drives and damping other than driven rest lengths, by strut run with every method, against closed forms.
. "$(dirname "$0")/lib.sh"

value() { echo ".measured.$1.value"; }
# closes PART: the energy balance, beside the energy exchanged.
closing='.energy | .residual / .exchanged'
closes() { near "$closing" 0 "$1"; }

methods="rk4 verlet euler rk4-events verlet-events euler-events adaptive midpoint"

# A constant force along a member without stiffness: x = 1 + F t^2 / (2 m), all of its work kinetic.
yaml push.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: 2}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 0}}
actuators: {push: {member: m, force: {constant: -3 N}}}
solver: {step: 1 ms}
run:
  duration: 1 s
  measure:
    quantities: {x: {of: b.x, take: final}, done: {of: work.drives, take: final}, force: {of: m.force, take: final}}
END
set -- push.yaml "$(value x)" 1.75 own "$(value done)" 2.25 '3 * own' "$(value force)" -3 0
by "euler:1e-3 euler-events:1e-3" "$@"
by "rk4:1e-12 verlet:1e-12 rk4-events:1e-12 verlet-events:1e-12 adaptive:1e-12 midpoint:1e-12" "$@" "$closing" 0 own

# A sine force beside a spring, from rest: x - 1 = F / (m (w0^2 - w^2)) (sin w t - (w / w0) sin w0 t).
yaml forced.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: 2}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 200}}
actuators: {shake: {member: m, force: {sine: {amplitude: -3 N, frequency: 1 Hz}}}}
solver: {step: 1 ms}
run: {duration: 1.3 s, measure: {quantities: {x: {of: b.x, take: final}}}}
END
motion='(6.283185307179586 as $w | 1.3 as $t |
  1 + 3 / (2 * (100 - $w * $w)) * (($w * $t | sin) - $w / 10 * (10 * $t | sin)))'
by "rk4:1e-7 rk4-events:1e-7 adaptive:1e-7 verlet:1e-5 verlet-events:1e-5 midpoint:1e-5 euler:1e-3 euler-events:1e-3" \
  forced.yaml "$(value x)" "$motion" own
gives "$(value x)" "$motion" 1e-12 run forced.yaml --step '0.2 ms'

# A moment closes a hinge where it is positive: a free arm turns by M t^2 / (2 m l^2), and the moment is
# recorded beside the hinge's own, which has neither stiffness nor damping here.
yaml turn.yaml <<'END'
bars: rigid
nodes: {top: {position: [0, 1], fixed: both}, pivot: {position: [0, 0], fixed: both},
        bob: {position: [0.5, 0], mass: 2}}
members: {rod: {kind: bar, nodes: [pivot, bob], stiffness: 1e6}}
hinges: {h: {nodes: [top, pivot, bob]}}
actuators: {motor: {hinge: h, moment: {constant: 0.5 N m}}}
solver: {integrator: rk4, step: 1 ms}
run:
  duration: 1 s
  measure:
    quantities: {turned: {of: h.angle, take: change}, moment: {of: h.moment, take: final},
                 done: {of: work.drives, take: final}}
END
gives "$(value turned)" "-0.5" 1e-9 run turn.yaml
near "$(value moment)" 0.5 0 "$(value done)" "0.25" 1e-9
closes 1e-9

# A force along a running cable acts on all of its way; statics leave it out, and a path says so.
yaml run_over.yaml <<'END'
nodes: {a: {position: [-1, 0], fixed: both}, p: {position: [0, 0], fixed: both},
        b: {position: [0, -1], fixed: x, mass: 4}}
members: {rope: {kind: cable, nodes: [a, p, b], stiffness: 0}}
actuators: {winch: {member: rope, force: {ramp: {amplitude: 8 N, stop: 1 s}}}}
solver: {integrator: adaptive, step: 10 ms, tolerance: 1e-9}
run: {duration: 1 s, measure: {quantities: {v: {of: b.vy, take: final}}}}
END
gives "$(value v)" 1 1e-9 run run_over.yaml
tells 1 "actuator 'winch' gives a force, which statics leaves out" path run_over.yaml --over winch --until 1
expect 0 check run_over.yaml

# A damping ratio: the free oscillation decays by exp(-zeta w t), of one mass and of two that are free,
# with the reduced mass; a bar's own mass counts half at each end.
yaml ratio.yaml <<'END'
mass_model: lumped
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1.5}, c: {position: [0, 2], mass: 1.5},
        d: {position: [1, 3], mass: 5.5}}
members: {one: {kind: spring, nodes: [a, b], stiffness: 200, mass: 1, damping_ratio: 0.05},
          two: {kind: spring, nodes: [c, d], stiffness: 300, mass: 1, damping_ratio: 0.1}}
initial:
  velocities: {b: [1, 0], c: [-0.53033008588991065, -0.53033008588991065], d: [0.17677669529663688, 0.17677669529663688]}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 1 s,
      measure: {quantities: {one: {of: one.stretch, take: final}, two: {of: two.stretch, take: final}}}}
END
expect 0 run ratio.yaml --json
# decayed W ZETA: the stretch after 1 s of an oscillation that begins with 1 m/s
decayed() { echo "(($1) as \$w | $2 as \$z | (\$w * (1 - \$z * \$z | sqrt)) as \$d |
  (-\$z * \$w | exp) * (\$d | sin) / \$d)"; }
near "[$(value one), $(value two)]" "[$(decayed 10 0.05), ($(decayed '300 / 1.5 | sqrt' 0.1))]" 1e-8
closes 1e-9
gives '[.modes[].damping_ratio | select(. > 0.01)] | min' 0.05 1e-9 modes ratio.yaml
near '[.modes[].damping_ratio | select(. > 0.01)] | max' 0.1 1e-9

# Rayleigh's damping of two masses between three springs that have mass: both modes decay by
# zeta = alpha / (2 w) + beta w / 2, by every method, and the ledger has what is lost.
yaml rayleigh.yaml <<'END'
parameters: {way: 1 m/s}
rayleigh: {mass: 0.8 s^-1, stiffness: 4 ms}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: 1},
        c: {position: [2, 0], fixed: y, mass: 1}, d: {position: [3, 0], fixed: both}}
members: {ab: {kind: spring, nodes: [a, b], stiffness: 100, mass: 0.6},
          bc: {kind: spring, nodes: [b, c], stiffness: 100, mass: 0.6},
          cd: {kind: spring, nodes: [c, d], stiffness: 100, mass: 0.6}}
initial: {velocities: {b: [1, 0], c: [way, 0]}}
solver: {step: 1 ms, tolerance: 1e-10}
run: {duration: 1 s, measure: {quantities: {x: {of: ab.stretch, take: final}}}}
END
slow='(100 / 1.5 | sqrt)' fast='(300 / 1.3 | sqrt)'
rate() { echo "(0.4 / $1 + 0.002 * $1)"; }
for mode in "$slow" "$fast"; do
  set -- rayleigh.yaml "$(value x)" "$(decayed "$mode" "$(rate "$mode")")" own
  by "euler:5e-3 euler-events:5e-3" "$@"
  by "rk4:1e-8 rk4-events:1e-8 adaptive:1e-8 verlet:1e-5 verlet-events:1e-5 midpoint:1e-5" "$@" "$closing" 0 1e-4
  sed -i 's/way: 1/way: -1/' rayleigh.yaml # next: against each other
done
gives '.modes[0].damping_ratio' "$(rate "$slow")" 1e-9 modes rayleigh.yaml
near '.modes[1].damping_ratio' "$(rate "$fast")" 1e-9
expect 0 check rayleigh.yaml

# A support that shakes a mass through a spring and a damper: in the steady state
# |X/Y|^2 = (1 + (2 zeta r)^2) / ((1 - r^2)^2 + (2 zeta r)^2), and with the member's consistent mass m
# ((k + m w^2 / 6)^2 + (c w)^2) / ((k - M w^2)^2 + (c w)^2) where M includes m / 3.
shaken() { # METHOD STEP MASS RUN
  yaml <<END
nodes:
  a: {position: [0, 0], fixed: y, moves: {x: shake}}
  b: {position: [1, 0], fixed: y, mass: 2}
members:
  m: {kind: spring, nodes: [a, b], stiffness: 200, damping: 8, mass: $3}
signals:
  shake: {sine: {amplitude: 10 mm, frequency: 1 Hz}}
solver: {integrator: $1, step: $2}
run:
  $4
END
}
rms='measure: {last: 1, quantities: {rms: {of: b.x - 1 m, take: rms}, x: {of: b.x, take: final}}}'
gain() { jq -nr "6.283185307179586 as \$w | 200 as \$k | (8 * \$w) as \$c | $1 as \$m |
  (2 + \$m / 3) as \$M | ((\$k + \$m / 6 * \$w * \$w) | . * .) as \$up |
  ((\$k - \$M * \$w * \$w) | . * .) as \$down |
  ((\$up + \$c * \$c) / (\$down + \$c * \$c)) | sqrt"; }
for mass in 0 1.2; do
  shaken rk4 "1 ms" $mass "periods: 14
  of: shake
  $rms" >shaken.yaml
  gives "$(value rms) / 0.01 * (2 | sqrt)" "$(gain $mass)" 1e-8 run shaken.yaml
  closes 1e-8
done

# The order of every method beside the consistent mass, from rest; the support is where its signal is,
# and its work closes the balance.
quantities='duration: 1.3 s
  measure: {quantities: {x: {of: b.x, take: final}, at: {of: a.x, take: final}}}'
shaken adaptive "10 ms, tolerance: 1e-13" 1.2 "$quantities" >shaken.yaml
expect 0 run shaken.yaml --json
exact=$(jq "$(value x)" out)
near "$(value at)" '0.01 * (2.6 * 3.141592653589793 | sin)' 1e-15
closes 1e-9
for method in rk4 verlet euler rk4-events verlet-events euler-events midpoint; do
  case $method in rk4*) power=4 ;; euler*) power=1 ;; *) power=2 ;; esac
  for step in 10 5; do
    shaken $method "$step ms" 1.2 "$quantities" >shaken.yaml
    gives "$(value at)" '0.01 * (2.6 * 3.141592653589793 | sin)' 1e-15 run shaken.yaml
    jq "$(value x) - $exact | fabs" out >error_$step
    [ $power -eq 1 ] && closes 2e-2 || closes 2e-3
  done
  jq -en "($(cat error_10)) / ($(cat error_5)) > 0.8 * pow(2; $power)" >/dev/null ||
    fail "$method: errors $(cat error_10) and $(cat error_5) of order $power"
done

# A ramp's corners are impulses on what the consistent mass couples: with the total mass M and the
# coupling m / 6, z'' M + k z = k s - m/6 s'' has z = V (t - (1 + m / (6 M)) sin(w t) / w) after a corner.
cornered() {
  shaken "$1" "$2" 1.2 "duration: 1.3 s
  measure: {quantities: {x: {of: b.x, take: final}, at: {of: a.vx, take: max}}}" |
    sed 's/damping: 8, //; s/{sine:.*/{ramp: {amplitude: 0.1, start: 0.1003, stop: 0.5}}/'
}
ramp='(0.1 / 0.3997) as $V | (200 / 2.4 | sqrt) as $w | def z(t): t - (1 + 1.2 / 6 / 2.4) * ($w * t | sin) / $w;
  1 + $V * (z(1.1997) - z(0.8))'
for method in $methods; do
  step="1 ms"
  [ "$method" != adaptive ] || step="5 ms, tolerance: 1e-11"
  cornered "$method" "$step" >cornered.yaml
  expect 0 run cornered.yaml --json
  case $method in rk4-events | adaptive) error=1e-9 ;; verlet-events | midpoint) error=1e-5 ;; *) error=1e-4 ;; esac
  near "$(value x)" "$ramp" $error
  case $method in rk4-events | adaptive | midpoint) closes 1e-9 ;; *) closes 2e-3 ;; esac
done

# Statics and settling see the support where it is at t = 0, position + signal(0); the run goes on there.
yaml lifted.yaml <<'END'
gravity: [0, -10]
nodes: {a: {position: [0, 1], fixed: x, moves: {y: {sine: {amplitude: 0.2, frequency: 1 Hz, phase: 90 deg}}}},
        b: {position: [0, 0], fixed: x, mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100, damping: 1, rest_length: 1}}
initial: {settle: true}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 0.25 s, measure: {quantities: {from: {of: b.y, take: max}, at: {of: a.y, take: final}}}}
END
gives '.equilibria[0].nodes.a[1]' 1.2 1e-12 equilibria lifted.yaml
near '.equilibria[0].nodes.b[1]' 0.1 1e-9
gives "$(value from)" 0.1 1e-6 run lifted.yaml
near "$(value at)" 1 1e-12
closes 1e-6
gives '.modes[0].angular_frequency' 10 1e-9 modes lifted.yaml
shows 0 'a: {position: [0, 1], fixed: x, moves: {y: {sine: {amplitude: 0.2, frequency: 1, phase: ' export lifted.yaml
cp out again.yaml
expect 0 export again.yaml
tail -n +3 out >one && tail -n +3 again.yaml >two && same one two

# An unbalance on a spring and a damper: the amplitude is m r w^2 / sqrt((k - M w^2)^2 + (c w)^2).
yaml unbalance.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: 1.9}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 200, damping: 8}}
unbalances: {u: {node: b, mass: 100 g, radius: 20 mm, speed: 2 Hz, phase: 30 deg}}
signals: {turn: {sine: {amplitude: 1, frequency: 2 Hz}}}
solver: {integrator: rk4, step: 0.5 ms}
run: {periods: 26, of: turn, measure: {last: 1, quantities: {rms: {of: b.x - 1 m, take: rms}}}}
END
expect 0 run unbalance.yaml --json
near "$(value rms) * (2 | sqrt)" '(12.566370614359172 as $w | (200 - 2 * $w * $w) as $a | 8 * $w | . as $b |
  0.1 * 0.02 * $w * $w / ($a * $a + $b * $b | sqrt))' 1e-11
closes 1e-8
shows 0 'u: {node: b, mass: 0.1, radius: 0.02, speed: 12.566370614359172, phase: 0.5235987755982988' export unbalance.yaml

# A free node with a mass that is spun up from rest, with a corner of the angle: the centre of mass of both
# stays where it was, as the mass moves to the other side; with weight both fall.
yaml spun.yaml <<'END'
gravity: [0, -1]
nodes: {a: {position: [0, 0], mass: 1.5}}
unbalances: {u: {node: a, mass: 0.5, radius: 0.1, angle: {ramp: {amplitude: 5 rad, start: 0.2003 s, stop: 1.2 s}}}}
solver: {step: 1 ms, tolerance: 1e-11}
run: {duration: 1 s, measure: {quantities: {x: {of: a.x, take: final}, y: {of: a.y, take: final}}}}
END
set -- spun.yaml "$(value x)" '0.025 * (1 - (5 * 0.7997 / 0.9997 | cos))' own \
  "$(value y)" '-0.025 * (5 * 0.7997 / 0.9997 | sin) - 0.5' own
by "rk4-events:1e-10 adaptive:1e-10 midpoint:1e-3" "$@" "$closing" 0 1e-9
by "rk4:1e-3 verlet:1e-3 euler:1e-3 verlet-events:1e-6 euler-events:1e-3" "$@" "$closing" 0 5e-2

# A node that moves is none of `all` that may touch a ground.
yaml touch.yaml <<'END'
gravity: [0, -9.81]
nodes: {a: {position: [0, 0.1], fixed: both, moves: {y: {sine: {amplitude: 0.2, frequency: 1 Hz}}}},
        b: {position: [1, 0.1], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100}}
ground: {stiffness: 1e4, damping: 10, nodes: [b]}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 0.5 s, measure: {quantities: {y: {of: b.y, take: final}}}}
END
expect 0 run touch.yaml --json
want=$(jq .measured.y.value out)
edit 's/, nodes: \[b\]//' touch.yaml gives .measured.y.value "$want" 0 run
sed 's/ground: \(.*\), nodes: \[b\]}/grounds: {floor: \1}, wall: {slope: 90 deg, through: [3, 0], stiffness: 1e4, nodes: all}}/' \
  touch.yaml >two.yaml
gives .measured.y.value "$want" 1e-12 run two.yaml
