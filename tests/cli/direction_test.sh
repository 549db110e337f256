#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Friction that differs by direction: the inchworm of two masses, whose spring swings slowly by D, and
# which advances by D - 2 mu_forward N / k in a cycle, since only one of them slides at a time.
. "$(dirname "$0")/lib.sh"

# worm FILE INTEGRATOR SOLVER-KEYS LAW: the scene
worm() {
  yaml "$1" <<END
parameters: {forward: 0.1, slowly: 0.05 Hz}
nodes: {a: {position: [0, 0], mass: 1 kg}, b: {position: [1 m, 0], mass: 1 kg}}
members: {s: {nodes: [a, b], kind: spring, stiffness: 1000 N/m, damping: 20 N s/m}}
gravity: [0, -9.81]
ground: {stiffness: 1e5 N/m, damping: 600 N s/m, friction: {$4, mu_forward: forward, mu_backward: 0.6}}
actuators: {d: {member: s, signal: {sine: {amplitude: 25 mm, frequency: slowly}}}}
solver: {integrator: $2, $3}
run: {periods: 3, of: d, measure: {last: 1}}
END
}

# advances TOLERANCE: the run's velocity is (D - 2 mu N / k) f within that part
advances() {
  jq -e --argjson p "$1" '(.velocity / ((0.05 - 2 * 0.1 * 9.81 / 1000) * 0.05) - 1 | fabs) <= $p' \
    "$work/out" >"$work/value" || fail "$2: velocity $(jq .velocity "$work/out")"
}

for row in "adaptive step:~20~ms,~tolerance:~1e-6 law:~coulomb 0.002" \
  "adaptive step:~20~ms,~tolerance:~1e-5 law:~karnopp,~stick_velocity:~1e-5~m/s 0.01" \
  "rk4-events step:~2~ms law:~coulomb 0.002" "verlet-events step:~1~ms law:~coulomb 0.002" \
  "verlet-events step:~1~ms law:~karnopp,~stick_velocity:~1e-5~m/s 0.01" \
  "rk4 step:~0.5~ms law:~karnopp,~stick_velocity:~1e-4~m/s 0.06" \
  "adaptive step:~20~ms,~tolerance:~1e-5 law:~smooth,~width:~1e-5~m/s 0.02"; do
  set -- $row; method=$1 keys=$2 law=$3 tolerance=$4
  worm "$work/worm.yaml" "$method" "$(echo "$keys" | tr '~' ' ')" "$(echo "$law" | tr '~' ' ')"
  expect 0 run "$work/worm.yaml" --json
  advances "$tolerance" "$method $law"
done

# Points of a study have the bits of single runs.
worm "$work/worm.yaml" rk4 "step: 0.5 ms" "law: karnopp, stick_velocity: 1e-4 m/s"
yaml "$work/study.yaml" <<END
study: worm
model: worm.yaml
axes: [{forward: [0, 0.1, 0.2, 0.3, 0.6]}]
END
expect 0 sweep "$work/study.yaml" -o "$work/study" --json
for forward in 0 0.1 0.6; do
  expect 0 run "$work/worm.yaml" --set forward=$forward --json
  one=$(jq .velocity "$work/out")
  awk -F, -v f=$forward 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
    $at["forward"] == f { print $at["velocity [m/s]"] }' "$work/study/table.csv" >"$work/value"
  many=$(cat "$work/value")
  jq -ne --argjson a "$one" --argjson b "$many" '$a == $b' >/dev/null ||
    fail "forward $forward: $one alone, $many in the study"
done

# With equal coefficients both ways it stays: a cycle leads back. The lighter mass slides both ways; which of two equal
# ones does is left to rounding, in each half of a cycle anew.
worm "$work/even.yaml" adaptive "step: 20 ms, tolerance: 1e-6" "law: coulomb"
sed -i 's/\[1 m, 0\], mass: 1 kg/[1 m, 0], mass: 1.1 kg/' "$work/even.yaml"
expect 0 run "$work/even.yaml" --set forward=0.6 --json
jq -e '(.velocity | fabs) < 1e-6' "$work/out" >"$work/value" || fail "it advances on even friction"

# What it needs and does not have.
bad() {
  edit "s/mu_forward: forward, mu_backward: 0.6/$1/" "$work/worm.yaml" expect 2 check
  grep -q "$2" "$work/err" || fail "$1: $(cat "$work/err")"
}
bad 'mu_forward: forward' "lacks 'mu_backward'"
bad 'mu: forward, mu_forward: 0.1, mu_backward: 1' "gives both 'mu' and 'mu_forward'"
bad 'mu: forward, mu_backward: -1' "mu_backward"
bad 'mu: forward, mu_backwards: 1' "did you mean 'mu_backward'"
