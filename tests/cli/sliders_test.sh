#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Masses that slide along members, by strut run with every method, against closed forms and against the
# equations of one coordinate integrated here.
. "$(dirname "$0")/lib.sh"

value() { echo ".measured.$1.value"; }
closing='.energy | .residual / .exchanged'
closes() { near "$closing" 0 "$1"; }

# A free bar in space: its centre of mass goes on uniformly, whatever the mass on it does, and the bar goes
# back by the mass's part of the whole. Mass 0.5 of 1 + 1.5 + 0.3 + 0.5 kg, 0.2 of 1 m there and back.
for masses in consistent lumped; do
  yaml free.yaml <<END
mass_model: $masses
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1.5}}
members: {bar: {kind: bar, nodes: [a, b], stiffness: 100 kN/m, mass: 0.3}}
sliders: {s: {member: bar, mass: 0.5, position: 30 %, moves: {sine: {amplitude: 0.2, frequency: 1 Hz}}}}
initial: {velocities: {b: [0, 1]}}
solver: {step: 0.5 ms}
run:
  duration: 1.25 s
  measure:
    quantities: {speed_x: {of: com.vx, take: range}, speed_y: {of: com.vy, take: range},
                 way: {of: com.x, take: change}}
END
  set -- free.yaml "$(value speed_x)" 0 own "$(value speed_y)" 0 own \
    "$(value way)" '1.25 * 0.5 * 0.2 * 2 * 3.14159265358979 / 3.3'
  by "euler:1e-2 euler-events:1e-2" "$@" 3e-3 "$closing" 0 0.1
  by "verlet:1e-5 verlet-events:1e-5" "$@" own "$closing" 0 1e-3
  by "rk4:1e-9 rk4-events:1e-9 adaptive:1e-9" "$@" own "$closing" 0 1e-7
done

# Nothing turns it: the moment of momentum stays, while the mass goes along and comes back.
yaml turning.yaml <<'END'
mass_model: lumped
nodes: {a: {position: [0.5, 0.2], mass: 1}, b: {position: [1.5, 0], mass: 1.5}}
members: {bar: {kind: bar, nodes: [a, b], stiffness: 100 kN/m, damping: 10 N s/m}}
sliders: {s: {member: bar, mass: 0.5, position: 50 %, moves: {sine: {amplitude: 0.45, frequency: 1 Hz}}}}
initial: {velocities: {b: [0, 3]}}
solver: {step: 0.2 ms}
run:
  duration: 2.3 s
  measure:
    quantities: {spin: {of: a.x*a.vy - a.y*a.vx + 1.5*(b.x*b.vy - b.y*b.vx) + 0.5*(s.x*s.vy - s.y*s.vx), take: range},
                 turned: {of: bar.angle, take: change}}
END
gives "$(value spin)" 0 1e-9 run turning.yaml
near "$(value turned) > 3 | if . then 1 else 0 end" 1 0

# Corners are impulses: a mass that sets off and stops. While it moves by u the bar goes back by m u / (all).
yaml ramp.yaml <<'END'
nodes: {a: {position: [0, 0], mass: 1, fixed: y}, b: {position: [1, 0], mass: 1.5, fixed: y}}
members: {bar: {kind: bar, nodes: [a, b], stiffness: 100 kN/m, damping: 200 N s/m}}
sliders: {s: {member: bar, mass: 0.5, position: 100 mm, travel: {ramp: {amplitude: 600 mm, start: 0.1 s, stop: 0.4 s}}}}
solver: {step: 0.1 ms}
run: {duration: 0.5 s, measure: {quantities: {back: {of: a.x, take: final}, fastest: {of: com.vx, take: range}}}}
END
set -- ramp.yaml "$(value back)" '-0.6 * 0.5 / 3' own "$(value fastest)" 0
by "euler:3e-5 euler-events:3e-5 verlet:1e-5 verlet-events:1e-5" "$@" 1e-3
by "rk4:1e-5 rk4-events:1e-5 adaptive:1e-5" "$@" 1e-8
closes 1e-9

# Where the signal is constant a moving mass is one at rest: in M, or by its update. With the ground, friction
# that sticks, and a second mass on a member that shares a node.
ground() {
  yaml <<END
gravity: [1, -9.81]
nodes: {a: {position: [0, 0], mass: 0.1}, b: {position: [0.3, 0], mass: 0.2}, c: {position: [0.1, 0.2], mass: 0.1}}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 10 kN/m, damping: 5 N s/m, mass: 0.1},
          bc: {kind: bar, nodes: [b, c], stiffness: 10 kN/m, damping: 5 N s/m, mass: 0.1},
          ca: {kind: bar, nodes: [c, a], stiffness: 10 kN/m, damping: 5 N s/m}}
sliders: {s: {member: ab, mass: 0.3, position: $1}, t: {member: bc, mass: 0.2, position: $2}}
rayleigh: {mass: 0.5 s^-1}
ground: {stiffness: 10 kN/m, damping: 30 N s/m, slope: $4, friction: {$3}}
initial: {velocity: [0.5, 0]}
solver: {step: 0.2 ms}
run:
  duration: 0.6 s
  measure:
    quantities: {x: {of: com.x, take: final}, y: {of: c.y, take: final}, rubbed: {of: losses.friction, take: final},
                 lost: {of: losses.members, take: final}, kinetic: {of: energy.kinetic, take: final}}
END
}
for friction in "law: coulomb, mu: 0.3" "mu: 0.3, stick_velocity: 1 mm/s"; do
  for slope in 0 5deg; do
    ground "25 %" "60 mm" "$friction" $slope >rest.yaml
    ground "10 %, moves: {constant: 0.15}" "20 mm, travel: {constant: 40 mm}" "$friction" $slope >moving.yaml
    for method in rk4 verlet rk4-events verlet-events euler-events adaptive; do
      case "$friction $method" in *coulomb*events | *coulomb*adaptive | mu*) ;; *) continue ;; esac
      expect 0 run rest.yaml --integrator $method --json
      cp out rest.json
      expect 0 run moving.yaml --integrator $method --json
      tolerance=1e-7 # ties at the edge of the band are decided by rounding where steps do not end there
      case "$friction $method" in mu*verlet-events | mu*euler-events) tolerance=1e-3 ;; esac
      for quantity in x y rubbed lost kinetic; do
        near "$(value $quantity)" "$(jq "$(value $quantity)" rest.json)" $tolerance
      done
    done
  done
done

# A compound pendulum: rod 0.6 kg of 0.8 m, its tip 0.3 kg, the mass 0.5 kg at 50 %.
yaml pendulum.yaml <<'END'
gravity: [0, -9.81]
nodes: {pin: {position: [0, 0], fixed: both}, tip: {position: [0, -0.8], mass: 0.3}}
members: {rod: {kind: bar, nodes: [pin, tip], stiffness: 1e9 N/m, mass: 0.6}}
sliders: {s: {member: rod, mass: 0.5, position: 50 %}}
END
inertia='(0.6 * 0.64 / 3 + 0.3 * 0.64 + 0.5 * 0.16)'
gives '.modes[0].frequency' "(9.81 * (0.6 * 0.4 + 0.3 * 0.8 + 0.5 * 0.4) / $inertia | sqrt) / 6.283185307179586" 1e-7 modes pendulum.yaml
sed -i 's/position: 50 %/position: 20 %, moves: {constant: 0.3}/' pendulum.yaml
gives '.modes[0].frequency' "(9.81 * (0.6 * 0.4 + 0.3 * 0.8 + 0.5 * 0.4) / $inertia | sqrt) / 6.283185307179586" 1e-7 modes pendulum.yaml

# Statics: a supported bar sinks by the levers of the weight, where the mass is at t = 0.
yaml bridge.yaml <<'END'
gravity: [0, -9.81]
nodes: {l: {position: [0, -1], fixed: both}, r: {position: [1, -1], fixed: both},
        a: {position: [0, 0], mass: 1, fixed: x}, b: {position: [1, 0], mass: 1, fixed: x}}
members: {left: {kind: spring, nodes: [l, a], stiffness: 10 kN/m, damping: 100 N s/m},
          right: {kind: spring, nodes: [r, b], stiffness: 10 kN/m, damping: 100 N s/m},
          deck: {kind: bar, nodes: [a, b], stiffness: 1e-6 N/m}}
sliders: {s: {member: deck, mass: 2, position: 25 %, moves: {sine: {amplitude: 0.2, frequency: 1 Hz, phase: 30 deg}}}}
solver: {step: 0.1 ms}
run: {duration: 0.1 ms, measure: {quantities: {a: {of: a.y, take: min}, b: {of: b.y, take: min}}}}
initial: {settle: true}
END
gives "$(value a)" '-9.81e-4 * (1 + 2 * 0.65)' 1e-7 run bridge.yaml
near "$(value b)" '-9.81e-4 * (1 + 2 * 0.35)' 1e-7
gives '.modes[0].frequency' '(10000 / (1 + 2 * (0.65 * 0.65 + 0.35 * 0.35)) | sqrt) / 6.283185307179586' 1e-9 modes bridge.yaml
near '.modes[1].frequency' '(10000 | sqrt) / 6.283185307179586' 1e-9

# A swing that is pumped: m s(t)^2 p'' + 2 m s s' p' + m g s sin p = 0, with the tip's share of both.
awk 'BEGIN {
  pi = 3.14159265358979324; h = 1e-4; p = 0.5; w = 0
  for (n = 0; n < 20000; n++) {
    for (k = 0; k < 4; k++) {
      c = k == 0 ? 0 : k == 3 ? h : h / 2
      x = p + c * (k ? kp[k - 1] : 0); y = w + c * (k ? kw[k - 1] : 0); t = n * h + c
      s = 0.7 + 0.2 * sin(2 * pi * 1.1 * t); ds = 0.2 * 2 * pi * 1.1 * cos(2 * pi * 1.1 * t)
      kp[k] = y; kw[k] = -(2 * 2 * s * ds * y + 9.81 * (2 * s + 0.1) * sin(x)) / (2 * s * s + 0.1)
    }
    p += h / 6 * (kp[0] + 2 * kp[1] + 2 * kp[2] + kp[3])
    w += h / 6 * (kw[0] + 2 * kw[1] + 2 * kw[2] + kw[3])
  }
  printf "%.12g %.12g\n", sin(p), -cos(p) }' >swing.txt
read -r swing_x swing_y <swing.txt
yaml swing.yaml <<'END'
gravity: [0, -9.81]
nodes: {pin: {position: [0, 0], fixed: both}, tip: {position: [sin(0.5), -cos(0.5)], mass: 0.1}}
members: {rod: {kind: bar, nodes: [pin, tip], stiffness: 1e7 N/m, damping: 100 N s/m, rest_length: 1 m}}
sliders: {swinger: {member: rod, mass: 2, position: 70 %, moves: {sine: {amplitude: 0.2, frequency: 1.1 Hz}}}}
solver: {integrator: adaptive, step: 0.1 ms}
run:
  duration: 2 s
  measure: {quantities: {x: {of: tip.x, take: final}, y: {of: tip.y, take: final}, done: {of: work.drives, take: final}}}
END
set -- swing.yaml "$(value x)" "$swing_x" own "$(value y)" "$swing_y" own "$closing" 0
by "euler:3e-3 euler-events:3e-3" "$@" 1e-2
by "verlet:1e-4 verlet-events:1e-4" "$@" own
by "rk4:1e-4 rk4-events:1e-4 adaptive:1e-4" "$@" 1e-6
near "$(value done) > 1 | if . then 1 else 0 end" 1 0

# A crawler: a mass that slides to and fro in a bar on ground that rubs more backwards. The bar is as rigid:
# M x'' = -m L s'' - F, F up to mu_0 M g, 0.2 of it forwards and 0.5 backwards.
awk 'BEGIN {
  pi = 3.14159265358979324; L = 0.3; m = 0.4; M = 0.7; g = 9.81; h = 1e-5; v = 0; x = 0
  for (n = 0; n < 200000; n++) {
    t = (n + 0.5) * h
    push = m * L * 0.3 * (5 * pi) * (5 * pi) * sin(5 * pi * t) / M
    if (v == 0 && push <= 0.2 * g && push >= -0.5 * g) continue
    a = push - (v > 0 || (v == 0 && push > 0) ? 0.2 * g : -0.5 * g)
    next_v = v + h * a
    if (v * next_v < 0) next_v = 0
    x += h * (v + next_v) / 2; v = next_v
  }
  printf "%.9g\n", x }' >crawler.txt
read -r crawled <crawler.txt
crawler() {
  yaml <<END
gravity: [0, -9.81]
nodes: {a: {position: [0, 0], mass: 0.1}, b: {position: [0.3, 0], mass: 0.1}}
members: {bar: {kind: bar, nodes: [a, b], stiffness: 100 kN/m, damping: 20 N s/m, mass: 0.1}}
sliders: {s: {member: bar, mass: 0.4, position: 50 %, moves: {sine: {amplitude: 0.3, frequency: 2.5 Hz}}}}
ground: {stiffness: 100 kN/m, damping: 200 N s/m, friction: {$1, mu_forward: 0.2, mu_backward: 0.5}}
initial: {settle: true}
solver: {step: 0.1 ms}
run: {duration: 2 s, measure: {quantities: {x: {of: a.x, take: change}}}}
END
}
crawler "law: coulomb" >crawler.yaml
set -- crawler.yaml "$(value x)" "$crawled" own "$closing" 0
by "euler-events:2e-3" "$@" 1e-2
by "verlet-events:2e-4" "$@" 1e-4
by "rk4-events:2e-4 adaptive:2e-4" "$@" 1e-6
crawler "stick_velocity: 1 mm/s" >crawler.yaml
by "rk4 verlet euler rk4-events" crawler.yaml "$(value x)" "$crawled" 2e-3

# The file that strut writes runs to the same bits.
writes_back swing.yaml
expect 0 run written.yaml --json
jq .measured out >first.json
expect 0 run swing.yaml --json
jq .measured out >second.json
same first.json second.json

# What does not go with a mass matrix that varies says so.
tells 1 "slider 'swinger' moves; use solver.integrator rk4, verlet or adaptive" run swing.yaml --integrator midpoint

# A figure and a film's frame show the mass.
expect 0 run swing.yaml --step '1 ms' --plot swing.svg
[ -s swing.svg ] || fail "no figure"
