#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut path: the curve, its events, its files, and what it refuses.
. "$(dirname "$0")/lib.sh"

yaml arch.yaml <<'END'
name: Arch
parameters: {side: 0}
nodes: {left: {position: [-1, 0], fixed: both}, right: {position: [1, 0], fixed: both}, top: [0, 0.3]}
members: {a: {kind: bar, nodes: [left, top], stiffness: 1000},
          b: {kind: bar, nodes: [right, top], stiffness: 1000}}
loads: {weight: {node: top, force: [0, -1]}, wind: {node: top, force: [side, 0]}}
END

# The limit load in closed form: 9.94991696 at a height of 0.17071165.
shows 0 "the factor can grow no further here" path arch.yaml --load weight --until 12
out_has "9.949917"
expect 0 path arch.yaml --load weight --until 12 --json -o curve
holds '.load == "weight" and .end == "until" and (.events | length) == 2 and
  .events[0].kind == "limit point" and (.events[0].factor - 9.94991696 | fabs) < 5e-9 and
  (.events[0].nodes.top[1] - 0.17071165 | fabs) < 5e-9 and
  .points[0].factor == 0 and .points[0].stable and .points[-1].factor == 12 and
  ([.points[] | select(.stable | not)] | length) > 10 and
  ([.points[].arc] | . == sort)'
files curve path.csv path.json
same curve/path.json "$work/out"
head -n 1 curve/path.csv | grep -qF 'negative_eigenvalues,event,left.x [m],left.y [m],' || fail "header"
[ "$(grep -c 'limit point' curve/path.csv)" -eq 2 ] || fail "events in the table"
expect 0 path arch.yaml --load weight --until 12 --json
same curve/path.json "$work/out"
shows 0 "5 steps led to the factor" path arch.yaml --load weight --until 12 --steps 5
shows 0 "stable" path arch.yaml --load weight --until -3

# A load that nothing resists, one that is not there, one that does nothing.
tells 1 "unknown load 'wait'; the scene's loads are: weight, wind" path arch.yaml --load wait
tells 1 "the load wind is zero; there is no path to follow" path arch.yaml --load wind
edit 's/\[0, 0.3\]/{position: [0, 0.3], fixed: y}/' arch.yaml tells 1 "acts on nothing that can move" path --load weight
tells 1 "--until expects" path arch.yaml --until "3 N"
tells 1 "a whole number from 1 to" path arch.yaml --steps 0
sed '/right: {pos/s/, fixed: both//; s/left: {position: \[-1, 0\], fixed: both}/left: [-1, 0]/' arch.yaml >loose.yaml
tells 3 "nothing holds the structure" path loose.yaml --load weight
edit '/^loads/,$d; /^parameters/d' arch.yaml tells 1 "no constant load" path
# Stiffnesses that span twelve decades do not make a held chain one that moves as a whole.
yaml chain.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: y}, c: {position: [2, 0], fixed: y},
        d: {position: [3, 0], fixed: y}}
members: {ab: {kind: spring, nodes: [a, b], stiffness: 1}, bc: {kind: spring, nodes: [b, c], stiffness: 1e12},
          cd: {kind: spring, nodes: [c, d], stiffness: 1}}
loads: {tip: {node: d, force: [1, 0]}}
END
shows 0 "2 m      0 m  stable" path chain.yaml

# Over something else than a load: closed forms of the arch, held at y by 2 k y (l0 / l - 1).
yaml over.yaml <<'END'
name: Arch
parameters: {k: 1000 N/m, span: 1 m, load: 1 N}
nodes: {left: {position: [-span, 0], fixed: both}, right: {position: [span, 0], fixed: both},
        top: {position: [0, 0.3], mass: 1, fixed: x}, low: {position: [0, -1], fixed: both}}
members: {a: {kind: bar, nodes: [left, top], stiffness: k, rest_length: 1.0440306508910551},
          b: {kind: bar, nodes: [right, top], stiffness: k, rest_length: 1.0440306508910551},
          tie: {kind: spring, nodes: [top, low], stiffness: 1 mN/m, rest_length: 1.3}}
signals: {wave: {sine: {amplitude: 1 mm, frequency: 1 Hz}}}
actuators: {pull: {member: tie, signal: wave}}
loads: {weight: {node: top, force: [0, -load]}}
configurations: {flat: {top: [0, 0.3]}, inverted: {top: [0, -0.3]}}
END
# The stiffness at which it gives way under 1 N: 100.50336 N/m, and no further.
expect 0 path over.yaml --over k --until "60 N/m" --steps 60 --json -o over
holds '.over == "k" and .unit == "N/m" and .load == null and .points[0].value == 1000 and
  .events[0].kind == "limit point" and (.events[0].value - 100.50336 | fabs) < 2e-2 and
  .events[0].stable_before and (.events[0].stable_after | not) and .events[0].negative_after == 1 and
  ([.points[] | .forces.a] | max) < 0 and
  ([.points[] | .reactions.left[1] + .reactions.right[1] - 1 + .reactions.low[1] | fabs] | max) < 1e-9'
head -n 1 over/path.csv | grep -qF 'value [N/m],arc,negative_eigenvalues,event,left.x [m]' || fail "header"
head -n 1 over/path.csv | grep -qF 'a.force [N],b.force [N],tie.force [N],left.reaction_x [N]' || fail "forces"
shows 0 "k can fall no further here; top moves most, unstable from here" path over.yaml --over k --until "60 N/m" --steps 60
out_has "left support y"
# Through both limit points, which are none where the apex is held.
expect 0 path over.yaml --over top.y --until "-0.5 m" --json
holds '.unit == "m" and (.events | length) == 0 and ([.points[] | .stable] | all) and
  .points[-1].value == -0.5 and ([.points[] | .reactions.top[1]] | max > 10 and min < -8)'
shows 0 "moves most  top" path over.yaml --over top.y --until "-0.5 m"
out_has "  displacement  "
expect 0 path over.yaml --over left.x --from "1 mm" --until "5 mm" --json
holds '.points[0].value == 1e-3 and (.points[-1].nodes.left[0] - -0.995 | fabs) < 1e-12'
expect 0 path over.yaml --over pull --until "-0.2 m" --json
holds '.over == "pull" and .points[-1].value == -0.2 and .points[-1].forces.tie > 1.9e-4'
shows 0 "1.02 m" path over.yaml --over span --until "1.02 m"
"$strut" path - --over k --until "900 N/m" <over.yaml >"$work/out" || fail "a model from stdin"
out_has "900 N/m"
# From another equilibrium: the inverted arch carries the same load upside down without a limit point.
expect 0 path over.yaml --at inverted --until 12 --json
holds '(.points[0].nodes.top[1] - -0.3 | fabs) < 1e-3 and (.events | length) == 0'
expect 0 path over.yaml --at flat --from 1 --until 12 --json
holds '.points[0].factor == 1 and .points[0].force == 1 and .points[0].nodes.top[1] < 0.2999 and
  .events[0].kind == "limit point"'
tells 1 "unknown configuration 'upright'" path over.yaml --at upright
tells 3 "'drawn' is no equilibrium where the path starts" path over.yaml --at drawn --from 1 --until 2

# Where Zeeman's machine folds: first and second derivative zero on the circle of a rigid bar, to 30 digits.
expect 0 path "$models/gallery/zeeman.yaml" --set "rod=1e11 N/m" --over control_y --until "-0.1 m" --json
holds '[.events[] | .kind] == ["limit point", "limit point"] and
  (.events[0].value - -0.144560047338849 | fabs) < 2e-11 and
  (.events[1].value - -0.343357043537997 | fabs) < 2e-11'
# The crawler's states give way where its drive is long enough.
expect 0 path "$crawler" --over drive --at I --until "8 mm" --json
holds '([.events[] | .kind] | index("lift-off")) as $lift |
  .events[$lift + 1].kind == "limit point at a kink" and .end == "invalid" and
  (.remark | contains("rest length of m8 would be negative")) and
  ([.points[] | .contacts.n1 + .contacts.n2 + .contacts.n4 | . - 1.3734 | fabs] | max) < 1e-9'

# EA is over the present rest length L: EA (x/L - 1) = k (1 - x), so that x = 2 L / (1 + L) for EA = k.
yaml reel.yaml <<END
parameters: {L: 1 m}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1, fixed: y}, c: {position: [2, 0], fixed: both}}
members: {rope: {kind: cable, nodes: [a, b], axial_stiffness: 100 N, rest_length: L},
          back: {kind: spring, nodes: [b, c], stiffness: 100, rest_length: 1}}
actuators: {reel: {member: rope, signal: {constant: 0}}}
END
for over in "--over reel --until -0.5" "--over L --until 0.5"; do
  finds '(.points[-1].nodes.b[0] - 2 / 3 | fabs) < 1e-12' path reel.yaml $over
done
expect 0 path reel.yaml --over reel --until "-1.5 m" --json
holds '.end == "invalid" and (.remark | contains("rest length of rope would reach zero"))'

# A rope of four cables begins straight or slack, where it has no stiffness: no bifurcations, and string polygons.
yaml rope.yaml <<'END'
parameters: {rest: 1, drawn: 0}
nodes: {a: {position: [0, 0], fixed: both}, b: [1, 0], c: [2, drawn], d: [3, 0], e: {position: [4, 0], fixed: both}}
groups: {rope: {kind: cable, stiffness: 100, rest_length: rest}}
members: {ab: {group: rope, nodes: [a, b]}, bc: {group: rope, nodes: [b, c]}, cd: {group: rope, nodes: [c, d]}, de: {group: rope, nodes: [d, e]}}
actuators: {reel: {member: ab, signal: {constant: 0}}}
loads: {pull: {node: c, force: [0, -1]}}
END
for rest in 1 1.05 1.3; do
  finds "def load: (.[1] * .[1] + 4 | sqrt) as \$l | -100 * (\$l - 2 * $rest) * .[1] / \$l;
    ([.events[].kind] == [\"mechanism\"]) and ([.points[].stable] | all) and (.points[-1].nodes.c | load - 1 | fabs) < 1e-9" \
    path rope.yaml --set rest=$rest
done
# Reeled in from slack it tightens at 4 m, reeled out it goes slack: that nothing changes on a long part is said.
sed '/^loads/d' rope.yaml >reel.yaml
finds '.end == "until" and ([.points[-1].forces[] - 5 | fabs] | max) < 1e-9 and ([.points[].stable] | all) and
  ([.events[].kind] | unique) == ["mechanism", "taut"]' path reel.yaml --set rest=1.1 --set drawn=0.2 --over reel --until "-0.6 m"
finds '.end == "until" and [.events[].kind] == ["slack", "mechanism"] and
  (.remark | test("no member carries a force from reel 0.4 m to reel 1 m"))' path reel.yaml --set rest=0.9 --over reel --until "1 m"
# A singular stiffness without effect is a bifurcation, a mechanism none; of strings that slacken at once some keep it firm.
finds '[.events[].kind] == ["bifurcation"]' path "$models/basics/von-mises-truss.yaml" --over height --until "0.39 m"
finds '.end == "until" and ([.events[].kind] - ["slack"] == [])' path "$models/gallery/x-joint.yaml" --over length --until "60 mm"
finds '([.events[].kind] - ["slack", "mechanism"] == [])' path "$models/gallery/two-x-manipulator.yaml" --over length --until "30 mm"
finds '.end == "until" and (.events | length) == 5 and ([.points[-1].forces[]] | max > 13 and min < -9)' \
  path "$models/gallery/six-boxes.yaml" --over ratio --until "210 %"
finds '.end == "until" and .points[-1].value == 372.5' path "$models/gallery/closed-cable-net.yaml" --over hoop --until "372.5 m"
# s^2 = 1 - t^2 is a circle: the path comes back to where it began.
yaml circle.yaml <<'END'
parameters: {t: 0}
nodes: {o: {position: [0, 0], fixed: both}, p: {position: [3, 0], mass: 1, fixed: y}}
members: {a: {kind: spring, nodes: [o, p], rest_length: 2, law: {kind: polynomial, coefficients: [0, 1 N/m^2]}}}
loads: {f: {node: p, force: [1 - t * t, 0]}}
END
finds '.end == "closed" and (.remark | test("^closed path")) and .points[-1].nodes == .points[0].nodes and
  ([.events[].value | fabs - 1 | fabs] | max) < 1e-9 and (.events | length) == 2' path circle.yaml --over t --until 2

# A force that is rounding beside the others of the path is 0.
expect 0 path "$models/gallery/bumping-beams.yaml"
out_has_not "e-2"

# It ends where the scene means nothing any more, and says why.
expect 0 path over.yaml --set load=0 --over k --until "-10 N/m" --json
holds '.end == "invalid" and (.points[-1].value | fabs) < 1e-3 and
  (.remark | contains("over.yaml:") and contains("stiffness"))'
# Branches: two links of length l, each turned by t, stand under the load 2 stiffness t/(l sin t).
column="$models/parts/link-column.yaml"
expect 0 path "$column" --set links=2 --until 20 --branches 1 --json
holds '(.branches | length) == 2 and
  ([.branches[] | .end == "until" and .from_branch == 0 and (.events | length) == 0] | all) and
  [.branches[].twin] == [2, 1] and
  ([.branches[].points[1:][] | .nodes."link.0.head" as [$x, $y] |
    (($x * $x + $y * $y) | sqrt) as $l | ($y / $l | fabs) as $sine |
    (if $x > 0 then ($sine | asin) else 3.141592653589793 - ($sine | asin) end) as $t |
    .stable and (.factor * $l * $sine / (2 * $t) - 1 | fabs) < 1e-9] | all)'
# Von Mises' truss, steep: off the middle each bar with its force leaves no residual, and both halves of
# the branch meet on the other side.
expect 0 path "$models/gallery/von-mises.yaml" --set load=1 --set span=0.15 --until 1 --branches 2 --json
holds 'def pull($dx; $dy): (($dx * $dx + $dy * $dy) | sqrt) as $l |
    ((0.2725 | sqrt) / $l - 1) as $s | [$s * $dx, $s * $dy];
  (.branches | length) == 6 and
  ([.branches[0:2][] | .end == "joined" and (.points[0].factor + .points[-1].factor | fabs) < 1e-9] | all)
  and ([.branches[].points[] | .nodes.apex as $p | .factor as $f |
    pull($p[0] + 0.15; $p[1]) as $a | pull($p[0] - 0.15; $p[1]) as $b |
    ($a[0] + $b[0] | fabs) < 1e-7 and ($a[1] + $b[1] - $f | fabs) < 1e-7] | all)'
# Branches of branches; a table, a CSV with a column for them, a picture.
expect 0 path "$column" --set links=4 --until 40 --branches 2 -o branches --plot branches.svg
head -1 branches/path.csv | grep -q '^branch,factor,' || fail "the column for branches"
[ "$(cut -d, -f1 branches/path.csv | sort -un | tail -1)" = 26 ] || fail "26 branches"
out_has "twin of branch"
expect 0 path "$column" --set links=4 --until 40 --plot alone.svg
[ "$(grep -c '<path' branches.svg)" -gt "$(($(grep -c '<path' alone.svg) + 19))" ] || fail "branches in the picture"
tells 1 "--branches expects a whole number from 1 to 10" path "$column" --branches 0

# What cannot be followed.
tells 1 "did you mean 'k'?" path over.yaml --over kk --until 3
tells 1 "did you mean 'top.y'?" path over.yaml --over tip.y --until 3
tells 1 "'weight' is a load; use --load weight" path over.yaml --over weight --until 3
tells 1 "missing --until VALUE" path over.yaml --over k
tells 1 "--until expects a stiffness" path over.yaml --over k --until "3 m"
tells 1 "--from and --until are equal" path over.yaml --over k --until "1000 N/m"
tells 1 "give either --load or --over, not both" path over.yaml --over k --load weight --until 3
tells 1 "the rest length of tie would be negative" path over.yaml --over pull --from "-2 m" --until 0
sed 's/load: 1 N/load: 1 N, speed: 3, shape: "flat"/; s/frequency: 1 Hz/frequency: speed/
  $a initial: {configuration: shape}' over.yaml >idle.yaml
tells 1 "speed changes nothing that matters at rest" path idle.yaml --over speed --until 5
tells 1 "parameter 'shape' is a text, expected a number" path idle.yaml --over shape --until 5
sed -i 's/speed: 3/speed: 3, unused: 4/' idle.yaml
tells 2 "nothing in the scene uses parameter 'unused'" path idle.yaml --over unused --until 5
