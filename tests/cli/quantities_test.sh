#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Measured quantities as people meet them: the table, JSON, studies and their figures, --set, write.
. "$(dirname "$0")/lib.sh"

yaml catch.yaml <<'END'
name: catch
parameters: {drop: 0.5 m}
gravity: [0, -9.81]
nodes: {top: {position: [0, 0], fixed: both}, bob: {position: [0, -1], mass: 2 kg}}
members: {rope: {nodes: [top, bob], kind: cable, stiffness: 2 kN/m}}
initial: {positions: {bob: [0, -1 + drop]}}
solver: {integrator: rk4-events, step: 1 ms}
run:
  duration: 0.5 s
  measure:
    quantities: {peak: {of: rope.force, take: max, accuracy: 1 %}, area: bob.y^2, side: {of: bob.x, take: change},
                 never: {of: 1 / bob.x, take: max}}
END

# The closed form m g + sqrt((m g)^2 + 2 k m g h): 218.68 N, and of 0.2 m 146.43 N.
shows 0 "energy residual" run catch.yaml
grep -qE '^  measured +value +note$' out || fail "no table of what is measured"
grep -qE '^  peak +218\.7 N$' out || fail "the peak is not 218.7 N"
grep -qE '^  area +0\.[0-9]+ m\^2$' out || fail "no area"
grep -qE '^  side +0 m  zero up to rounding$' out || fail "the side is not zero"
grep -qE '^  never +not finite$' out || fail "1/0 is a number"
finds '.measured.peak.value - 146.43066 | fabs < 1e-3' run catch.yaml --set drop=0.2
holds '.measured.peak.unit == "N" and .measured.area.unit == "m^2" and .measured.side.zero
  and .measured.peak.spread == null and .measured.never.value == null'
holds '.velocity_zero'

# The effective scene measures the same.
expect 0 run catch.yaml -o all --json
expect 0 run all/scene.yaml -o again --json
cmp -s all/summary.json again/summary.json || {
  jq -S 'del(.parameters)' all/summary.json >a
  jq -S 'del(.parameters)' again/summary.json >b
  same a b
}

# Studies keep all quantities, or those that are named; figures follow.
yaml study.yaml <<'END'
study: drops
model: catch.yaml
axes: [{drop: {from: 0.1 m, to: 0.5 m, count: 5}}]
figures: {peaks: {x: drop, y: peak}}
END
expect 0 sweep study.yaml -o usual --quiet
head -1 usual/table.csv | grep -qF 'peak [N],area [m^2],side [m],never' || fail "columns"
[ -s usual/peaks.svg ] || fail "no figure of the peaks"
{ cat study.yaml && echo 'keep: [peak, duration]'; } >some.yaml
expect 0 sweep some.yaml -o some --quiet
head -1 some/table.csv | grep -qF 'duration [s],peak [N]' || fail "columns by name"
head -1 some/table.csv | grep -qF 'area' && fail "what is not named is kept"
awk -F, 'NR > 1 { w = 2 * 9.81; p = w + sqrt(w * w + 2 * 2000 * w * $2); n++
    for (i = 1; i <= NF; i++) if ($i - p < 1e-4 * p && p - $i < 1e-4 * p) found++ }
  END { exit !(n == 5 && found == 5) }' some/table.csv || fail "peaks of the sweep"
{ cat study.yaml && echo 'keep: [quantities]'; } >every.yaml
expect 0 sweep every.yaml -o every --quiet
head -1 every/table.csv | grep -qF 'never' || fail "not all quantities are kept"
{ cat study.yaml && echo 'keep: [peek]'; } >wrong.yaml
tells 2 "found 'peek'; did you mean 'peak'?" sweep wrong.yaml -o wrong --quiet
{ cat study.yaml && echo 'keep: [peak, peak]'; } >twice.yaml
tells 2 "'peak' appears twice in 'keep' of the study" sweep twice.yaml -o twice --quiet

# A quantity in a study's own run.
{ sed "/figures/d" study.yaml && echo 'run: {measure: {quantities: {low: {of: bob.y, take: min}}}}' &&
  echo 'keep: [low]'; } >own.yaml
expect 0 sweep own.yaml -o own --quiet
head -1 own/table.csv | grep -qF 'low [m]' || fail "a study's own quantity"

# An axis that is called as a quantity is.
sed 's/drop/peak/g' catch.yaml >named.yaml
edit 's/catch/named/; s/{drop/{peak/; /figures/d' study.yaml expect 0 sweep -o axis --quiet
head -1 axis/table.csv | grep -qF 'run_peak [N]' || fail "the axis has the quantity's column"

# What else runs the model goes on as before.
expect 0 tradeoff catch.yaml --json
expect 0 compare catch.yaml --json
