#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The commands for structures at rest on odd scenes: one sentence or an answer without "nan".
. "$(dirname "$0")/lib.sh"

# whole NAME: every command answers or refuses, in words and as JSON, and no number is missing.
whole() {
  for words in "equilibria --starts 1" modes "modes --at drawn" rigidity "rigidity --at start" \
    "form --given densities" "form --given lengths" "form --given prestress"; do
    for json in "" --json; do
      [ "$json" ] || [ "$words" != "equilibria --starts 1" ] || continue # one search will do
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
shows 0 "a friction coefficient of at least 1 holds it" equilibria pushed.yaml --starts 40
tells 3 "leave the range of numbers" equilibria huge.yaml --starts 1
tells 3 "the residual is 1e+300 N" form pushed.yaml --given lengths
tells 2 "check their units" modes stiff.yaml
tells 3 "moves away without end, n" modes under.yaml
refuses 3 "nodes 'n1' and 'n3', the ends of 'taut', coincide" form "$models/gallery/d-bar.yaml" --given densities

# Where it is, and what it is.
pair='strut: 1
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 100}}'
said() { # TEXT: of `check` of the scene on standard input
  cat >said.yaml
  tells 2 "$1" check said.yaml
  grep -q 'said.yaml:[0-9]*:[0-9]*: error' err || fail "no place of: $1"
}
echo "$pair" | sed 's/\[1, 0\]/[1e200, 0]/' | said "the position of node 'b' is more than 1e+150 m away"
said "a number of state 'o' is not finite" <<END
$pair
oscillators: {o: {frequency: 1e308 Hz}}
END
echo "$pair" | sed 's/stiffness: 100/stiffness: 100, mass_model: lumped/' |
  said "unknown key 'mass_model' in member 'm'; it belongs beside 'nodes'"
said "stage 2 ends where it starts: stage 1 took load 'l' to 3 already" <<END
$pair
loads: {l: {node: b, force: [1, 0]}}
path: {stages: [{load: l, until: 3}, {load: l, until: 3}]}
END
echo "$pair
loads: {l: {node: b, force: [1, 0]}}" >pulled.yaml
tells 1 "the path's range from 0 to 1e+308 is too large" path pulled.yaml --until 1e308
printf '# nothing\n# else\n' >said.yaml
tells 2 "the file has comments only" check said.yaml
printf '\377\376\0\0s\0\0\0' >said.yaml
tells 2 "the file is UTF-32" check said.yaml

study='strut: 1
study: S
model: pulled.yaml
keep: [velocity]'
for points in '' 'k'; do
  printf "$points" >points.csv
  echo "$study
axes: [{points: points.csv}]" >study.yaml
  expect 2 check study.yaml
  grep -q 'points.csv:1:1: error' err || fail "no place of a table without rows"
done
for model in .. /etc/passwd .; do
  echo "$study
axes: [{k: [1]}]" | sed "s|pulled.yaml|$model|" >study.yaml
  expect 2 check study.yaml
  grep -q 'study.yaml:3:8: error' err || fail "no place of the model $model"
done
