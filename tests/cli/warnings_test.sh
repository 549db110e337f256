#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What is valid but hardly meant is reported: in check, in run and in check --json, once per cause.
. "$(dirname "$0")/lib.sh"

# once WORDS: one line of stderr has them.
once() {
  [ "$(grep -cF -- "$1" err)" -eq 1 ] || fail "not once: $1"
}

write() { # MEMBERS-and-more on stdin
  { printf 'strut: 1\ngravity: [0, -9.81]\n'; cat; printf 'solver: {step: 0.1 ms}\nrun: {duration: 1 s}\n'; } >"$1"
}

# check and run say the same, once; check --json lists it
reported() { # FILE CODE WORDS
  expect 0 check "$1"
  once "$3"
  [ "$(grep -c warning err)" -eq 1 ] || fail "more than one warning"
  expect 0 run "$1" --quiet --force
  once "$3"
  shows 0 "\"code\":	\"$2\"" check "$1" --json
}

unreported() { # FILE
  for command in check "run --force"; do
    expect 0 $command "$1"
    [ ! -s err ] || fail "$command has nothing to warn of"
  done
  shows 0 '"warnings":	[]' check "$1" --json
}

# a drive that takes its member through nothing, at its lowest, which is no multiple of anything
for amplitude in 60 40; do
  write "drive$amplitude.yaml" <<EOF
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -50 mm], mass: 0.1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100, damping: 1, rest_length: 50 mm}}
actuators: {d: {member: m, signal: {sine: {amplitude: $amplitude mm, frequency: 1.7}}}}
EOF
done
reported drive60.yaml rest_length_below_zero "the rest length of 'm' to -0.01 m at t = 0.4412 s"
unreported drive40.yaml

# two drives on one member together; four members, one line
write four.yaml <<'EOF'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -50 mm], mass: 0.1}, c: {position: [0.2, 0], fixed: both}, d: {position: [0.3, 0], fixed: both}, e: {position: [0.4, 0], fixed: both}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100, damping: 1, rest_length: 50 mm},
          n: {kind: spring, nodes: [c, b], stiffness: 100, damping: 1, rest_length: 50 mm},
          o: {kind: spring, nodes: [d, b], stiffness: 100, damping: 1, rest_length: 50 mm},
          p: {kind: spring, nodes: [e, b], stiffness: 100, damping: 1, rest_length: 50 mm}}
signals: {half: {ramp: {amplitude: -30 mm, start: 0.2, stop: 0.4}}}
actuators: {d1: {member: m, signal: half}, d2: {member: m, signal: half}, d3: {member: n, signal: half},
            d4: {member: n, signal: half}, d5: {member: o, signal: half}, d6: {member: o, signal: half},
            d7: {member: p, signal: half}, d8: {member: p, signal: half}}
EOF
reported four.yaml rest_length_below_zero "the same of m, n, o and 1 more"

# a block at the depth where it rests, and one that is ten centimetres deep
for depth in 100 0.0981; do
  write "block$depth.yaml" <<EOF
nodes: {block: {position: [0, -$depth mm], mass: 1}}
ground: {stiffness: 1e5, damping: 100, friction: {mu: 0.3, stick_velocity: 1 mm/s}}
EOF
done
reported block100.yaml inside_ground "node block starts inside the ground, 'block' 0.1 m deep"
unreported block0.0981.yaml

# a member twice; a spring beside its damper
write twice.yaml <<'EOF'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -1], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100}, again: {kind: cable, nodes: [b, a], stiffness: 100}}
EOF
reported twice.yaml same_nodes "members 'm' and 'again' join the same two nodes"
write iwan.yaml <<'EOF'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -1], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100, law: {kind: play, gap: 1 mm}},
          again: {kind: spring, nodes: [b, a], stiffness: 100, law: {kind: play, gap: 2 mm}}}
EOF
unreported iwan.yaml
write damped.yaml <<'EOF'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -1], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100},
          damper: {kind: spring, nodes: [b, a], stiffness: 0, damping: 1}}
EOF
unreported damped.yaml

# a mass that was forgotten; one on its own is a scene
write forgotten.yaml <<'EOF'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -1], mass: 1}, c: {position: [1, 0], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100}}
EOF
reported forgotten.yaml loose_mass "node c has mass and can move, but no member holds it"
write alone.yaml <<'EOF'
nodes: {c: {position: [1, 0], mass: 1}}
EOF
unreported alone.yaml

# A plain number is in SI units: a note where that changes what the file has by more than 100 times, or gives a wide angle.
write scale.yaml <<'EOF'
parameters: {A: 2 mm, mass: 1 kg, product: 2*3 mm, turn: 20 deg}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0*sin(turn), -1 - product], mass: mass}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 1e3, damping: 1}}
actuators: {d: {member: m, signal: {sine: {amplitude: A, frequency: 3}}}}
EOF
tells 0 'scale.yaml:3:17: note: --set A=0.3 is taken as 0.3 in SI units, 150 times the 2 mm here' check scale.yaml --set A=0.3
err_has 'write --set A="0.3 mm" if that is meant' '3 | parameters: {A: 2 mm'
[ "$(grep -c note err)" -eq 1 ] || fail "a note twice"
tells 0 'write --set mass="2e-3 kg"' check scale.yaml --set mass=2e-3
tells 0 'write --set product="6 UNIT"' check scale.yaml --set product=6
tells 0 '2.86479 times the 20 deg here, since a plain number is in SI units; write --set turn="1 deg"' check scale.yaml --set turn=1
for set in A=0.2 A=2e-5 "A=500 mm" mass=99 A=0 turn=0.7; do
  expect 0 check scale.yaml --set "$set"
  [ ! -s err ] || fail "--set $set is no case for a note"
done

# A fixed step that passes over switches does not know its error, and says so; others do not.
write slide.yaml <<'EOF'
nodes: {block: {position: [0, 0], mass: 1}}
ground: {stiffness: 1e5, damping: 100, friction: {mu: 0.3, stick_velocity: 1 mm/s}}
loads: {push: {node: block, force: [4 N, 0 N]}}
EOF
shows 0 '"worth":	"not known: fixed steps of rk4 pass over changes between sticking and slipping; --accuracy 1% estimates the error"' \
  run slide.yaml --json
out_has '"caveat":	"fixed steps of rk4 pass over changes between sticking and slipping"'
shows 0 ' not known: fixed steps of rk4 pass over changes between sticking and slipping; --accuracy 1%' run slide.yaml
grep -q '^  accuracy  *not known: fixed steps' out || fail "the remark has no label 'accuracy'"
finds '.method == "rk4-events"' run slide.yaml --friction-law coulomb
edit 's/^ground: {/&slope: 1, /' slide.yaml tells 0 "note: a slope of 1 is in radians, 57.2958 deg; write '1 deg'" check
edit 's/frequency: 3/&, phase: 90/' scale.yaml tells 0 "note: a phase of 90 is in radians, 5156.62 deg; write '90 deg'" check
for method in "--integrator rk4-events" "--accuracy 1%"; do
  shows 0 '"caveat":	null' run slide.yaml --json $method
done

# Fixed steps lose the phase of an oscillator of 1 rad/s: 629 rad z^2/24 by verlet and euler and twice that by
# midpoint, z^4/120 by rk4. With damping of 0.02 it is gone long before that, as 100 rad z^2/24 exp(-1).
yaml sway.yaml <<'EOF'
parameters: {damping: 0}
nodes: {wall: {position: [0, 0], fixed: both}, n: {position: [1, 0], mass: 1, fixed: y}}
members: {s: {kind: spring, nodes: [wall, n], stiffness: 1, rest_length: 1, damping: damping}}
initial: {positions: {n: [1.25, 0]}}
solver: {step: 0.2}
run: {duration: 629}
EOF
for case in "verlet 0.2 1" "euler 0.2 1" "verlet-events 0.2 1" "midpoint 0.2 2.1" "rk4 0.4 0.13"; do
  set -- $case
  shows 0 "\"caveat\":	\"steps of $2 s shift the phase of vibrations at 0.159 Hz, where most of the kinetic energy is, by some $3 rad\"" run sway.yaml --integrator "$1" --step "$2" --json
done
shows 0 "by some 0.14 rad; --accuracy 1%" run sway.yaml --integrator verlet --step 0.3 --set damping=0.02
for silent in "verlet --step 0.1 --set damping=0.02" "rk4 --step 0.2" "adaptive --step 0.4"; do
  shows 0 '"caveat":	null' run sway.yaml --json --integrator $silent
done

# The limit itself is too large a step: there motions of verlet grow.
tells 3 "the step 2 s is at the largest stable step of verlet, 2 s (all contacts closed); use solver.step <= 1.8 s" run sway.yaml --integrator verlet --step 2
tells 3 "the step 2.01 s is above the largest stable step of verlet, 2 s" run sway.yaml --integrator verlet --step 2.01

# What adaptive loses is due to its tolerance, not to its step. (This one is five fast periods, at whose ends all rests.)
yaml slow.yaml <<'EOF'
nodes: {wall: {position: [0, 0], fixed: both}, a: {position: [1, 0], mass: 1, fixed: y}, b: {position: [2, 0], mass: 1, fixed: y}}
members: {soft: {kind: spring, nodes: [wall, a], stiffness: 1e-6, rest_length: 1}, hard: {kind: spring, nodes: [a, b], stiffness: 1, rest_length: 1}}
initial: {positions: {b: [2.25, 0]}}
solver: {integrator: adaptive, tolerance: 1e-9, step: 22.21441746759419}
run: {duration: 2221.441746759419}
EOF
tells 0 "; the tolerance of 1e-09 allows that; use a smaller solver.tolerance, or --accuracy 1%" run slow.yaml
expect 0 run slow.yaml --tolerance 1e-11
[ ! -s err ] || fail "a smaller tolerance is no remedy"

# The models that come with strut say nothing of the kind.
for model in "$models"/*/*.yaml; do
  grep -q '^strut:' "$model" && ! grep -q '^sweep:' "$model" || continue
  ! grep -q "^study:" "$model" || continue
  "$strut" check "$model" --json >out 2>err || continue
  out_has '"warnings":	[]'
done
# The residual of the balance and what it means are one statement: a residual beyond 1 % of what little was
# exchanged may be rounding of what is stored.
yaml stored.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y, mass: 1}, c: {position: [3, 0], fixed: both}}
members: {m: {nodes: [a, b], kind: spring, stiffness: 1e9, rest_length: 0.7}, n: {nodes: [c, b], kind: spring, stiffness: 1e9, rest_length: 1.7}}
initial: {velocities: {b: [3e-4, 0]}}
solver: {integrator: rk4, step: 1 us}
run: {duration: 1 ms}
END
shows 0 'nJ, balance closed up to the rounding of the stored energy' run stored.yaml
out_has_not 'within 1 %'
