#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Settling: one state for all commands, unstable ones reported and left, once for an accurate run.
. "$(dirname "$0")/lib.sh"

yaml rod.yaml <<'END'
name: Upright rod
gravity: [0, -9.81]
nodes: {pin: {position: [0, 0], fixed: both}, tip: {position: [0, 1], mass: 1}}
members: {rod: {kind: bar, nodes: [pin, tip], stiffness: 1e5, damping: 10}}
initial: {settle: true}
solver: {step: 1 ms}
run: {duration: 1 s}
END

# Unstable: said by run, by modes and by equilibria, with the node.
for command in "run" "run --accuracy 1%" "run --quiet"; do
  tells 0 "unstable equilibrium" ${command%% *} rod.yaml ${command#run}
  err_has "node 'tip'" "initial.settle.perturb"
done
shows 0 "UNSTABLE" run rod.yaml
expect 0 run rod.yaml --json
out_has '"stable":	false' '"node":	"tip"' '"growth_rate":	3.13' '"perturbations":	0'
shows 0 "unstable equilibrium" modes rod.yaml
out_has "node 'tip'" "unstable  tip moves along x"
shows 0 "the start settles in                       saddle-1" equilibria rod.yaml
out_has "unstable equilibrium"

# Pushed off it hangs, for all of them.
sed 's/settle: true/settle: {perturb: yes}/' rod.yaml >hangs.yaml
for command in "run" "run --accuracy 1%" "modes" "equilibria"; do
  expect 0 ${command%% *} hangs.yaml ${command#"${command%% *}"}
  err_empty
  out_has_not "nstable equilibrium:"
done
shows 0 '"stable":	true' run hangs.yaml --json
out_has '"perturbations":	1'
holds '.nodes.tip.position[1] < -1'
finds '.modes[0].kind == "elastic"' modes hangs.yaml

# A jumper: any method, any step and any accuracy start it from the same bits.
yaml jumper.yaml <<'END'
name: Rhombus jumper
parameters: {a: 100 mm, b: 50 mm, ks: 800 N/m, release: 0.2 s}
gravity: [0, -9.81 m/s^2]
groups: {leg: {kind: bar, stiffness: 1e6 N/m, mass: 10 g, damping: 2 N s/m}}
nodes: {foot: {position: [0, 0], mass: 5 g}, left: [-a, b], right: [a, b], top: {position: [0, 2*b], mass: 60 g}}
members: {l1: {group: leg, nodes: [foot, left]}, l2: {group: leg, nodes: [foot, right]},
          l3: {group: leg, nodes: [left, top]}, l4: {group: leg, nodes: [right, top]},
          muscle: {kind: spring, nodes: [left, right], stiffness: ks, rest_length: 80 mm},
          latch: {kind: cable, nodes: [foot, top], stiffness: 1e5 N/m, damping: 5 N s/m}}
actuators: {let_go: {member: latch, signal: {table: [[0, 0], [release, 0], [release + 0.1 ms, 0.3 m]]}}}
ground: {stiffness: 5e4 N/m, damping: 50 N s/m, friction: {mu: 0.5, stick_velocity: 1 mm/s}}
initial: {settle: true}
solver: {step: 10 us}
run: {duration: 0.1 s}
output: {every: 10 ms, channels: [position]}
END
tells 0 "unstable equilibrium" run jumper.yaml --quiet -o plain
head -2 plain/nodes.csv >start
i=0
for way in "--accuracy 1%" "--integrator verlet-events --step 50us" "--integrator adaptive --step 1ms"; do
  i=$((i + 1))
  expect 0 run jumper.yaml --quiet $way -o "way-$i"
  head -2 "way-$i/nodes.csv" >other
  same start other
  # What was run gives the same bits again: the step of settling is written down.
  expect 0 run "way-$i/scene.yaml" --quiet -o "again-$i"
  same "way-$i/nodes.csv" "again-$i/nodes.csv"
done

# So does a file without a step: that of the command is not that of settling.
grep -v '^solver' jumper.yaml >stepless.yaml
expect 0 run stepless.yaml --quiet --integrator rk4 --step 20us -o stepless
expect 0 run stepless/scene.yaml --quiet -o stepless-again
same stepless/nodes.csv stepless-again/nodes.csv

# An accurate run settles once. It took minutes, each of its runs settling by its own method.
yaml cell.yaml <<'END'
name: Leaning X-cell crawler
parameters: {f: 14 Hz, A: 3.5 mm, mu: 0.3, T: 6 N, lean: 20 mm}
gravity: [0, -9.81 m/s^2]
groups: {rod: {kind: bar, stiffness: 2e4 N/m, mass: 30 g, damping: 2 N s/m},
         rope: {kind: cable, stiffness: 600 N/m, pretension: T, damping: 0.6 N s/m}}
nodes: {bl: [0, 0], br: [100 mm, 0], tl: [lean, 80 mm], tr: {position: [100 mm + lean, 80 mm], mass: 20 g}}
members: {rise: {group: rod, nodes: [bl, tr]}, fall: {group: rod, nodes: [br, tl]},
          bottom: {group: rope, nodes: [bl, br]}, top: {group: rope, nodes: [tl, tr]},
          left: {group: rope, nodes: [bl, tl]}, right: {group: rope, nodes: [br, tr]}}
actuators: {drive: {member: right, signal: {sine: {amplitude: A, frequency: f}}}}
ground: {stiffness: 2e4 N/m, damping: 20 N s/m, friction: {mu: mu, stick_velocity: 0.1 mm/s}}
initial: {settle: true}
solver: {step: 50 us}
run: {periods: 100, of: drive, measure: {last: 20}}
output: {last: 5}
END
expect 0 run cell.yaml --json
evaluations=$(jq .settle.evaluations out)
expect 5 run cell.yaml --accuracy 5% --json
[ "$(jq .settle.evaluations out)" = "$evaluations" ] || fail "it settled in another way"
[ "$evaluations" -lt 50000 ] || fail "settling took $evaluations evaluations"
holds '.force_evaluations + .accuracy.check_evaluations < 1e7'

# What never rests ends, and says what moves, how fast, and what to do.
yaml falls.yaml <<'END'
nodes: {stone: {position: [0, 0], mass: 1 kg}}
gravity: [0, -9.81]
initial: {settle: {evaluations: 4000}}
solver: {step: 1 ms}
run: {duration: 1 s}
END
tells 3 "4000 evaluations" run falls.yaml
err_has "9.81 m/s," "9.81 m/s^2" "node 'stone'" "initial.settle.evaluations"
tells 3 "4000 evaluations" run falls.yaml --accuracy 1%
shows 3 "the structure did not come to rest" equilibria falls.yaml
out_has "4000 evaluations"
sed -i 's/evaluations: 4000/speed: 1e-9/' falls.yaml
tells 3 "did not come to rest" run falls.yaml
