#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# One way to ask: options that all commands know, those that one refuses with its reason, `strut MODEL` alone, and
# studies whose runs the command line changes.
. "$(dirname "$0")/lib.sh"

yaml hop.yaml <<'YAML'
parameters: {seconds: 50 ms, mass: 1 kg}
nodes: {ball: {position: [0, 0], mass: mass}, top: {position: [0, 1 m], fixed: both}}
members: {spring: {kind: spring, nodes: [ball, top], stiffness: 400 N/m, damping: 1 N s/m}}
gravity: [0, -9.81]
solver: {step: 1 ms}
run: {duration: seconds}
YAML
yaml truss.yaml <<'YAML'
parameters: {load: 1 N}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0.3], mass: 1}, c: {position: [2, 0], fixed: both}}
members: {ab: {nodes: [a, b], kind: bar, stiffness: 1000}, bc: {nodes: [b, c], kind: bar, stiffness: 1000}}
loads: {push: {node: b, force: [0, -load]}}
YAML
yaml masses.yaml <<'YAML'
study: Mass and time
model: hop.yaml
axes: [{mass: [1 kg, 2 kg]}]
keep: [steps, method, final_height]
YAML
sed -i 's/, final_height//' masses.yaml

# Every command that computes knows these options: it takes them, or says why not.
for command in run sweep compare tradeoff equilibria path modes rigidity form check; do
  expect 0 $command --help
  cp out help
  for option in accuracy integrator step threads set json plot output quiet; do
    grep -q -- "--$option" help && continue
    tells 1 "strut $command: --$option cannot be used here: " $command truss.yaml --$option
  done
done
tells 1 "--accuracy cannot be used here: equilibria are computed to rounding errors" equilibria truss.yaml --accuracy 1%
tells 1 "--step-sizes says how many" tradeoff hop.yaml --step=1ms
tells 1 "--threads expects a whole number from 1 to 4096" run hop.yaml --threads 0

# A model alone: what it is for.
shows 0 "velocity" hop.yaml
shows 0 '"steps":	20,' hop.yaml --set seconds=20ms --json
shows 0 '"barriers"' truss.yaml --quiet --json
expect 0 masses.yaml --quiet
[ -s masses/table.csv ] || fail "a study alone has no table"
tells 4 "missing.yaml" missing.yaml
tells 1 "unknown command 'missing'" missing

# Studies whose runs the command line changes; the results say so, and others are not mixed with them.
expect 0 sweep masses.yaml -o fine --step 0.5ms --quiet
[ "$(cut -d, -f3 fine/table.csv | tail -n 1)" = 100 ] || fail "steps of a study: $(cat fine/table.csv)"
grep -qx '# It was run with --step=0.5ms' fine/study.yaml || fail "the study's copy lacks the option"
expect 1 sweep masses.yaml -o fine --quiet
expect 0 sweep masses.yaml -o asked --accuracy 0.5% --quiet
grep -q 'accuracy_kept' asked/table.csv || fail "no accuracy: $(head -n 1 asked/table.csv)"
expect 0 sweep masses.yaml -o adapted --integrator adaptive --quiet
grep -q ',adaptive,' adapted/table.csv || fail "another method: $(cat adapted/table.csv)"
shows 0 "--accuracy" sweep masses.yaml -o scripts --emit slurm --shards 2 --accuracy 0.5%
edit 's/^keep: .*/compute: modes/' masses.yaml tells 1 "--accuracy is for studies of runs" sweep -o modes --accuracy 1%
expect 0 sweep masses.yaml -o drawn --plot drawn.svg --quiet
grep -q '<svg' drawn.svg || fail "no figure of a study"
yaml best.yaml <<'YAML'
study: The lightest
model: hop.yaml
search: {over: {mass: {from: 1 kg, to: 2 kg}}, minimise: steps, evaluations: 4}
keep: [steps]
YAML
tells 1 "--plot is for studies of single points" sweep best.yaml -o best --plot best.svg
absent best.svg
tells 1 "--plot needs the table of all points" sweep masses.yaml -o drawn --plot drawn.svg --count

# A method that chooses its steps needs none.
sed 's/^solver: .*/solver: {integrator: adaptive}/' hop.yaml >free.yaml
shows 0 '"method":	"adaptive"' run free.yaml --json
sed '/^solver/d' hop.yaml >none.yaml
expect 0 run none.yaml --integrator adaptive --quiet
# ... but the step that it gets is no step of another method.
tells 1 "the solver has no step" run free.yaml --integrator rk4
expect 0 run free.yaml --integrator rk4 --step 1ms --quiet
sed 's/^solver: .*/solver: {accuracy: 1%}/' hop.yaml >promised.yaml
tells 1 "the solver has no step, which only adaptive and adaptive8 do without: give --step" run promised.yaml --integrator verlet
expect 0 run promised.yaml --integrator adaptive8 --quiet
expect 0 run free.yaml --accuracy 1% --quiet
# Where a model says nothing of the solver, strut chooses, and says so.
shows 0 "1 % taken, as the model has no solver" run none.yaml
sed 's/^solver: .*/solver: {integrator: rk4}/' hop.yaml >stepless.yaml
tells 2 "the solver has no step" run stepless.yaml
# What only rests needs none either.
expect 0 equilibria none.yaml --quiet

# Any name may be that of a text parameter, so that a study chooses what is driven.
sed 's/seconds: 50 ms/seconds: 50 ms, hung: "ball"/; s/nodes: \[ball, top\]/nodes: [hung, top]/' hop.yaml >hung.yaml
expect 0 run hop.yaml --quiet --json
cp out one
expect 0 run hung.yaml --quiet --json
[ "$(grep energy one)" = "$(grep energy out)" ] || fail "a node by a text parameter: $(cat out)"
tells 2 "error: --set hung=bal: unknown node 'bal' in parameter 'hung'; did you mean 'ball'" run hung.yaml --set hung=bal
tells 2 "unknown node 'foot' in parameter 'hung'; the names here are 'ball', 'top'" run hung.yaml --set hung=foot
tells 2 "note: the parameter is used here" run hung.yaml --set hung=foot
# So in expressions and keys of positions, and in parts, whose placements give it, and for groups.
sed 's/^run: .*/run: {duration: seconds, measure: {quantities: {far: {of: hung.y, take: final}}}}/' hung.yaml >far.yaml
echo 'initial: {positions: {hung: [0, 10 mm]}}' >>far.yaml
expect 0 run far.yaml --quiet --json
cp out one
sed -i 's/hung\.y/ball.y/; s/{hung:/{ball:/' far.yaml
expect 0 run far.yaml --quiet --json
[ "$(grep -v wall_time one)" = "$(grep -v wall_time out)" ] || fail "by a text parameter: $(cat out)"
yaml arms.yaml <<'YAML'
parameters: {which: "right"}
parts:
  arm:
    parameters: {driven: "left"}
    nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1}, c: {position: [0, 1], mass: 1}}
    members: {left: {kind: spring, nodes: [a, c], stiffness: 9}, right: {kind: spring, nodes: [a, b], stiffness: 9}}
    actuators: {drive: {member: driven, signal: {sine: {amplitude: 0.1, frequency: 1}}}}
place: {one: {part: arm}, two: {part: arm, set: {driven: which}, at: [2, 0]}, three: {part: arm, at: [4, 0], set: {driven: right}}}
YAML
sed "s/fixed: both/fixed: true/" hop.yaml >true.yaml
shows 0 "fixed: both" export true.yaml
shows 0 "one.drive: {member: one.left" export arms.yaml
shows 0 "two.drive: {member: two.right" export arms.yaml
shows 0 "three.drive: {member: three.right" export arms.yaml
tells 2 "unknown member 'rigt' in parameter 'driven'; did you mean 'right'" export arms.yaml --set which=rigt
sed 's/ball: {position: \[0, 0\], mass: mass}/ball: {position: [0, 0], group: hung}/' hung.yaml >group.yaml
tells 2 "unknown group 'ball' in parameter 'hung'" check group.yaml
echo 'groups: {ball: {mass: mass}, spare: {mass: 3 kg}}' >>group.yaml
expect 0 run group.yaml --quiet --json
cp out one
expect 0 run hung.yaml --quiet --json
[ "$(grep energy one)" = "$(grep energy out)" ] || fail "a group by a text parameter: $(cat out)"
sed 's/duration: seconds/duration: mass/' hop.yaml >heavy.yaml
tells 2 "found a mass; line 2 gives 'mass'" check heavy.yaml

# The same range of a path in two ways; the same words with other values elsewhere.
expect 0 path truss.yaml --over load=1..3N --json
cp out one
expect 0 path truss.yaml --over load --from 1 --until 3N --json
same one out
tells 1 "--over expects WHAT or WHAT=FROM..UNTIL" path truss.yaml --over load=1..
tells 1 "give either --over WHAT=FROM..UNTIL, or --from and --until" path truss.yaml --over load=1..3 --until 5
tells 1 "or --over NAME, --from and --until" path hop.yaml --periodic --over mass=1..2 --from 1
tells 1 "--over expects a force, such as " path truss.yaml --over load=1..3kg
expect 0 tradeoff hop.yaml --cpu-time 1s --step-sizes 2 --own-model --quiet --plot trade.svg
grep -q '<svg' trade.svg || fail "no figure of a tradeoff"
