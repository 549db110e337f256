#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A stick band that a step passes over is reported by name, with the width it needs.
. "$(dirname "$0")/lib.sh"
belt=$models/basics/belt.yaml

expect 0 check "$belt"
[ ! -s err ] || fail "the model's own band is wide enough"
expect 0 run "$belt" --quiet --json
[ ! -s err ] || fail "the model's own band is wide enough"
out_has_not stick_velocity_needed

# kinetic friction is 1 N on 1 kg and the step 0.1 ms
tells 0 "stick_velocity 10 nm/s of node 'block'" check "$belt" --set band=1e-8m/s
err_has "use stick_velocity >= 100 um/s"
tells 0 "node 'block' stuck only by chance" run "$belt" --set band=1e-8m/s --quiet --json
# friction and the spring together, up to 1 + 2.4 N
needed=$(sed -n 's/.*"stick_velocity_needed":[^0-9]*\([0-9.e-]*\).*/\1/p' out)
awk "BEGIN { exit !($needed > 1e-5 && $needed < 3.5e-4) }" || fail "needed: $needed"

# a method that locates the moment needs no width
for method in rk4-events verlet-events; do
  expect 0 run "$belt" --set band=1e-8m/s --integrator $method --quiet --json
  [ ! -s err ] || fail "$method needs no band"
done

# Two feet on a belt, where static friction is twice kinetic: they stick and slip. A band that a step
# passes over ten times loses every stick, which shows in the answer; with one friction it does not.
yaml two_feet.yaml <<'EOF'
parameters: {band: 1e-5 m/s, static: 0.6}
gravity: [0, -9.81]
nodes: {wall: {position: [-0.5, 0], fixed: both}, front: {position: [0, 0], mass: 0.5},
        back: {position: [0.2, 0], mass: 0.5}}
members: {spring: {kind: spring, nodes: [wall, front], stiffness: 10, rest_length: 0.5},
          body: {kind: bar, nodes: [front, back], stiffness: 1.4e5, damping: 1.6}}
ground: {stiffness: 1e5, damping: 100, belt_speed: 0.3,
         friction: {mu_static: static, mu_kinetic: 0.3, stick_velocity: band}}
solver: {step: 0.1 ms}
run: {duration: 6 s}
EOF
place() { # ARGUMENT...: x of the front foot
  expect 0 run two_feet.yaml --quiet --json "$@"
  tr -d '\n\t ' <out | sed 's/.*"front":{"position":\[\([^,]*\),.*/\1/'
}
differ() { awk "BEGIN { d = $1 - $2; exit !(d * d > $3 * $3) }"; }

right=$(place --integrator rk4-events)
[ ! -s err ] || fail "rk4-events needs no band"
wrong=$(place)
err_has "node 'front' and 1 more stuck only by chance"
differ "$right" "$wrong" 0.05 || fail "passing over the band: $wrong, not $right"
out_has '"code":	"stick_band"'

# A band that is met, but so wide that the feet creep apart until one lets go.
wrong=$(place --set band=1e-3m/s)
err_has "nodes 'front' and 'back' stick, but creep within their stick bands" "strained member 'body'"
differ "$right" "$wrong" 0.05 || fail "creeping in the band: $wrong, not $right"
out_has '"code":	"stick_creep"'

right=$(place --set static=0.3 --integrator rk4-events)
place --set static=0.3 --set band=1e-3m/s >close
[ ! -s err ] || fail "one friction: nothing lets go too soon"
close=$(place --set static=0.3)
[ ! -s err ] || fail "one friction: passing over the band makes no difference"
! differ "$right" "$close" 0.002 || fail "one friction: $close, not $right"
