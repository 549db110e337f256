#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Passive things stay passive, or it is said; what turns faster than the step sees is refused; nothing that is no number
# is called closed.
. "$(dirname "$0")/lib.sh"

# ---- friction that gives energy: a block started uphill on a slope of 10 degrees, which rests after 0.19 mm ----
yaml block.yaml <<'END'
parameters: {band: 1 mm/s}
nodes: {block: {position: [0, -0.98 mm], mass: 1}}
gravity: [0, -9.81]
ground: {slope: 10 deg, stiffness: 1e4, damping: 100, friction: {mu: 0.5, stick_velocity: band}}
initial: {velocities: {block: [0.05 m/s, 0.0088163 m/s]}}
solver: {step: 0.1 ms}
run: {duration: 10 s}
END
for method in rk4 verlet rk4-events verlet-events adaptive; do
  tells 0 "friction gave" run block.yaml --integrator $method --json
  err_has "use 'law: coulomb'"
  out_has '"friction_gives"'
done
tells 5 "NOT kept" run block.yaml --accuracy 1%
tells 0 "creep within their stick bands" run block.yaml --set band=0.1
sed 's/{mu: 0.5, .*}/{law: coulomb, mu: 0.5}}/' block.yaml >exact.yaml
gives '.nodes.block.position[0]' 0.00019453 1e-6 run exact.yaml --integrator rk4-events
err_empty

# ---- a band that is wide beside the motion's speeds: two feet, driven at 5 Hz by 2 mm ----
yaml feet.yaml <<'END'
parameters: {band: 0.1 mm/s}
gravity: [0, -9.81]
nodes: {a: {position: [0, 0], mass: 0.1}, b: {position: [0.1, 0], mass: 0.1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 2 kN/m, damping: 2}}
actuators: {d: {member: m, signal: {sine: {amplitude: 2 mm, frequency: 5 Hz}}}}
ground: {stiffness: 1e5, damping: 50, friction: {mu_forward: 0.1, mu_backward: 0.4, stick_velocity: band}}
solver: {accuracy: 1 %}
run: {periods: 10, of: d}
END
expect 0 run feet.yaml
for band in 50mm/s 1m/s; do
  tells 5 "creep within their stick bands" run feet.yaml --set band=$band
  out_has "NOT kept"
done
sed 's/of: d}/of: d, measure: {quantities: {far: {of: a.x, take: max}}}}/' feet.yaml >far.yaml
expect 5 run far.yaml --set band=1m/s --json
holds '.accuracy.expected == null and .measured.far.expected == null' # nothing is known of quantities either

# ---- what turns about once in a step, or more often; right where the step follows it ----
turning() { # NAME LINES [METHODS]: of the scene of $body and LINES, which turns at HERTZ, with a step of 1 ms
  printf '%s\n' "$body" "$2" >turning.yaml
  for method in ${3:-rk4 verlet euler rk4-events verlet-events}; do
    sed 's/HERTZ/1 kHz/g' turning.yaml >fast.yaml
    tells 3 "$1 turns at 1000 Hz, 1 times in a step" run fast.yaml --integrator $method
    sed 's/HERTZ/150 Hz/g' turning.yaml >fast.yaml
    tells 0 "$1 turns at 150 Hz" run fast.yaml --integrator $method --quiet
    sed 's/HERTZ/40 Hz/g' turning.yaml >fast.yaml
    expect 0 run fast.yaml --integrator $method --quiet
    ! grep -q "turns at" err || fail "$1: 25 steps are enough"
  done
  sed 's/HERTZ/1 kHz/g' turning.yaml >fast.yaml
  expect 0 run fast.yaml --integrator adaptive --quiet
  ! grep -q "turns at" err || fail "$1: adaptive chooses its steps"
}
body='nodes: {a: {position: [0, 0], mass: 0.5}, b: {position: [0.1, 0], mass: 0.5}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 1000, damping: 5}}
solver: {step: 1 ms}
run: {duration: 0.2 s}
strut: 1'
turning "unbalance 'rotor'" "unbalances: {rotor: {node: b, mass: 2 g, radius: 3 mm, speed: HERTZ}}"
turning "the signal of load 'l'" "loads: {l: {node: b, force: [1, 0], signal: {sine: {amplitude: 1, frequency: HERTZ}}}}"
plain="rk4 verlet euler" # methods with events look within their steps for what expressions of time do
turning "the signal of actuator 'd'" "actuators: {d: {member: m, signal: {expression: '1 mm * sin(2*pi*HERTZ*t)'}}}" "$plain"
turning "the signal of load 'l'" "loads: {l: {node: b, force: [1, 0], signal: {expression: 't*HERTZ - floor(t*HERTZ)'}}}" "$plain"
turning "signal 's'" "signals: {part: {sine: {amplitude: 1 mm, frequency: HERTZ}}, s: {sine: {amplitude: 1 mm, frequency: HERTZ, phase: 0.1}}}
actuators: {d: {member: m, signal: s}}"
turning "oscillator 'o'" "oscillators: {o: {frequency: HERTZ}}
actuators: {d: {member: m, signal: {expression: '1 mm * sin(o)'}}}"
# the right answer is at hand: a free body stays, on average
sed 's/HERTZ/1 kHz/' >rotor.yaml <<END
$body
unbalances: {rotor: {node: b, mass: 2 g, radius: 3 mm, speed: HERTZ}}
END
gives .velocity 0 1e-8 run rotor.yaml --accuracy 1%
body=$(echo "$body" | sed 's/^nodes: {/nodes: {c: {position: [0.2, 0], fixed: both, moves: {x: {sine: {amplitude: 1 mm, frequency: HERTZ}}}}, /
s/^members: {/members: {n: {kind: spring, nodes: [b, c], stiffness: 1000}, /')
turning "the signal of node 'c'" ""

# ---- gas that flows too fast for the step ----
yaml pipe.yaml <<'END'
parameters: {C: 100, h: 1 ms}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y}, c: {position: [0.5, 1], mass: 1},
        d: {position: [0.5, -1], mass: 1}}
groups: {g: {kind: spring, stiffness: 1000, damping: 10}}
members: {m: {group: g, nodes: [a, b]}, n: {group: g, nodes: [b, c]}, o: {group: g, nodes: [c, a]},
          p: {group: g, nodes: [b, d]}, q: {group: g, nodes: [d, a]}}
cells: {u: {nodes: [a, b, c], gas: {kind: isothermal, pressure: 300, outside: 100}},
        l: {nodes: [a, d, b], gas: {kind: isothermal, pressure: 100, outside: 100}}}
pipes: {x: {cells: [u, l], conductance: C}}
solver: {step: h}
run: {duration: 2 s}
END
for C in 720 800 1e6; do tells 3 "pipe or state 'x' settles within" run pipe.yaml --set C=$C; done
step=$(sed 's/.*solver.step <= \([^ ]*\) s,.*/\1/' err)
near_number "$step" 6.1e-7 1e-8 "the step for a conductance of 1e6"
gives '.energy.residual / .energy.exchanged' 0 1e-3 run pipe.yaml --set C=720 --set h=0.8ms
edit 's/pipes:.*/states: {z: {start: 1, rate: -3000*z\/1 s}}/' pipe.yaml tells 3 "state 'z' settles within 0.000333 s" run

# ---- no number is no answer ----
yaml wild.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 10, law: {kind: bilinear, knee: 1 mm, second_stiffness: -1e300}}}
solver: {step: 1 ms}
run: {duration: 0.1 s}
initial: {velocities: {b: [1, 0]}}
END
for method in rk4 verlet; do
  tells 3 "node 'b'" run wild.yaml --integrator $method
  out_has_not "balance closed"
done

# What is gone does no work, however it went and whoever integrates.
yaml gone.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0.2, 0], mass: 0.4}, c: {position: [0.4, 0], fixed: both}}
members: {s: {kind: spring, nodes: [a, b], stiffness: 20 kN/m, damping: 20 N s/m, GOES},
          t: {kind: spring, nodes: [b, c], stiffness: 2 kN/m, damping: 4 N s/m}}
actuators: {d: {member: t, signal: {sine: {amplitude: 2 mm, frequency: 2 Hz}}}}
solver: {step: 1 ms}
run: {duration: 0.9 s, measure: {quantities: {w: {of: work.drives, take: final}, e: {of: s.stretch, take: final}}}}
END
for goes in 'released_at: 0.3' 'breaks_at: 1 N'; do
  for method in rk4 verlet rk4-events verlet-events adaptive adaptive8; do
    sed "s/GOES/$goes/" gone.yaml >g.yaml
    expect 0 run g.yaml --integrator $method --json
    holds '.energy.residual != null and .energy.drive_work > 0 and (.energy.balance == "closed") and
           .measured.w.value > 0 and (.measured.e.value | fabs) < 0.01'
  done
done

# ---- the balance of what rests has the floor of what is stored ----
yaml rests.yaml <<'END'
mass_model: consistent
gravity: [0, -9.81]
nodes: {block: {position: [1000.0000315287323, -8.66244799349859e-05], mass: 1}}
ground: {slope: 0.3490658503988659, stiffness: 100000, damping: 100, height: -363.97023426620234,
         friction: {law: karnopp, mu_static: 0.37, mu_kinetic: 0.37, stick_velocity: 0.0001}}
solver: {integrator: rk4, step: 0.0001}
run: {duration: 1}
END
finds '.energy.balance == "closed"' run rests.yaml
err_empty
yaml pulse.yaml <<'END'
nodes: {b: {position: [1, 0], mass: 1, fixed: y}, c: {position: [0, 0], fixed: both}}
members: {p: {kind: spring, nodes: [c, b], stiffness: 30, damping: 0.1, rest_length: 1}}
loads: {k: {node: b, force: [79.01814895626839, 0], signal: {expression: 'exp(-((t - 0.206666161 s)/(0.00714 s))^2)'}}}
solver: {integrator: adaptive, step: 0.01}
run: {duration: 0.714}
END
expect 0 run pulse.yaml

# ---- velocities are given to what has settled ----
yaml thrown.yaml <<'END'
gravity: [0, -9.81]
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [0.1, 0], mass: 1}}
members: {s: {kind: spring, nodes: [a, b], stiffness: 1e4, damping: 10}}
ground: {stiffness: 1e5, damping: 1000}
initial: {settle: true, START}
solver: {step: 0.1 ms}
run: {duration: 0.1, measure: {quantities: {vy: {of: com.vy, take: final}}}}
END
for start in 'velocity: [0, 2]' 'velocities: {a: [0, 2], b: [0, 2]}'; do
  sed "s/START/$start/" thrown.yaml >t.yaml
  for more in '--accuracy 0.1%' '--integrator rk4'; do
    gives .measured.vy.value 1.019 2e-3 run t.yaml $more
  done
done

# ---- feet, whose band is a width within which they creep ----
yaml footed.yaml <<'END'
parameters: {band: 1 mm/s}
gravity: [0, -9.81]
nodes: {a: {position: [0, 0.0495], mass: 1}, b: {position: [0.3, 0.1023966], mass: 1}}
members: {m: {kind: bar, nodes: [a, b], stiffness: 1e5, damping: 100}}
feet: {f: {node: a, member: m, radius: 50 mm}, g: {node: b, member: m, radius: 50 mm}}
ground: {slope: 10 deg, stiffness: 1e4, damping: 100, friction: {mu: 0.5, stick_velocity: band}}
initial: {velocity: [0.05, 0.0088]}
solver: {step: 0.1 ms}
run: {duration: 10 s}
END
tells 0 "creep within their stick bands" run footed.yaml
tells 5 "creep within their stick bands" run footed.yaml --accuracy 1%
