#!/bin/sh
# Friction at rest: contacts that stick and slide along a path, against closed forms and an integration by small steps.
. "$(dirname "$0")/lib.sh"

# ---- a block that a spring pulls over a floor: 10 N of weight, 0.5 and 0.3 ----
yaml block.yaml <<'END'
parameters: {grip: 0.5}
nodes: {hand: {position: [2 m, 0], fixed: both}, block: {position: [0, 0], mass: 1 kg}}
members: {s: {kind: spring, nodes: [hand, block], stiffness: 10 N/m, rest_length: 2 m}}
ground: {stiffness: 1e9, nodes: [block], friction: {law: coulomb, mu_static: grip, mu_kinetic: 0.3}}
gravity: [0, -10]
path: {friction: kept, stages: [{over: hand.x, until: 1 m}, {over: hand.x, until: -1 m}]}
END
expect 0 path block.yaml --json
holds '
  def is($x): . - $x | fabs < 1e-6;
  (.earlier_stages[0] | ([.events[] | .kind] == ["slips"]) and
    (.events[0].nodes.hand[0] | is(2.3)) and ([.points[].nodes.hand[0]] | map(select(. > 2.499)) | first | is(2.5)) and
    (.points[-1] | (.nodes.block[0] | is(0.7)) and (.friction.block | is(-3)))) and
  (.events[0] | (.nodes.block[0] | is(0.7)) and (.nodes.hand[0] | is(2.4))) and
  ([.points[] | select(.nodes.block[0] > 0.69999) | .nodes.hand[0]] | min | is(2.2)) and
  (.points[-1] | (.nodes.block[0] | is(-0.7)) and (.friction.block | is(3)) and (.reactions.hand[0] | is(-3)))'
expect 0 path block.yaml --json --over hand.x --until '1 m' --friction none
holds '(.points[-1].nodes.block[0] - 1 | fabs < 1e-8) and (.points[0] | has("friction") | not)'
# below the limit it holds
edit 's/\[2 m, 0\]/[2.4 m, 0]/; s/rest_length: 2 m/rest_length: 2.4 m/' block.yaml expect 0 path --json --over hand.x --until '0.45 m'
holds '.events == []'

# ---- two that push each other off, with more grip backwards: 100 mm less twice 2 N of the spring a cycle ----
yaml worm.yaml <<'END'
nodes: {rear: {position: [0, 0], mass: 1}, front: {position: [1, 0], mass: 1}}
members: {s: {kind: spring, nodes: [rear, front], stiffness: 100, rest_length: 1}}
ground: {stiffness: 1e5, friction: {law: karnopp, stick_velocity: 1 mm/s, mu_forward: 0.2, mu_backward: 0.6}}
gravity: [0, -10]
actuators: {drive: {member: s, signal: {sine: {amplitude: 0.1 m, frequency: 1 Hz}}}}
path:
  friction: kept
  stages: [{over: drive, until: 100 mm}, {over: drive, until: 0 mm}, {over: drive, until: 100 mm},
           {over: drive, until: 0 mm}]
END
expect 0 path worm.yaml --json
holds '[.earlier_stages[1], .] | map(.points[-1].nodes.rear[0]) | (.[0] - 0.06 | fabs < 1e-6) and (.[1] - 0.12 | fabs < 1e-6)'
expect 0 path worm.yaml -o made --quiet --plot made.svg
grep -q 'rear.friction \[N\]' made/path.csv || fail "friction in the CSV"

# ---- in a pipe: sliding begins where load and weight lie on the cone of friction, there and back ----
yaml pipe.yaml <<'END'
nodes: {a: {position: [0, -1], mass: 1}}
ground: {circle: {centre: [0, 0], radius: 1, inside: yes}, stiffness: 1e4, nodes: [a], friction: {law: coulomb, mu: 0.3}}
loads: {p: {node: a, force: [1, 0]}}
gravity: [0, -10]
path: {friction: kept, stages: [{load: p, until: 10}, {load: p, until: -10}]}
END
expect 0 path pipe.yaml --json
holds '(0.7 / 1.3) as $t | (.earlier_stages[0] | (.events[0].factor - 3 | fabs < 1e-6) and
    (.points[-1].nodes.a | -.[0] / .[1] - $t | fabs < 1e-6)) and
  (.events[0].factor - 10 * ($t - 0.3) / (1 + 0.3 * $t) | fabs < 1e-5) and
  (.points[-1].nodes.a | .[0] / .[1] - $t | fabs < 1e-6)'
# on a straight path past where the load turns: it sticks where its place turns back
yaml turn.yaml <<'END'
nodes: {hand: {position: [2, -2], fixed: both}, block: {position: [0, 0], mass: 1}}
members: {s: {kind: spring, nodes: [hand, block], stiffness: 20, rest_length: 2.828427}}
ground: {stiffness: 1e9, nodes: [block], friction: {law: coulomb, mu: 0.3}}
gravity: [0, -40]
END
expect 0 path turn.yaml --friction kept --over hand.y --until '4 m' --json
# where the spring's pull p, the push n, and their rates are such that p - 0.3 n neither grows nor falls with y
awk 'function part(x, y) { l = sqrt((2 - x)^2 + y^2); f = 20 * (l - 2.828427); return f * (2 - x) / l + 0.3 * (40 - f * y / l) }
  function at(y,  a, b, k, m) { a = -1; b = 0; for (k = 0; k < 60; k++) { m = (a + b) / 2; if (part(m, y) > 0) a = m; else b = m }; return a }
  BEGIN { a = -1; b = 0; g = (sqrt(5) - 1) / 2
    for (k = 0; k < 60; k++) { c = b - g * (b - a); d = a + g * (b - a); if (at(c) < at(d)) b = d; else a = c }
    printf "%.9f\n", at((a + b) / 2) }' >lowest
jq -e --slurpfile x lowest '([.events[] | .kind] == ["slips", "sticks"]) and
  (.events[1].nodes.block[0] - $x[0] | fabs < 1e-6) and (.points[-1].nodes.block[0] - $x[0] | fabs < 1e-6)' \
  "$work/out" >/dev/null || fail "sticks at $(jq -c .events[1].nodes.block "$work/out"), not $(cat lowest)"

# ---- a block that friction alone holds on a slope of 20 degrees: it settles there, and a push downwards lets it go ----
yaml slope.yaml <<'END'
nodes: {block: {position: [0, 0], mass: 1}}
ground: {slope: 20 deg, stiffness: 1e5, damping: 100, friction: {mu: 0.37, stick_velocity: 0.1 mm/s}}
gravity: [0, -9.81]
initial: {settle: {friction: kept}}
loads: {p: {node: block, force: [1, 0]}}
solver: {step: 0.1 ms}
path: {friction: kept}
run: {duration: 1 s}
END
expect 0 path slope.yaml --until -1 --json
holds '(20 * 3.141592653589793 / 180) as $s | (($s | sin) / ($s | cos)) as $t |
  .events[0].kind == "slips" and .events[1].kind == "limit point at a kink" and
  (.events[0].factor - 9.81 * ($t - 0.37) / (1 + 0.37 * $t) | fabs < 1e-6)'

# ---- a rope over a post, turning by a right angle: its tensions differ by exp(0.3 pi/2) at most, there and back ----
yaml rope.yaml <<'END'
nodes: {weight: {position: [0, -1], fixed: x, mass: 1}, post: {position: [0, 0], fixed: both},
        hand: {position: [0.5, 0], fixed: both}}
members: {rope: {kind: cable, nodes: [weight, post, hand], stiffness: 1000, rest_length: 1.48, guide_friction: 0.3}}
gravity: [0, -10]
path:
  friction: kept
  stages: [{over: hand.x, until: 1.5 mm}, {over: hand.x, until: 30 mm}, {over: hand.x, until: 29 mm},
           {over: hand.x, until: -10 mm}]
END
expect 0 path rope.yaml --json
# while it sticks at the post, the part beyond stretches alone, from the 10 N that the weight asks for
holds 'def is($x): . - $x | fabs < 1e-8;
  (0.3 * 3.141592653589793 / 2 | exp) as $more | (0.5 / (1 + 10 / 1480)) as $part |
  (.earlier_stages[0].points[-1] | (.reactions.hand[0] | is(1480 * (0.5015 / $part - 1))) and (.nodes.weight[1] - -1.0 | fabs < 0.1)) and
  (.earlier_stages[0].events == []) and
  (.earlier_stages[1] | ([.events[] | .detail] == ["rope slips over post"]) and (.points[-1].reactions.hand[0] | is(10 * $more))) and
  ((0.53 / (1 + 10 * $more / 1480)) as $now | .earlier_stages[2].points[-1].reactions.hand[0] | is(1480 * (0.529 / $now - 1))) and
  (.points[-1] | (.reactions.hand[0] | is(10 / $more)) and (.forces.rope | is(10)))'

# ---- what cannot be ----
sed 's/friction: {[^}]*}/friction: {law: smooth, mu: 0.3, width: 1 mm\/s}/' pipe.yaml >smooth.yaml
tells 0 "no contact has a static coefficient, and no cable rubs" path smooth.yaml --json
sed -e 's/^nodes:/parameters: {high: 0 m}\nnodes:/' -e 's/centre: \[0, 0\]/centre: [0, high]/' pipe.yaml >moves.yaml
tells 1 "high moves the ground, and friction is kept" path moves.yaml --over high --until '0.1 m'
tells 1 "--friction expects none or kept, not 'some'" path pipe.yaml --friction some
sed 's/friction: kept/friction: stuck/' pipe.yaml >word.yaml
tells 2 "word.yaml:6:18: error:" path word.yaml
