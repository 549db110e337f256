#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Cells under pressure and filled with gas, through the program, against closed forms.
. "$(dirname "$0")/lib.sh"

# ring N CELL: a regular polygon of N stiff bars with circumradius 1 m.
ring() {
  jq -nr --argjson n "$1" --arg cell "$2" '6.283185307179586 as $turn
    | "strut: 1", "groups: {rod: {kind: bar, stiffness: 1e9}}", "nodes:",
      (range($n) | "  n\(.): {position: [\(. / $n * $turn | cos), \(. / $n * $turn | sin)], mass: 1\(
        if . == 0 then ", fixed: both" else "" end)}"),
      "members:", (range($n) | "  m\(.): {group: rod, nodes: [n\(.), n\((. + 1) % $n)]}"),
      "cells: {c: {nodes: [\([range($n) | "n\(.)"] | join(", "))], \($cell)}}"'
}

# A ring carries T = p R cos(pi / n), whichever way round the cell is written.
for n in 3 6 12; do
  ring $n "pressure: 100 N/m" >ring.yaml
  gives '.self_stress.count' 1 0 rigidity ring.yaml
  near '.self_stress.states[0] | .pressures.c / .forces.m0' "1 / (3.141592653589793 / $n | cos)" 1e-9
  near '[.cells_at.c.area, .cells_at.c.pressure]' "[($n / 2 * (6.283185307179586 / $n | sin)), 100]" 1e-9
done
ring 6 "pressure: 100 N/m" | sed 's/\[n0, n1, n2, n3, n4, n5\]/[n5, n4, n3, n2, n1, n0]/' >back.yaml
ring 6 "pressure: 100 N/m" >ring.yaml
for file in ring back; do
  gives '[.equilibria[] | select(.label == "stable" or .label == "neutral")] | length' 1 0 equilibria $file.yaml
  near '.equilibria[0].forces | [.m0, .m2, .m5]' '100 * (3.141592653589793 / 6 | cos) | [., ., .]' 1e-4
done

# A cylinder with a lid of mass 2 kg and width 1 m, 2 m high: work of the gas, and its frequency
# omega^2 = exponent p w^2 / (A m).
piston() {
  yaml <<END
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both},
        c: {position: [1, 2], mass: 1, fixed: x}, d: {position: [0, 2], mass: 1, fixed: x}}
members: {lid: {kind: bar, nodes: [d, c], stiffness: 1e4}}
cells: {air: {nodes: [a, d, c, b], $1}}
initial: {velocities: {c: [0, $2], d: [0, $2]}}
solver: {integrator: $3, step: $4}
run: {duration: 1 s, measure: {quantities: {total: {of: energy.total, take: range},
        area: {of: air.area, take: final}, pressure: {of: cell(air).pressure, take: final}}}}
output: {channels: [position, area, pressure, energy]}
END
}
piston "gas: {kind: isentropic, pressure: 50 N/m, outside: 50 N/m}" 1 rk4 "1 ms" >piston.yaml
gives '.modes[-1].angular_frequency' '1.4 * 50 / (2 * 2) | sqrt' 1e-6 modes piston.yaml
out_has "air 100"
piston "gas: {kind: isothermal, pressure: 50 N/m, outside: 50 N/m}" 1 rk4 "1 ms" >isothermal.yaml
gives '.modes[-1].angular_frequency' '50 / (2 * 2) | sqrt' 1e-6 modes isothermal.yaml

# In every method, with p A^exponent constant and the balance closed.
# The energy of the gas has the work against the outside.
piston "gas: {kind: isentropic, pressure: 50 N/m, outside: 50 N/m}" 1 rk4 "0.2 ms" >gas.yaml
by "rk4 euler verlet rk4-events verlet-events euler-events adaptive midpoint" gas.yaml \
  '.measured | .pressure.value * ((.area.value | log * 1.4) | exp)' '50 * (2 | log * 1.4 | exp)' 1e-8 \
  .measured.area.value 1.822351 1e-4 '.energy.residual / .energy.exchanged' 0 1e-3 \
  .energy.elastic '.cells.air.area as $a | 50 * 2 / 0.4 * ((2 / $a | log * 0.4 | exp) - 1) + 50 * ($a - 2)' 1e-9
expect 0 run gas.yaml -o gas --quiet
head -n 1 gas/cells.csv >out
out_has "time [s],air.area [m^2],air.pressure [N/m]"
by rk4 isothermal.yaml .measured.total.value 0 1e-9 \
  .energy.elastic '.cells.air.area as $a | 50 * 2 * (2 / $a | log) + 50 * ($a - 2)' 1e-9

# A pressure that a signal drives: the work of the drive closes the balance.
piston "pressure: 10 N/m" 0 rk4 "1 ms" >driven.yaml
echo 'actuators: {pump: {cell: air, signal: {sine: {amplitude: 5 N/m, frequency: 1 Hz}}}}
loads: {weight: {node: c, force: [0, -10 N]}}' >>driven.yaml
# acceleration 5 sin(w t) / 2: the lid's mean height after one period is 5 / 2 / w
by "rk4 midpoint adaptive rk4-events" driven.yaml '.energy.residual / .energy.exchanged' 0 1e-5 \
  .measured.pressure.value 10 1e-9 .measured.area.value '2 + 2.5 / 6.283185307179586' 2e-3

# A path over the pressure: two links that a cell pushes up against springs keep equilibrium.
yaml bulge.yaml <<'END'
parameters: {p: 5 N/m}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0.1]}, c: {position: [2, 0], fixed: both}}
members: {ab: {kind: spring, nodes: [a, b], stiffness: 100}, bc: {kind: spring, nodes: [b, c], stiffness: 100}}
cells: {bag: {nodes: [a, b, c], pressure: p}}
END
sed '$a actuators: {pump: {cell: bag, signal: {constant: 0}}}' bulge.yaml >pump.yaml
expect 0 path bulge.yaml --over p --until 30 --json
# at b: 2 T sin = p * span / 2, with the area's gradient 1 m
near '.points[-1] | .nodes.b[1] as $y | 2 * .forces.ab * $y / (1 + $y * $y | sqrt)' 30 1e-6 \
  '.points[-1].pressures.bag' 30 1e-9
gives '.points[-1].nodes.b[1]' "$(jq '.points[-1].nodes.b[1]' out)" 1e-9 path pump.yaml --over pump --until 25

# A cell that is pressed flat stops the run with its name and the time.
piston "gas: {kind: isothermal, pressure: 50 N/m}" -1000 rk4 "1 ms" >flat.yaml
tells 3 "the area of cell 'air' reached zero at t = 0.002 s" run flat.yaml

# An elastic cell: a triangle whose apex swings at 1 Hz by the law of its area, and is damped by its rate.
yaml tent.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [2, 0], fixed: both}, top: {position: [1, 1.5], mass: 1, fixed: x}}
cells: {air: {nodes: [b, a, top], stiffness: "4 * pi^2", rest_area: 1 m^2}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 0.25 s, measure: {quantities: {area: {of: air.area, take: final}, p: {of: air.pressure, take: min},
        y: {of: top.y, take: final}}}}
YAML
by "rk4 adaptive midpoint verlet rk4-events" tent.yaml .measured.area.value 1 1e-4 \
  '.measured | [.y, .p | .value]' '[1, -2 * 3.141592653589793 * 3.141592653589793]' 1e-4 \
  '.energy.residual / .energy.exchanged' 0 1e-5
gives '.modes[0].frequency' 1 1e-9 modes tent.yaml --at drawn
gives '[.equilibria[].energy] | min' 0 1e-12 equilibria tent.yaml
shows 0 "elastic" check tent.yaml
writes_back tent.yaml
gives .measured.y.value 1 1e-4 run written.yaml
# with a one-sided cubic law the apex stands where its weight is carried, twice as high in a part of twice the size
yaml cushion.yaml <<'YAML'
gravity: [0, -10 m/s^2]
parts:
  cushion:
    nodes: {a: {position: [0, 0], fixed: both}, b: {position: [2, 0], fixed: both}, top: {position: [1, 1.5], mass: 1, fixed: x}}
    cells: {air: {nodes: [a, b, top], rest_area: 1.5 m^2, law: {kind: polynomial, coefficients: [0, 0, 80 N/m^7], carries: compression}}}
place: {small: {part: cushion}, large: {part: cushion, scale: 2, at: [9, 0]}}
YAML
gives '.points[0].nodes["small.top"][1]' 1 1e-9 path cushion.yaml --over small.top.x --until 1.0001
near '.points[0].nodes["large.top"][1]' '(6 - (pow(0.5 / 8; 1 / 3))) / 2' 1e-9 '.points[0].pressures["small.air"]' 10 1e-9

# Gas flows through a pipe until pressures are alike: by exp(-C (1/A + 1/B) t) where areas stay, and none is lost.
yaml pipe.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}, c: {position: [1, 1], fixed: both},
        d: {position: [0, 1], fixed: both}, e: {position: [3, 0], fixed: both}, f: {position: [3, 1], fixed: both},
        w: {position: [9, 0], mass: 1}}
cells: {small: {nodes: [a, b, c, d], gas: {kind: isothermal, pressure: 5 N/m, outside: 1 N/m}},
        large: {nodes: [b, e, f, c], gas: {kind: isothermal, pressure: 2 N/m, outside: 1 N/m}}}
pipes: {p: {cells: [small, large], conductance: 0.4 m^2/s}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 2 s, measure: {quantities: {all: {of: 1 m^2 * small.pressure + 2 m^2 * large.pressure, take: range},
        small: {of: small.pressure, take: final}, large: {of: large.pressure, take: final}, flowed: {of: p, take: final}}}}
YAML
by "rk4:1e-10 rk4-events:1e-6 adaptive:1e-6 verlet:1e-6 midpoint:1e-6" pipe.yaml .measured.all.value 0 1e-12 \
  '.measured | [.small, .large, .flowed | .value]' '(-0.4 * 1.5 * 2 | exp) as $e | [3 + 2 * $e, 3 - $e, 2 - 2 * $e]' own
writes_back pipe.yaml
gives '.measured.small.value' '3 + 2 * (-0.4 * 1.5 * 2 | exp)' 1e-10 run written.yaml
# a piston that is pushed in presses gas into the other cell until both press alike; the balance closes with what the pipe takes
sed -e 's/ e: {position: .3, 0., fixed: both}/ e: {position: [3, 0], fixed: y, mass: 1}/' \
  -e 's/ f: {position: .3, 1., fixed: both}/ f: {position: [3, 1], fixed: y, mass: 1}/' \
  -e 's/^cells:/members: {lid: {kind: bar, nodes: [e, f], stiffness: 1000}}\nrayleigh: {mass: 2 s^-1}\ncells:/' \
  -e 's/duration: 2 s/duration: 300 s/' pipe.yaml >piston2.yaml
by "rk4 adaptive midpoint" piston2.yaml .measured.small.value 1 1e-3 \
  '.measured | [.large, .flowed | .value]' '[1, 4]' 1e-3 '.energy.residual / .energy.exchanged' 0 1e-4

# Everything else knows cells.
shows 0 "isentropic gas" check piston.yaml
gives '.cells.air.drawn_area' 2 1e-12 check piston.yaml
writes_back piston.yaml
expect 0 run piston.yaml -o pictures --quiet --plot piston.svg
expect 0 view pictures -o page.html
grep -q "\"name\":\"air\",\"nodes\":\[0, 3, 2, 1\]" page.html || fail "no cell on the page"
formats 0 matrices piston.yaml -o matrices &&
  { grep -q 'air,cell,a,b,d c' matrices/columns.csv || fail "no column of the cell"; }
tells 2 "bag is a cell" form bulge.yaml
