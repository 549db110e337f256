#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Copies of parts: the same structure however it is flipped, turned, repeated or written out.
. "$(dirname "$0")/lib.sh"

# A part with every kind of thing. Gravity and ground turn with it.
yaml kitchen.yaml <<'END'
parameters: {turn: 0 deg, fx: 1, fy: 1, co: cos(turn), si: sin(turn)}
gravity: [fy*si*9.81 m/s^2, -fy*co*9.81 m/s^2]
groups: {joint: {mass: 50 g}}
parts:
  kitchen:
    nodes:
      a: {position: [0, 0], group: joint}
      b: {position: [300 mm, 0], group: joint}
      c: {position: [300 mm, 200 mm], group: joint}
      d: {position: [0, 200 mm], group: joint}
      e: {position: [450 mm, 100 mm], group: joint}
      f: {position: [150 mm, 230 mm], group: joint}
    members:
      bottom: {kind: spring, nodes: [a, b], stiffness: 2 kN/m, damping: 3 N s/m}
      top: {kind: bar, nodes: [d, c], stiffness: 2 kN/m, damping: 3 N s/m}
      right: {kind: cable, nodes: [b, c], stiffness: 1 kN/m, rest_length_ratio: 0.95, damping: 1 N s/m}
      left: {kind: cable, nodes: [a, d], stiffness: 1 kN/m, rest_length_ratio: 0.95}
      rising: {kind: bar, nodes: [a, c], stiffness: 5 kN/m, mass: 30 g}
      falling: {kind: bar, nodes: [d, b], law: {kind: polynomial, coefficients: [5 kN/m, 0, 100 kN/m^3]}}
      nose: {kind: spring, nodes: [c, e], stiffness: 500 N/m, maxwell: {stiffness: 200 N/m, damping: 1 N s/m}}
      chin: {kind: spring, nodes: [b, e], stiffness: 500 N/m, shortest: 170 mm, stop_stiffness: 10 kN/m}
      over: {kind: cable, nodes: [d, f, c], stiffness: 300 N/m, pretension: 2 N}
    hinges:
      bend: {nodes: [a, b, e], stiffness: 0.5 N m/rad, damping: 1 mN m s/rad}
    cells:
      bag: {nodes: [a, b, c, d], gas: {kind: isothermal, pressure: 100 N/m, outside: 90 N/m}}
      puff: {nodes: [b, e, c], pressure: 5 N/m}
    collisions:
      hit: {node: f, member: top, thickness: 35 mm, stiffness: 1 kN/m}
    beams:
      lash: {nodes: [d, f], bending_stiffness: 0.01 N m^2, axial_stiffness: 300 N, parts: 2, mass: 10 g}
    signals:
      wave: {sine: {amplitude: 5 mm, frequency: 3 Hz, phase: 30 deg}}
    actuators:
      swell: {member: bottom, signal: wave}
      curl: {hinge: bend, signal: {sine: {amplitude: 10 deg, frequency: 2 Hz}}}
      push: {member: top, force: {constant: 0.5 N}}
      turn: {hinge: bend, moment: {constant: 10 mN m}}
      held: {member: nose, signal: hold}
      beat: {member: chin, signal: {expression: 2 mm*sin(clock)}}
    loads:
      wind: {node: e, force: [0.3 N, -0.2 N], signal: {sine: {amplitude: 1, frequency: 1 Hz}}}
      still: {node: f, force: [0.1 N, 0.2 N]}
    unbalances:
      motor: {node: d, mass: 5 g, radius: 5 mm, speed: 4 Hz, phase: 20 deg}
    sensors:
      l: {length: rising}
      angle: {angle: bend}
      touch: {contact: a}
    states:
      z: {rate: (l - z)/(0.2 s), start: 0.36 m}
    oscillators:
      clock: {frequency: 2 Hz, phase: 10 deg, feedback: "touch*1 rad/s + (angle - 150 deg)/(1 s)"}
    controllers:
      hold: {sensor: l, target: 360 mm, gain: 0.3, integral: 0.2 Hz, every: 2 ms}
    configurations:
      other: {e: [440 mm, 120 mm], f: [150 mm, 240 mm]}
    contacts:
      a: {friction: {mu_forward: 0.1, mu_backward: 0.6}}
      b: {stiffness: 3 kN/m, friction: {mu: 0.2}}
place:
  k: {part: kitchen, flip: no, turn: turn, at: [1 m, 2 m]}
nodes: {k.e: {mass: 70 g}}
sensors: {kin: {energy: kinetic}}
configurations: {drawn: {}}
ground: {through: [1 m + si*fy*1 mm, 2 m - co*fy*1 mm], normal: [-fy*si, fy*co], stiffness: 5 kN/m, damping: 5 N s/m, friction: {law: smooth, mu: 0.3, width: 10 mm/s}, nodes: [k.a]}
solver: {integrator: rk4, step: 0.02 ms}
run:
  duration: 0.05 s
  measure:
    quantities:
      l1: {of: k.rising.length, take: final}
      l2: {of: k.nose.length, take: final}
      l3: {of: k.chin.length, take: final}
      f1: {of: k.left.force, take: final}
      f2: {of: k.falling.force, take: final}
      f3: {of: k.over.force, take: final}
      ang: {of: k.angle, take: final}
      z: {of: k.z, take: final}
      o: {of: k.clock, take: final}
      ke: {of: kin, take: final}
END

# place FLIP TURN FX FY: that scene with the part placed so.
place() {
  sed "s/flip: no/flip: $1/; s/turn: 0 deg/turn: $2 deg/; s/fx: 1, fy: 1/fx: $3, fy: $4/" kitchen.yaml
}

# still FILE: without what moves by itself, and without ground.
still() {
  sed '/^ground/d; /^gravity/d; /^    contacts/,/^      b:/d; /touch: /d; s/touch.1 rad.s + //
       s/, maxwell: {[^}]*}//; /^      still:/d; /moment: /d; /force: {constant/d' "$1"
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
