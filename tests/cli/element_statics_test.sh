#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Hinges, running cables, other laws and stops in paths, rigidity, modes, equilibria and form finding.
. "$(dirname "$0")/lib.sh"

# ---- two links with a hinge, pressed: P = 2 kappa / l, after it 2 kappa theta / (l sin theta) ----
yaml links.yaml <<'END'
parameters: {kappa: 3 N m/rad, rest: 180 deg, press: 1 N}
nodes: {a: {position: [0, 0], fixed: both}, b: [1, 0], c: {position: [2, 0], fixed: y}}
members: {m1: {kind: bar, nodes: [a, b], stiffness: 1e11}, m2: {kind: bar, nodes: [b, c], stiffness: 1e11}}
hinges: {h: {nodes: [a, b, c], stiffness: kappa, rest_angle: rest}}
actuators: {motor: {hinge: h, signal: {sine: {amplitude: 0.1, frequency: 1 Hz}}}}
loads: {p: {node: c, force: [-press, 0]}}
END
expect 0 path links.yaml --until 8 --json
holds '(.events | length) == 1 and .events[0].kind == "bifurcation" and
  .events[0].negative_before == 0 and .events[0].negative_after == 1'
near '.events[0].factor' 6 1e-8
gives '.events[0].value' 0.5 1e-9 path links.yaml --over kappa --from 10 --until 0.1
# The branch: b is displaced, and the load that it needs without a sideways force lies on the curve.
expect 0 path links.yaml --over b.y --until 0.8 --json
jq -r '.points[] | [.nodes.b[1], .reactions.b[1], .moments.h] | @tsv' "$work/out" | awk '
  { s = $1; c = sqrt(1 - s * s); theta = atan2(s, c); pull = 2 * (6 * theta - s) / c
    d = $2 - pull; if (d < 0) d = -d; e = $3 + 6 * theta; if (e < 0) e = -e
    if (d > 1e-8 || e > 1e-8) exit 1; n++ } END { exit !(n > 20) }' || fail "the buckled branch"
# A weak hinge, imperfect by 1e-7 rad, follows the branch beyond the critical load.
expect 0 path links.yaml --set 'rest=3.14159255' --until 7 --json
jq -r '.points[] | select(.factor > 6.1) | [.factor, .nodes.b[1]] | @tsv' "$work/out" | awk '
  { s = $2; theta = atan2(s, sqrt(1 - s * s)); d = $1 - 6 * theta / s; if (d < 0) d = -d
    if (d > 1e-4) exit 1; n++ } END { exit !n }' || fail "load on the buckled branch"
# A driven rest angle goes round as far as wanted; without a load the hinge follows it.
finds '.unit == "rad" and .end == "until"' path links.yaml --over motor --until '100 deg' --set 'press=0 N'
near '.points[-1].nodes.b[1]' -0.766044443118978 1e-9
expect 0 path links.yaml --over b.y --until 0.5 -o turned
head -n 1 turned/path.csv | grep -qF 'm2.force [N],h.moment [N m],' || fail "moments in the table"
shows 0 "h moment" path links.yaml --until 8

# ---- von Mises' truss with a cubic law ----
yaml cubic.yaml <<'END'
parameters: {hard: 20000}
nodes: {left: {position: [-1, 0], fixed: both}, right: {position: [1, 0], fixed: both}, top: [0, 0.3]}
groups: {g: {kind: bar, law: {kind: polynomial, coefficients: [1000, 0, hard]}}}
members: {a: {group: g, nodes: [left, top]}, b: {group: g, nodes: [right, top]}}
loads: {weight: {node: top, force: [0, -1]}}
END
limit=$(awk 'function p(h, l, x) { l = sqrt(1 + h * h); x = l - sqrt(1.09); return -2 * (1000 * x + 20000 * x ^ 3) * h / l }
  BEGIN { a = 0.01; b = 0.29; for (i = 0; i < 200; i++) { c = a + (b - a) / 3; d = b - (b - a) / 3
    if (p(c) > p(d)) b = d; else a = c } printf "%.12g\n", p(a) }')
finds '(.events | length) == 2 and .events[0].kind == "limit point"' path cubic.yaml --until 15
near '.events[0].factor' "$limit" 1e-9 '.events[1].factor' "-$limit" 1e-9
finds '.end == "until" and .unit == ""' path cubic.yaml --over hard --until 40000

# ---- a stop ends a truss's softening: at a length of 1.012 its height is fixed ----
edit 's/law: {.*}}}/stiffness: 1000, shortest: 1.012}}/; /^parameters/d' cubic.yaml expect 0 path --until 30 --json
holds '[.events[].kind] == ["limit point", "engages", "engages", "limit point at a kink"] and
  (.events[1].detail | test("^a reaches its shortest length")) and
  .events[2].negative_after == 0 and .points[-1].stable and .end == "until"'
near '.events[1].nodes.top[1]' 0.155383396796441 1e-12 '.events[1].factor' 9.83603031038155 1e-11
holds 'all(.events[]; has("factor"))'

# ---- a law with a kink: the force beyond it ----
yaml kinked.yaml <<'END'
nodes: {wall: {position: [0, 0], fixed: both}, end: {position: [1, 0], fixed: y}}
members:
  m: {kind: spring, nodes: [wall, end], stiffness: 100, rest_length: 1, law: {kind: bilinear, knee: 0.1, second_stiffness: 10}}
  s: {kind: spring, nodes: [wall, end], stiffness: 1, rest_length: 1.05, law: compression_only}
loads: {pull: {node: end, force: [1, 0]}}
END
expect 0 path kinked.yaml --until 12 --json
holds '[.events[].kind] == ["releases", "kink of a law"] and .events[0].detail == "s ceases to push"'
near '.events[0].factor' 5 1e-12 '.events[1].factor' 10 1e-12 '.points[-1].nodes.end[0]' 1.3 1e-12

# ---- a running cable: a weight hangs on it, its rest length is driven until it is slack ----
yaml ring.yaml <<'END'
parameters: {rest: 2.2 m}
nodes: {a: {position: [-1, 0], fixed: both}, b: {position: [1, 0], fixed: both}, r: [0.1, -0.7],
        s: {position: [1.5, 1], fixed: both}}
members: {m: {kind: cable, nodes: [a, r, b, s], stiffness: 1000 N/m, rest_length: rest},
          soft: {kind: spring, nodes: [r, a], stiffness: 2 N/m, rest_length: 0}}
actuators: {motor: {member: m, signal: {sine: {amplitude: 0.1, frequency: 1 Hz}}}}
loads: {w: {node: r, force: [0, -10]}}
END
# balance FACTOR: the tension of the cable holds the ring on both sides, and bends around b.
balance() {
  jq -r '.points[] | [.nodes.r[0], .nodes.r[1], .nodes.s[0], .forces.m, .reactions.b[0], .reactions.b[1]] | @tsv' \
    "$work/out" | awk '
    function size(x) { return x < 0 ? -x : x }
    { la = sqrt(($1 + 1) ^ 2 + $2 ^ 2); lb = sqrt(($1 - 1) ^ 2 + $2 ^ 2); ls = sqrt(($3 - 1) ^ 2 + 1)
      fx = $4 * ((-1 - $1) / la + (1 - $1) / lb) + 2 * (-1 - $1); fy = $4 * (-$2 / la - $2 / lb) - 2 * $2 - 10
      bx = $4 * (($1 - 1) / lb + ($3 - 1) / ls) + $5; by = $4 * ($2 / lb + 1 / ls) + $6
      if (size(fx) + size(fy) + size(bx) + size(by) > 1e-9) exit 1; n++ } END { exit !(n > 5) }' ||
    fail "balance of a running cable: $*"
}
for over in "motor --until 1m" "rest --until 2.7" "s.x --until -0.4m"; do
  expect 0 path ring.yaml --over $over --json
  balance "$over"
done
expect 0 path ring.yaml --over motor --until '12 m' --json
holds '[.events[].kind] == ["slack"] and .events[0].detail == "m goes slack" and .points[-1].forces.m == 0'

# ---- rigidity: the clustered square has rank 4 and one mechanism; columns of hinges ----
yaml square.yaml <<'END'
nodes: {n1: [0, 0], n2: [1, 1], n3: [2, 0], n4: [1, -1]}
members: {along: {kind: bar, nodes: [n1, n3], stiffness: 1000}, across: {kind: bar, nodes: [n2, n4], stiffness: 1000},
          string_1_2_3: {kind: cable, nodes: [n1, n2, n3], stiffness: 100},
          string_3_4: {kind: cable, nodes: [n3, n4], stiffness: 100},
          string_4_1: {kind: cable, nodes: [n4, n1], stiffness: 100}}
END
expect 0 rigidity square.yaml --json
holds '.rank == 4 and .self_stress.count == 1 and .mechanisms.count == 4 and
  .mechanisms.rigid_body == 3 and .super_stable == null and .classification.cables and
  (.super_stability | startswith("not judged: elements")) and
  .self_stress.states[0].forces.string_1_2_3 == 1 and
  (.self_stress.states[0].forces.along + 1.4142135623730951 | fabs) < 1e-13'
expect 0 rigidity links.yaml --json
holds '.rank == 3 and .hinges == 1 and .self_stress.count == 0 and .mechanisms.count == 0 and
  (.hinges_at.h.angle - 3.141592653589793 | fabs) < 1e-15 and .hinges_at.h.moment == 0'
edit '/^hinges/d; /^actuators/d' links.yaml expect 0 rigidity --json
holds '.rank == 2 and .mechanisms.count == 1'
# A triangle holds its angles: each hinge in it is one more state of self-stress.
yaml triangle.yaml <<'END'
nodes: {a: [0, 0], b: [1, 0], c: [0.3, 1], d: [1.2, 1.1]}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 1000}, bc: {kind: bar, nodes: [b, c], stiffness: 1000},
          ca: {kind: bar, nodes: [c, a], stiffness: 1000}, bd: {kind: bar, nodes: [b, d], stiffness: 1000}}
hinges: {ha: {nodes: [b, a, c], stiffness: 3 N m/rad}, hb: {nodes: [c, b, a], stiffness: 3 N m/rad},
         hd: {nodes: [d, b, c], stiffness: 3 N m/rad}}
END
expect 0 rigidity triangle.yaml --json
holds '.rank == 5 and .self_stress.count == 2 and .mechanisms.count == 3 and
  ([.self_stress.states[].moments.hd | fabs] | max) < 1e-12 and
  (.self_stress.states | map(select((.moments.ha | fabs) > 0.01)) | length) > 0 and
  (.super_stability | startswith("not judged: elements"))'
shows 0 "members - coordinates  -1" rigidity triangle.yaml
formats 0 matrices triangle.yaml -o matrices &&
  { tail -n 1 matrices/columns.csv | grep -q '^7,hd,hinge,d,c,b$' || fail "columns of hinges in the matrices"; }

# A weight on a ring: the cable's tension lends T / sqrt(2) to the motion along the ellipse.
yaml hanging.yaml <<'END'
nodes: {a: {position: [-1, 0], fixed: both}, b: {position: [1, 0], fixed: both}, r: [0, -1]}
members: {m: {kind: cable, nodes: [a, r, b], stiffness: 1e4, rest_length: 2.82771952}}
loads: {w: {node: r, force: [0, -10]}}
END
finds '.rank == 1 and .mechanisms.count == 1 and .mechanisms.infinitesimal == 1' rigidity hanging.yaml --at start
near '.mechanisms.modes[0].stiffness' 5 1e-6
shows 0 "stiffened by the member forces: 5 N/m" rigidity hanging.yaml --at start

# ---- modes: a pendulum with a hinge, (kappa + m g l) / (m l^2); what is named ----
yaml pendulum.yaml <<'END'
gravity: [0, -9.81]
nodes: {w: {position: [0, 1], fixed: both}, o: {position: [0, 0], fixed: both}, m: {position: [0, -2], mass: 3 kg}}
members: {rod: {kind: bar, nodes: [o, m], stiffness: 1e12 N/m}}
hinges: {h: {nodes: [w, o, m], stiffness: 5 N m/rad, damping: 0.1 N m s/rad, rest_angle: 180 deg}}
END
gives '.modes[0].eigenvalue' 5.32166666666667 1e-9 modes pendulum.yaml
near '.modes[0].damping_ratio' 0.00180614 1e-7
holds '(.modes[0].description | test("h 100 % of the energy")) and .modes[0].error < 1e-10'
shows 0 geometric modes pendulum.yaml
edit '/^gravity/d' pendulum.yaml shows 0 "h 100 % of the energy" modes
out_has_not geometric
finds '[.equilibria[] | select(.label == "stable")] | length == 1' equilibria pendulum.yaml

# ---- equilibria: the tension of a running cable, and a hinge that prefers one side ----
finds '(.equilibria[0].forces.m > 100) and .equilibria[0].label == "stable"' equilibria ring.yaml
yaml sided.yaml <<'END'
nodes: {a: {position: [-1, 0], fixed: both}, b: [0, 0.4], c: {position: [1, 0], fixed: both}}
members: {m1: {kind: bar, nodes: [a, b], stiffness: 1e5}, m2: {kind: bar, nodes: [b, c], stiffness: 1e5}}
hinges: {h: {nodes: [a, b, c], stiffness: 3 N m/rad}}
END
expect 0 equilibria sided.yaml --json
holds '[.equilibria[] | select(.label == "stable")] | length == 2 and .[0].energy < 1e-12 and
  (.[1].energy - 3.4739 | fabs) < 0.01'

# ---- form finding says what it does not know ----
tells 2 "knows straight members with a linear law only: string_1_2_3 runs over guides" form square.yaml
tells 2 "ha is a hinge" form triangle.yaml
tells 2 "m has another law" form kinked.yaml --given prestress
gives .residual 0 1e-9 form ring.yaml

# A ring that is pulled to the end of its cable: the path ends there, and says which segment is gone.
yaml shrink.yaml <<'END'
nodes: {left: {position: [0, 0], fixed: both}, ring: {position: [0.4, 0], fixed: y},
        right: {position: [0.8, 0], fixed: both}}
members: {string: {kind: cable, nodes: [left, ring, right], stiffness: 1 kN/m, rest_length: 0.7 m},
          hold: {kind: spring, nodes: [left, ring], stiffness: 10 N/m}}
loads: {pull: {node: ring, force: [1 N, 0]}}
END
gives '.points[-1].factor' 4 1e-6 path shrink.yaml --load pull --until 20
holds '.end == "lost" and (.remark | endswith("no equilibrium was found nearby beyond it; a segment of cable '"'string'"' has shrunk to nothing there, between nodes '"'ring' and 'right'"'"))'

# What is rounding is 0 in reports: forces of a cable that went slack, and of a structure without any, whose
# balance is not judged by them.
yaml slack.yaml <<'END'
nodes: {left: {position: [0, 0], fixed: both}, ring: {position: [0.4, -0.3]},
        right: {position: [0.8, 0], fixed: both}}
members: {string: {kind: cable, nodes: [left, ring, right], stiffness: 1 kN/m, rest_length: 0.9 m},
          hold: {kind: spring, nodes: [ring, right], stiffness: 1 N/m}}
loads: {pull: {node: ring, force: [0, -10 N]}}
END
expect 0 path slack.yaml --over ring.y --until 0.31
grep -qE 'right support x +9.20054 N +0 N' out || fail "a force that is rounding"
yaml chain.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: [1, 0.3], c: {position: [2, 0], fixed: both}}
members: {one: {kind: bar, nodes: [a, b], stiffness: 1 N/m, rest_length: sqrt(1.09)*1 m*(1 + 2.3e-16)},
          two: {kind: bar, nodes: [b, c], stiffness: 1 N/m, rest_length: sqrt(1.09)*1 m*(1 + 2.3e-16)}}
END
shows 0 '  equilibrium                              yes' rigidity chain.yaml
out_has_not 'fN'
