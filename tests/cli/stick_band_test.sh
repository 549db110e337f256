#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A stick band that a step passes over is told by name, with the width it needs.
. "$(dirname "$0")/lib.sh"
belt=$2

expect 0 check "$belt"
[ ! -s err ] || fail "the model's own band is wide enough"
expect 0 run "$belt" --quiet --json
[ ! -s err ] || fail "the model's own band is wide enough"
out_has_not stick_velocity_needed

# kinetic friction is 1 N on 1 kg and the step 0.1 ms
expect 0 check "$belt" --set band=1e-8m/s
err_has "stick_velocity 10 nm/s of node 'block'"
err_has "use stick_velocity >= 100 um/s"
expect 0 run "$belt" --set band=1e-8m/s --quiet --json
err_has "node 'block' stuck to the ground by accident"
# friction and the spring together, up to 1 + 2.4 N
needed=$(sed -n 's/.*"stick_velocity_needed":[^0-9]*\([0-9.e-]*\).*/\1/p' out)
awk "BEGIN { exit !($needed > 1e-5 && $needed < 3.5e-4) }" || fail "needed: $needed"

# a method that locates the moment needs no width
for method in rk4-events verlet-events; do
  expect 0 run "$belt" --set band=1e-8m/s --integrator $method --quiet --json
  [ ! -s err ] || fail "$method needs no band"
done
done_testing
