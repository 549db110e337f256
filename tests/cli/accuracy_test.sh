#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Wanted accuracy, steady motion and methods with events on the crawler, against an independent
# program: its RK4 with located events at 5 us and its fifth-order pair agree on these to 0.02 %.
. "$(dirname "$0")/lib.sh"
crawler=$here/../../models/crawler/crawler.yaml

# about VALUE WANTED PART: VALUE is within PART of WANTED
about() {
  jq -ne --argjson v "$1" --argjson w "$2" --argjson p "$3" \
    '((($v - $w) / $w) | fabs) <= $p' >"$work/out" || fail "$1 is not $2 within $3"
}
# field FILTER: of the JSON in out, which it keeps
field() { jq -e "$1" "$work/json"; }

while read -r friction velocity; do
  for bargain in "1% 0.01 1" "0.5% 0.005 1" "0.1% 0.001 2.5"; do
    set -- $bargain
    expect 0 run "$crawler" --set friction="$friction" --accuracy "$1" --json
    err_empty
    cp "$work/out" "$work/json"
    about "$(field .velocity)" "$velocity" "$2"
    [ "$(field .accuracy.kept)" = true ] || fail "$friction: $1 is not kept"
    # forces per second of motion, over those of RK4 at 0.1 ms
    cost=$(field '.force_evaluations / .duration / 40000')
    jq -ne --argjson c "$cost" --argjson m "$3" '$c <= $m' >/dev/null || fail "$1 costs $cost"
  done
  for method in rk4-events adaptive; do
    expect 0 run "$crawler" --set friction="$friction" --steady 0.05% --integrator $method \
      --step "0.02 ms" --json
    cp "$work/out" "$work/json"
    about "$(field .velocity)" "$velocity" 0.001
    [ "$(field .steady.kind)" = '"periodic"' ] || fail "$method: not periodic"
    [ "$(field .steady.repeats)" = 1 ] || fail "$method: not every period alike"
    [ "$(field .events)" -gt 100 ] || fail "$method: no events"
  done
done <<END
0.1 0.0100324
0.2 0.0158362
0.5 0.0098834
END

# It stands still, and that is steady too.
expect 0 run "$crawler" --set frequency="14 Hz" --set friction=0.5 --steady 0.5% \
  --integrator verlet-events --step "0.08 ms" --json
cp "$work/out" "$work/json"
[ "$(field '.steady.kind == "periodic" and .steady.periods <= 60')" = true ] || fail "it never stops"
[ "$(field '(.velocity | fabs) < 3e-5')" = true ] || fail "it moves"

# What makes no sense is refused.
expect 1 run "$crawler" --accuracy 1% --integrator rk4
err_has "not both"
expect 1 run "$crawler" --accuracy 0
err_has "greater than 0"
expect 1 run "$crawler" --accuracy 150%
err_has "at most 1"
expect 1 run "$crawler" --integrator leapfrog
err_has "leapfrog"
expect 1 run "$here/hopper.yaml" --steady 1%
err_has "periods"
expect 3 run "$crawler" --integrator verlet-events --step "1 ms"
err_has "largest stable step of verlet-events"

done_testing
