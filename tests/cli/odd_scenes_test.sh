#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The commands for structures at rest on odd scenes: one sentence or an answer without "nan".
. "$(dirname "$0")/lib.sh"
models=$here/../../models

# whole NAME: every command answers or refuses, in words and as JSON, and no number is missing.
whole() {
  for words in "equilibria --starts 1" modes "modes --at drawn" rigidity "rigidity --at start" \
    "form --given densities" "form --given lengths" "form --given prestress"; do
    for json in "" --json; do
      [ "$json" ] || [ "$words" != "equilibria --starts 1" ] || continue # one search will do
      # shellcheck disable=SC2086
      "$strut" $words $json "$1.yaml" >out 2>err </dev/null
      code=$?
      case $code in 0 | 2 | 3) ;; *) fail "strut $words $json, $1: exit code $code" ;; esac
      [ "$code" -eq 0 ] || [ "$(wc -l <err)" -eq 1 ] || fail "strut $words, $1: no one sentence"
      ! grep -qiwE -- '-?nan|-?inf' out err || fail "strut $words, $1: no number"
      ! grep -q 'out of memory\|singular' err || fail "strut $words, $1: a wrong reason"
      if [ "$json" ] && [ -s out ]; then
        jq -e . out >jq.out || fail "strut $words $json, $1: no JSON"
        ! grep -qE '"(error|residual|energy)":.*null' out || fail "strut $words $json, $1: null"
      fi
    done
  done
}

tail='solver: {step: 0.1 ms}
run: {duration: 1 s}'
ground='ground: {stiffness: 1e5, damping: 10}'
gravity='gravity: [0, -9.81]'
scene() { printf 'strut: 1\n%s\n' "$2" >"$1.yaml" && printf '%s\n' "$tail" >>"$1.yaml"; }
# square SIZE STIFFNESS REST: Snelson's X.
square() {
  echo "nodes:"
  for node in "n1: [0, 0]" "n2: [$1, 0]" "n3: [$1, $1]" "n4: [0, $1]"; do
    echo "  ${node%%:*}: {position:${node#*:}, mass: 0.1}"
  done
  echo "members:"
  for ends in 12 23 34 41; do
    echo "  c$ends: {kind: cable, nodes: [n${ends%?}, n${ends#?}], stiffness: $2, $3}"
  done
  echo "  b1: {kind: bar, nodes: [n1, n3], stiffness: $2}"
  echo "  b2: {kind: bar, nodes: [n2, n4], stiffness: $2}"
}

scene one "nodes: {a: {position: [0, 0], mass: 1}}"
scene one_on_ground "nodes: {a: {position: [0, 0], mass: 1}}
$gravity
$ground"
scene two_in_one "nodes: {a: {position: [0, 0], mass: 1}, b: {position: [0, 0], mass: 1}}"
scene pressed_sideways "$(square 1 1000 'rest_length_ratio: 0.95')
gravity: [9.81, 0]
$ground"
scene slack "$(square 1 1000 'rest_length_ratio: 1.3' | sed 's/bar/cable/')"
scene stiff "$(square 1 1e300 'rest_length_ratio: 0.95')"
scene huge "$(square 1e150 1000 'rest_length_ratio: 0.95')"
scene pushed "$(square 1 1000 'rest_length_ratio: 0.95')
$gravity
$ground
loads: {push: {node: n3, force: [1e300, -1e300]}}"
scene held "nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 100}}"
scene under "$(square 1 1000 'rest_length_ratio: 0.95')
$gravity
ground: {stiffness: 1e5, damping: 10, height: 3 m}"
for name in one one_on_ground two_in_one pressed_sideways slack stiff huge pushed held under; do
  whole "$name"
done

# What is said.
shows 0 "50.3292 Hz" modes one_on_ground.yaml
tells 3 "because nothing presses it down" modes pressed_sideways.yaml
tells 3 "leave the range of numbers" equilibria pushed.yaml --starts 40
tells 3 "the residual is 1e+300 N" form pushed.yaml --given lengths
tells 2 "check their units" modes stiff.yaml
tells 3 "moves away without end, n" modes under.yaml
tells 3 "nodes 'n1' and 'n3', the ends of 'taut', coincide" form "$models/gallery/d-bar.yaml" --given densities
out_empty
