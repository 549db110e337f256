#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Copies of parts: the same structure however it is flipped, turned, repeated or written out.
. "$(dirname "$0")/lib.sh"

# A part with every kind of thing, from a good file. Gravity and ground turn with it.
sed '/^limit_things/d; /^  rod:/,/^    merge: touching/d; /^  row:/,/^  onto:/d; s/row.1.m: {[^}]*}, //; s/, "row.*/}/' \
  "$here/../language/good/parts.yaml" >kitchen.yaml

# place FLIP TURN FX FY: that scene with the part placed so.
place() {
  sed "s/flip: no/flip: $1/; s/turn: 0 deg/turn: $2 deg/; s/fx: 1, fy: 1/fx: $3, fy: $4/" kitchen.yaml
}

# still FILE: without what moves by itself, and without ground.
still() {
  sed '/^ground/d; /^gravity/d; /^    contacts/d; s/, touch: {contact: a}//; s/touch.1 rad.s + //
       s/, maxwell: {[^}]*}//; s/^ *still: .*/}/; /^ *push: /d' "$1"
}

run='[.measured[].value, (.energy | .elastic, .kinetic, .dissipated_members, .dissipated_friction, .contact)]'
least='[.equilibria[] | select(.label == "stable") | .energy] | min'
for row in "no 1 1" "x -1 1" "y 1 -1" "both -1 -1"; do
  set -- $row; flip=$1 fx=$2 fy=$3
  for turn in 0 90 37; do
    place "$flip" $turn "$fx" "$fy" >placed.yaml
    still placed.yaml >still.yaml
    expect 0 run placed.yaml --json
    jq -c "$run" out >run.$flip.$turn
    expect 0 modes still.yaml --json
    jq -c '[.modes[].frequency]' out >modes.$flip.$turn
    expect 0 check still.yaml --json
    jq -c '[.largest_frequency, .step_limit]' out >check.$flip.$turn
    for what in run modes check; do
      jq -en --slurpfile a $what.no.0 --slurpfile b $what.$flip.$turn '($a[0] | length) > 1 and
        ([range($a[0] | length) as $i | ($a[0][$i] - $b[0][$i] | fabs) / ([1, ($a[0][$i] | fabs)] | max)]
         | max) < 1e-10' >/dev/null || fail "$what of flip $flip, turn $turn: $(cat $what.no.0 $what.$flip.$turn)"
    done
  done
done
jq -e 'map(fabs) | min > 1e-6' run.no.0 >/dev/null || fail "some of it does nothing: $(cat run.no.0)"
place no 0 1 1 >placed.yaml
still placed.yaml >still.yaml
expect 0 equilibria still.yaml --json
jq "$least" out >one
place x 37 -1 1 >placed.yaml
still placed.yaml >still.yaml
expect 0 equilibria still.yaml --json
jq "$least" out >other
jq -en --slurpfile a one --slurpfile b other '($a[0] - $b[0] | fabs) < 1e-12' >/dev/null ||
  fail "energies of an equilibrium: $(cat one other)"

# A chain by `next`, by `merge: touching` and by hand is one model.
yaml next.yaml <<'END'
groups: {bar: {kind: bar, stiffness: 1 kN/m, mass: 0.1 kg}}
parts:
  frame:
    nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 2}, c: [1, 1], d: [0, 1]}
    members: {bottom: {group: bar, nodes: [a, b]}, top: {group: bar, nodes: [d, c]},
              right: {group: bar, nodes: [b, c]}, rising: {group: bar, nodes: [a, c]}}
    loads: {wind: {node: d, force: [1, 0]}}
place: {cell: {part: frame, repeat: {count: 3, step: [1, 0], next: {merge: {b: a, c: d}}}}}
END
sed 's/, next: {merge: {b: a, c: d}}//; $a merge: touching' next.yaml >touching.yaml
jq -nr '"strut: 1", "groups: {bar: {kind: bar, stiffness: 1 kN/m, mass: 0.1 kg}}", "nodes:",
  "  cell.0.a: {position: [0, 0], mass: 1}", "  cell.0.d: [0, 1]",
  (range(3) | "  cell.\(.).b: {position: [\(. + 1), 0], mass: \(if . == 2 then 2 else 3 end)}",
    "  cell.\(.).c: [\(. + 1), 1]"), "members:",
  (range(3) | (if . == 0 then "cell.0.a" else "cell.\(. - 1).b" end) as $a
    | (if . == 0 then "cell.0.d" else "cell.\(. - 1).c" end) as $d
    | "  cell.\(.).bottom: {group: bar, nodes: [\($a), cell.\(.).b]}",
      "  cell.\(.).top: {group: bar, nodes: [\($d), cell.\(.).c]}",
      "  cell.\(.).right: {group: bar, nodes: [cell.\(.).b, cell.\(.).c]}",
      "  cell.\(.).rising: {group: bar, nodes: [\($a), cell.\(.).c]}"), "loads:",
  (range(3) | (if . == 0 then "cell.0.d" else "cell.\(. - 1).c" end) as $d
    | "  cell.\(.).wind: {node: \($d), force: [1, 0]}")' >hand.yaml
for way in next touching hand; do
  expect 0 export $way.yaml
  sort out >$way.sorted
done
cmp next.sorted touching.sorted || fail "by next and by touching"
cmp next.sorted hand.sorted || fail "by next and by hand: $(diff next.sorted hand.sorted)"

# Turning by 360 degrees is none, also where a copy is moved and scaled.
for repeat in 'turn: 360 deg' 'turn: 0 deg' 'turn: 720 deg'; do
  edit "s/step: \[1, 0\], next: {merge: {b: a, c: d}}/step: [2, 1], scale: 2, $repeat/" next.yaml expect 0 export
  sort out >turned.sorted
  [ -e first.sorted ] || cp turned.sorted first.sorted
  cmp turned.sorted first.sorted || fail "$repeat: $(diff turned.sorted first.sorted)"
done
# Copy 2 lies at (2, 1) + 2 (2, 1), four times as large.
grep -q 'cell.2.c: \[10, 7\]' first.sorted || fail "scaled copies: $(grep 'cell.2.c' first.sorted)"

# Late copies cost no more than early ones.
yaml long.yaml <<'END'
parts: {dot: {nodes: {n: {position: [0, 0], mass: 1}}}}
place: {d: {part: dot, repeat: {count: 20000, step: [1 mm, 0], turn: 1e-5 deg, scale: 0.99999}}}
END
expect 0 check long.yaml

# Chains of 3 and 4 cells, and of 4 and 7, differ by whole cells, and by the mass at the seam.
for cells in 3 4 7; do
  sed "s/count: 3/count: $cells/" next.yaml >chain-$cells.yaml
done
expect 0 compare chain-3.yaml chain-4.yaml --no-states --json
holds '[.models[1].differences[] | [.where, .was, .is]] ==
  [["nodes.cell.2.b.mass", "2", "3"], ["cell.3", null, "2 nodes, 4 members, 1 load"]]'
expect 0 compare chain-7.yaml chain-4.yaml --no-states --json
holds '[.models[1].differences[] | [.where, .was, .is]] ==
  [["nodes.cell.3.b.mass", "3", "2"], ["cell.4 to cell.6", "each 2 nodes, 4 members, 1 load", null]]'
