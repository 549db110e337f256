#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Paths in stages: what each leaves to the next, by the equilibrium of forces and by closed forms.
. "$(dirname "$0")/lib.sh"

# A truss under two loads, pressed down, driven, and let go again: after each stage the forces of its
# two springs by Hooke's law balance all loads and the reactions.
cp "$here/../language/good/stages.yaml" truss.yaml
expect 0 path truss.yaml --json
holds 'def pull($dx; $dy; $rest): (($dx * $dx + $dy * $dy) | sqrt) as $l |
    [$dx * (1 - $rest / $l), $dy * (1 - $rest / $l)];
  def residual($p; $drive; $x; $y): $p.nodes.apex as [$u, $v] | (1.25 | sqrt) as $rest |
    pull($u + 1; $v; $rest + $drive) as $a | pull($u - 1; $v; $rest) as $b | ($p.reactions.apex // [0, 0]) as $r |
    ([($x + $r[0] - $a[0] - $b[0]), ($y + $r[1] - $a[1] - $b[1])] | map(fabs) | max);
  [.earlier_stages[], .] | length == 6 and
  [residual(.[0].points[-1]; 0; 0; -0.02), residual(.[1].points[-1]; 0; 0.05; -0.02),
   residual(.[2].points[-1]; 0; 0.05; -0.02), residual(.[3].points[-1]; 0.01; 0.05; -0.02),
   residual(.[4].points[-1]; 0.01; 0.05; -0.02), residual(.[5].points[-1]; 0.01; 0.05; -0.02)] as $left |
  ($left | max) < 1e-12 and
  (.[2].points[-1].nodes.apex[1] - .[2].points[0].nodes.apex[1] + 0.2 | fabs) < 1e-14 and
  (.[4].points[-1].nodes.apex[0] == .[2].points[0].nodes.apex[0]) and
  (.[5].points[-1].reactions.apex | map(fabs) | max) < 1e-15 and
  [.[] | .over] == [null, null, "apex.y", "drive", null, null] and
  [.[] | .load] == ["push", "side", null, null, "reaction of apex.y", "reaction of apex.x"]'

# The order of loads is no matter where the path does not fold; one stage is the path of its load.
sed '/^path:/,$d' truss.yaml >plain.yaml
{ cat plain.yaml; echo 'path: {stages: [{load: push}, {load: side}]}'; } >one.yaml
{ cat plain.yaml; echo 'path: {stages: [{load: side}, {load: push}]}'; } >two.yaml
expect 0 path one.yaml --json
end=$(jq -c '.points[-1].nodes.apex' "$work/out")
gives '.points[-1].nodes.apex' "$end" 1e-13 path two.yaml
{ sed 's/, side: .*}}$/}/' plain.yaml; echo 'path: {stages: [{load: push}]}'; } >single.yaml
expect 0 path single.yaml --json
jq -S 'del(.earlier_stages)' "$work/out" >staged.json
expect 0 path single.yaml --load push --json
jq -S . "$work/out" | cmp -s - staged.json || fail "one stage is a path of its own"

# Pressed through and let go, it rests upside down; pressed less far, it comes back.
for end in "-1.2 -0.5" "-0.15 0.5"; do
  set -- $end
  { sed '/^loads:/d; /^actuators:/d' plain.yaml
    echo "path: {stages: [{over: apex.y, until: $1 m}, {release: apex.y}]}"; } >through.yaml
  finds "(.points[-1].nodes.apex[1] - $2 | fabs) < 1e-12 and .end == \"until\"" path through.yaml
done
# Back where it was held: the value of a displacement goes on from where a stage left it.
{ cat plain.yaml; echo 'path: {stages: [{over: apex.y, until: -100 mm}, {load: side}, {over: apex.y, until: 0}]}'; } >back.yaml
expect 0 path back.yaml --json
holds '.points[0].value == -0.1 and (.points[-1].nodes.apex[1] - .earlier_stages[0].points[0].nodes.apex[1] | fabs) < 1e-14'
# A load beyond the truss's snaps; the stage ends where the apex has moved so far.
{ cat plain.yaml; echo 'path: {stages: [{load: push, until: 20, stop: {apex.y: -0.6 m}}, {load: side}]}'; } >stop.yaml
finds '.earlier_stages[0].end == "stop" and (.points[0].nodes.apex[1] + 0.1 | fabs) < 1e-12' path stop.yaml

# What breaks in an earlier stage, or on a branch alone, is warned of.
{ sed 's/  a: {/  a: {breaks_at: 0.1 N, /' plain.yaml
  echo 'path: {stages: [{over: apex.y, until: 0.3 m}, {release: apex.y}]}'; } >broken.yaml
tells 0 "on 'a' carries more than it can" path broken.yaml
edit 's/until: 0.3 m/until: 0.1 m/' broken.yaml expect 0 path
! grep -q 'carries more' "$work/err" || fail "a warning without a reason"

# Files, the table, branches of the last stage, and what the command says itself.
expect 0 path truss.yaml -o stages --plot stages.svg
head -1 stages/path.csv | grep -q '^stage,over,unit,value,arc,' || fail "columns of stages"
[ "$(cut -d, -f1 stages/path.csv | sort -un | tail -1)" = 6 ] || fail "six stages"
out_has "stages before"
finds '.load == "push" and (has("earlier_stages") | not)' path truss.yaml --load push
# A stage that leads nowhere ends the path, which says so.
{ cat plain.yaml; echo 'path: {stages: [{load: push, until: 1, steps: 2}, {load: side}]}'; } >short.yaml
shows 0 "stage 1 of 2 is the last: the next would not begin where this was to end" path short.yaml

# A wire in a sheath that is pushed bends a beam of two links: it turns by the angle t where the length that the
# wire loses is that the beam gains, 2 (1/cos t - 1), and balances the hinge and the load on it.
yaml sheath.yaml <<'YAML'
nodes: {far: {position: [-2, 0], fixed: y}, base: {position: [0, 0], fixed: both}, middle: {position: [1, 0]},
        end: {position: [2, 0], fixed: both}}
members: {wire: {kind: spring, nodes: [far, base, middle, end], stiffness: 1e6}}
hinges: {h: {nodes: [base, middle, end], stiffness: 2 N m/rad}}
loads: {aside: {node: middle, force: [0, -1e-3]}, push: {node: far, force: [100, 0]}}
path: {stages: [{load: aside}, {load: push, stop: {far.x: 100 mm}}]}
YAML
expect 0 path sheath.yaml --json # straight, the middle has no stiffness along the beam, and needs none
holds '(.points[-1].nodes.middle[1] | -.) as $y | ($y | atan) as $t | ((1 + $y * $y) | sqrt) as $l |
  (2 * ($l - 1) - 0.1 | fabs) < 1e-4 and
  (.points[-1].forces.wire + (8 * $t / ($l * $l) - 1e-3) / (2 * $y / $l) | fabs) < 1e-9'
# Loads that grow together: what their forces are in sum, at each end, and back to none.
cp "$here/../language/good/stages-together.yaml" together.yaml
expect 0 path together.yaml --json
holds 'def pull($o; $k): [$o[0] - .[0], $o[1] - .[1]] as $d | ($d[0] * $d[0] + $d[1] * $d[1] | sqrt) as $l |
    [$d[] * $k * (1 - 1 / $l)];
  def left($x; $y): .nodes.b | pull([0, 0]; 10) as $s | pull([1, -1]; 20) as $t |
    [$s[0] + $t[0] + $x, $s[1] + $t[1] + $y] | map(fabs) | max;
  [(.earlier_stages[0].points[-1] | left(0.5; 1)), (.earlier_stages[1].points[-1] | left(1; 1)),
   (.points[-1] | left(0.5; 0))] | max < 1e-13'

tells 1 "unknown load 'p,qq'" path together.yaml --load p,qq
finds '.load == "q,p"' path together.yaml --load q,p

# A study follows the stages of its model, unless it says what to follow.
yaml varied.yaml <<'END'
parameters: {k: 10 N/m}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1 m, 0], fixed: y, mass: 1}}
members: {s: {kind: spring, nodes: [a, b], stiffness: k}}
loads: {p: {node: b, force: [1 N, 0]}}
path: {stages: [{load: p, until: 2}, {over: b.x, until: 50 mm}]}
END
yaml study.yaml <<'END'
study: Stages
model: varied.yaml
compute: path
axes: [{k: [10 N/m, 20 N/m]}]
keep: [last_factor, end]
END
expect 0 sweep study.yaml -o staged --quiet
grep -q 'last_factor \[m\]' staged/table.csv || fail "unit of the last stage: $(head -1 staged/table.csv)"
[ "$(grep -c ',0.05,until' staged/table.csv)" = 2 ] || fail "a study of stages: $(cat staged/table.csv)"
echo 'path: {load: p, until: 3}' >>study.yaml
expect 0 sweep study.yaml -o told --quiet
[ "$(grep -c ',3,until' told/table.csv)" = 2 ] || fail "a study that says what to follow: $(cat told/table.csv)"
