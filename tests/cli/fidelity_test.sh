#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Other models of a scene by options give what the same words in the file give; what cannot be run
# together is refused by run and check alike.
. "$(dirname "$0")/lib.sh"
rod=$models/basics/pendulum.yaml

# same_run OPTIONS FILE MODEL: MODEL with the options runs as FILE without
same_run() {
  expect 0 run "$3" $1 --json
  cp "$work/out" "$work/one"
  expect 0 run "$2" --json
  jq -e '.velocity' "$work/one" >"$work/a" || fail "no velocity"
  jq -e '.velocity' "$work/out" >"$work/b" || fail "no velocity"
  cmp -s "$work/a" "$work/b" || fail "$1 is not the same as in the file"
}
sed 's/^nodes:/mass_model: lumped\nnodes:/' "$rod" >"$work/lumped.yaml"
same_run "--mass-model lumped" "$work/lumped.yaml" "$rod"
same_run "--mass-model consistent" "$rod" "$work/lumped.yaml"
sed 's/^nodes:/bars: rigid\nnodes:/' "$rod" >"$work/rigid.yaml"
same_run "--bars rigid" "$work/rigid.yaml" "$rod"
same_run "--bars elastic" "$rod" "$work/rigid.yaml"

# The former name of a law, noted.
tells 0 "strut check: note: 'printed' is now called 'approach_only'" check "$crawler" --damping-law printed
expect 0 check "$crawler" --damping-law approach_only
[ ! -s err ] || fail "a note without cause"

for command in run check; do
  tells 1 "--bars expects elastic or rigid, not 'rigdi'; did you mean 'rigid'?" "$command" "$crawler" --bars rigdi
  tells 1 "--mass-model expects consistent or lumped, not 'heavy'" "$command" "$crawler" --mass-model heavy
  tells 1 "did you mean 'coulomb'?" "$command" "$crawler" --friction-law coulom
  tells 1 "--damping-law expects approach_only or hunt_crossley, not 'hunt'" "$command" "$crawler" --damping-law hunt
  tells 1 "needs ground.friction.width" "$command" "$crawler" --friction-law smooth
  tells 1 "needs ground.dissipation" "$command" "$crawler" --damping-law hunt_crossley
  tells 1 "needs a ground with friction" "$command" "$rod" --friction-law coulomb
  tells 1 "needs a ground" "$command" "$rod" --damping-law approach_only
  tells 1 "needs a method with events" "$command" "$crawler" --friction-law coulomb
  tells 1 "midpoint cannot step over contacts, and node 'n1' may touch the ground" "$command" "$crawler" --integrator midpoint
  tells 1 "midpoint does not keep the lengths of rigid bars" "$command" "$rod" --bars rigid --integrator midpoint
done

# No step is too large for it.
shows 0 "largest step of midpoint       any" check "$rod" --integrator midpoint
finds '(.velocity + 2.069) | fabs < 0.01' run "$rod" --set stiffness=1e12 --integrator midpoint --step "5 ms"
