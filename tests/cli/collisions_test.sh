#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Collisions of nodes and members through the program, against closed forms and conserved sums.
. "$(dirname "$0")/lib.sh"

# A ball against a fixed one with a damper that never pulls: with beta = c / 2m and omega it leaves at
# exp(-beta t) of its speed, omega t = pi - atan2(2 beta omega, omega^2 - beta^2).
ball() {
  yaml <<END
nodes: {wall: {position: [0, 0], fixed: both}, ball: {position: [0.5, 0], mass: 1}}
collisions: {hit: {nodes: [wall, ball], thickness: 0.4, stiffness: 10000, damping: $1}}
initial: {velocities: {ball: [-1, 0]}}
solver: {step: $2}
run: {duration: 0.3, measure: {quantities: {speed: {of: ball.vx, take: final}, force: {of: hit.force, take: max},
        pull: {of: hit.force, take: min}, gap: {of: collision(hit).gap, take: final}}}}
END
}
for damping in 0 10 40 100; do
  exit="($damping / 2) as \$b | (10000 - \$b * \$b | sqrt) as \$w
    | (3.141592653589793 - ([2 * \$b * \$w, \$w * \$w - \$b * \$b] | atan2(.[0]; .[1]))) / \$w
    | (-\$b * . | exp)"
  ball $damping "0.2 ms" >ball.yaml
  by rk4-events ball.yaml .measured.speed.value "$exit" 1e-4 .measured.pull.value 0 0 '.energy.residual / .energy.exchanged' 0 1e-4
  [ $damping -ne 0 ] || near .measured.force.value 100 0.05
  ball $damping "20 us" >ball.yaml
  by "rk4 verlet euler verlet-events euler-events adaptive midpoint" ball.yaml \
    .measured.speed.value "$exit" 0.02 .measured.pull.value 0 0
done

# Newton's cradle: of three equal discs with gaps between them only the last one goes on.
yaml cradle.yaml <<'END'
nodes: {a: {position: [0, 0], mass: 0.2}, b: {position: [1, 0], mass: 0.2}, c: {position: [1.5, 0], mass: 0.2}}
collisions: {ab: {nodes: [a, b], thickness: 0.4, stiffness: 1e5}, bc: {nodes: [b, c], thickness: 0.4, stiffness: 1e5}}
initial: {velocities: {a: [2, 0]}}
solver: {integrator: rk4-events, step: 50 us}
run: {duration: 1, measure: {quantities: {a: {of: a.vx, take: final}, b: {of: b.vx, take: final}, c: {of: c.vx, take: final}}}}
END
gives '.measured | [.a, .b, .c | .value]' '[0, 0, 2]' 1e-6 run cradle.yaml

# Two free rods: momentum and angular momentum about the origin are kept, and energy without damping.
yaml rods.yaml <<'END'
mass_model: lumped
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 2}, c: {position: [0.3, 0.5], mass: 0.5},
        d: {position: [0.6, 1.4], mass: 1.5}}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 1e5}, cd: {kind: bar, nodes: [c, d], stiffness: 1e5}}
collisions: {hit: {members: [ab, cd], thickness: 40 mm, stiffness: 1e5}}
initial: {velocities: {c: [0.2, -3], d: [0.2, -3], a: [0, 0.5]}}
solver: {integrator: rk4-events, step: 0.1 ms}
run: {duration: 0.4, measure: {quantities: {hit: {of: hit.force, take: max},
  px: {of: "a.vx + 2*b.vx + 0.5*c.vx + 1.5*d.vx", take: range}, py: {of: "a.vy + 2*b.vy + 0.5*c.vy + 1.5*d.vy", take: range},
  spin: {of: "a.x*a.vy - a.y*a.vx + 2*(b.x*b.vy - b.y*b.vx) + 0.5*(c.x*c.vy - c.y*c.vx) + 1.5*(d.x*d.vy - d.y*d.vx)", take: range}}}}
END
gives '.measured | [.px, .py | .value]' '[0, 0]' 1e-10 run rods.yaml
holds '.measured.hit.value > 10'
near .measured.spin.value 0 1e-9 '.energy.residual / .energy.exchanged' 0 1e-5

# A ball on a hinged bar: angular momentum about the hinge, and a closed balance with damping.
yaml hinged.yaml <<'END'
nodes: {hinge: {position: [0, 0], fixed: both}, tip: {position: [1, 0], mass: 1},
        ball: {position: [0.6, 0.3], mass: 0.5}}
members: {bar: {kind: bar, nodes: [hinge, tip], stiffness: 1e5, mass: 0.6}}
collisions: {hit: {node: ball, member: bar, thickness: 50 mm, stiffness: 1e4, damping: 5}}
initial: {velocities: {ball: [0, -2]}}
solver: {integrator: rk4-events, step: 0.1 ms}
run: {duration: 0.5, measure: {quantities: {turned: {of: tip.vy, take: final}, hit: {of: hit.force, take: max},
        spin: {of: "1.2*(tip.x*tip.vy - tip.y*tip.vx) + 0.5*(ball.x*ball.vy - ball.y*ball.vx)", take: range}}}}
END
gives .measured.spin.value 0 1e-9 run hinged.yaml
holds '.measured.hit.value > 10 and .measured.turned.value < -0.3 and .energy.dissipated_members > 0.01'
near '.energy.residual / .energy.exchanged' 0 1e-4

# The search finds the bar at rest on a peg, k d r cos = W, and hanging down.
yaml peg.yaml <<'END'
nodes: {hinge: {position: [0, 0], fixed: both}, tip: {position: [1, 0.1], mass: 1}, peg: {position: [0.5, -0.1], fixed: both}}
members: {bar: {kind: bar, nodes: [hinge, tip], stiffness: 1e6}}
collisions: {rest: {node: peg, member: bar, thickness: 50 mm, stiffness: 1e5}}
gravity: [0, -10]
END
gives '[.equilibria[] | select(.label == "stable")] | length' 2 0 equilibria peg.yaml
# on the peg: the moment of the weight is that of the force of 20 N at half the length
near '[.equilibria[] | select(.label == "stable")] | map(.nodes.tip[1]) | min' '-(1.01 | sqrt)' 1e-4 \
  '[.equilibria[] | select(.label == "stable")] | map(.nodes.tip[0]) | max' \
  '(0.2 | atan) as $down | (0.05 / (0.26 | sqrt) | asin) as $up | (1.01 | sqrt) * ($down - $up | cos)' 1e-4

# By path, a growing load presses a lever onto the peg: it touches there.
sed 's/^gravity.*/loads: {down: {node: tip, force: [0, -10 N]}}/; s/^nodes: {/&roof: {position: [1, 2], fixed: both}, /
  s/^members: {/&up: {kind: spring, nodes: [tip, roof], stiffness: 20, rest_length_ratio: 1}, /' peg.yaml >lever.yaml
finds '[.events[].detail] | map(select(startswith("rest touches"))) | length == 1' path lever.yaml --load down --until 2

# Overlap at the start, and steps that may pass over the thickness.
edit 's/\[0.6, 0.3\]/[0.6, 0.02]/' hinged.yaml tells 0 "collision 'hit' starts with an overlap of 0.03 m" check
sed 's/\[0, -2\]/[0, -800]/; s/duration: 0.5/duration: 2 ms/' hinged.yaml >fast.yaml
tells 0 "the sides of collision 'hit' moved at up to 800 m/s" run fast.yaml --quiet --integrator rk4
# methods with events see the contact within a step
finds '.events > 0' run fast.yaml

edit 's/stiffness: 1e5}/stiffness: 1e3}/' rods.yaml tells 0 "the sides of collision 'hit' were pressed into each other by more than half" run --quiet

# Equilibria on both sides of a rod. The node may go round an end of it, and the pass lies there.
yaml over.yaml <<'YAML'
gravity: [0, -9.81]
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both}, c: {position: [0.5, 0.5], mass: 1}, top: {position: [0.5, 1.5], fixed: both}}
members: {beam: {kind: bar, nodes: [a, b], stiffness: 1e4}, s: {kind: spring, nodes: [top, c], stiffness: 10, rest_length: 1}}
collisions: {k: {node: c, member: beam, thickness: 0.1, stiffness: 1e3}}
YAML
expect 0 equilibria over.yaml --json
holds '[.equilibria[] | .overlap, .through] | all(. == null)' '.barriers | length == 2'
holds '.barriers[0].saddle as $pass | .equilibria[] | select(.name == $pass) | .nodes.c[0] | . < 0 or . > 1'
# Held in x it cannot: the far side is out of reach, and no barrier is listed.
sed 's/mass: 1}/mass: 1, fixed: x}/' over.yaml >held.yaml
expect 0 equilibria held.yaml --json
holds '.barriers | length == 0' '[.equilibria[] | select(.nodes.c[1] < 0)] | length == 1 and .[0].through == "k"'
holds '[.equilibria[] | select(.nodes.c[1] > 0) | .through] | all(. == null)'
shows 0 "reached only through 'k'" equilibria held.yaml --plot held.svg
# Two rods that cross lie in each other, though nothing pushes them apart; no barrier leads there, nor to the
# other side by a floppy shape that both sides have.
yaml rods.yaml <<'YAML'
nodes: {a: {position: [-1, 0], fixed: both}, b: {position: [1, 0], fixed: both},
        p: {position: [-0.5, 0.5], mass: 1}, q: {position: [0.5, 0.5], mass: 1},
        u: {position: [-0.6, 0.2], fixed: both}, v: {position: [0.6, 0.2], fixed: both}}
members: {wall: {kind: bar, nodes: [a, b], stiffness: 1e4}, rod: {kind: bar, nodes: [p, q], stiffness: 1e3},
          s1: {kind: spring, nodes: [u, p], stiffness: 10, rest_length: 0.4},
          s2: {kind: spring, nodes: [v, q], stiffness: 10, rest_length: 0.4}}
collisions: {k: {members: [wall, rod], thickness: 0.05, stiffness: 1e3}}
YAML
expect 0 equilibria rods.yaml --json
holds '[.equilibria[] | select((.nodes.p[1] < 0) != (.nodes.q[1] < 0) and .label == "stable")] | length > 0 and all(.overlap == "k")'
holds '[.equilibria[] | select(.nodes.p[1] < 0 and .nodes.q[1] < 0 and .label == "stable")] | length > 0 and all(.through == "k")'
holds '[.equilibria[] | select(.overlap or .through) | .name] as $out | [.barriers[] | .from, .to] | length > 0 and all(. as $n | $out | index($n) == null)'

# Collisions of all members, or of groups: every two that are apart as drawn, the same bits as one by one.
yaml many.yaml <<'YAML'
groups: {rod: {kind: bar, stiffness: 1000, damping: 1}, tie: {kind: spring, stiffness: 10}}
nodes: {a: {position: [0, 0], mass: 1}, b: {position: [1, 0], mass: 1}, c: {position: [0, 1], mass: 1},
        d: {position: [1, 1], mass: 1}, e: {position: [0.5, 2], mass: 1}, f: {position: [0.5, 1.5], mass: 1}}
members: {low: {group: rod, nodes: [a, b]}, high: {group: rod, nodes: [c, d]}, up: {group: [rod], nodes: [e, f]},
          cross: {group: tie, nodes: [a, d]}, side: {group: tie, nodes: [b, d]}}
COLLISIONS
initial: {velocities: {e: [0.1, -2], f: [0, -2], a: [0, 1], b: [0, 1]}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 1 s, measure: {quantities: {y: {of: e.y, take: final}}}}
YAML
pairs() { # collisions, names that are expected
  sed "s/^COLLISIONS/$1/" many.yaml >some.yaml
  expect 0 check some.yaml --json
  jq -r '.collisions | keys | join(" ")' out >names
  [ "$(cat names)" = "$2" ] || fail "$1: $(cat names), expected $2"
}
pairs 'collisions: {hit: {between: all, thickness: 0.1, stiffness: 500}}' \
  'hit_high_up hit_low_high hit_low_up hit_up_cross hit_up_side'
expect 0 run some.yaml --json
y=$(jq .measured.y.value out)
holds '.measured.y.value > 0.5'
pairs 'collisions: {hit: {between: rod, thickness: 0.1, stiffness: 500}}' 'hit_high_up hit_low_high hit_low_up'
pairs 'collisions: {hit: {between: [rod, tie], thickness: 0.1, stiffness: 500}}' 'hit_up_cross hit_up_side'
one='thickness: 0.1, stiffness: 500'
pairs "collisions: {one: {members: [low, high], $one}, two: {members: [low, up], $one}, three: {members: [high, up], $one}, four: {members: [up, cross], $one}, five: {members: [up, side], $one}}" 'five four one three two'
gives .measured.y.value "$y" 1e-12 run some.yaml
pairs 'collisions: all' 'all_high_up all_low_high all_low_up all_up_cross all_up_side'
gives .collisions.all_low_high.thickness 0.02 1e-12 check some.yaml
near .collisions.all_low_high.stiffness 10000 1e-12
sed 's/^COLLISIONS/collisions: {hit: {between: ropes, thickness: 0.1, stiffness: 5}}/' many.yaml >some.yaml
tells 2 "no straight member is of group 'ropes', which collision 'hit' names" check some.yaml
edit 's/^COLLISIONS/collisions: some/' many.yaml expect 2 check

# Two rods meet end to end, by two elements that switch at one moment: neither is switched back for the other.
yaml ends.yaml <<'YAML'
gravity: [0, 0]
nodes: {a: {position: [0, 0], mass: 10 g}, b: {position: [0.1, 0.013], mass: 10 g},
        c: {position: [0.13, 0.02], mass: 10 g}, d: {position: [0.23, 0.011], mass: 10 g}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 1000}, n: {kind: spring, nodes: [c, d], stiffness: 1000}}
collisions: {hit: {members: [m, n], thickness: 0.0115, stiffness: 1e4}}
initial: {velocities: {c: [-0.3, -0.05], d: [-0.31, -0.02]}}
solver: {integrator: adaptive, step: 0.1 ms}
run: {duration: 0.3 s, measure: {quantities: {least: {of: least_gap, take: min}, gap: {of: hit.gap, take: min}}}}
YAML
for method in adaptive rk4-events; do
  gives .energy.dissipated_members 0 1e-15 run ends.yaml --integrator $method
  near '.energy.residual / .energy.exchanged' 0 1e-5
  near '[.events, .measured.least.value]' "[8, $(jq .measured.gap.value out)]" 0
done

# "Without collision" as a condition of a search: the best arm stays clear of the post, which it would cross otherwise.
yaml arm.yaml <<'YAML'
gravity: [0, 0]
parameters: {bend_1: 0, bend_2: 0, bend_3: 0}
nodes: {wall: {position: [-0.1, 0], fixed: both}, base: {position: [0, 0], fixed: both}, k1: {position: [0.1, 0], mass: 10 g},
        k2: {position: [0.2, 0], mass: 10 g}, tip: {position: [0.3, 0], mass: 10 g},
        low: {position: [0.2, 0.17], fixed: both}, high: {position: [0.2, 0.3], fixed: both}}
groups: {arm: {kind: bar, stiffness: 1e4, damping: 5}, post: {kind: bar, stiffness: 1e4}, h: {stiffness: 5, damping: 0.05}}
members: {a1: {group: arm, nodes: [base, k1]}, a2: {group: arm, nodes: [k1, k2]}, a3: {group: arm, nodes: [k2, tip]},
          bar: {group: post, nodes: [low, high]}}
hinges: {h1: {group: h, nodes: [wall, base, k1]}, h2: {group: h, nodes: [base, k1, k2]}, h3: {group: h, nodes: [k1, k2, tip]}}
actuators: {turn_1: {hinge: h1, signal: {ramp: {amplitude: bend_1, stop: 1 s}}},
            turn_2: {hinge: h2, signal: {ramp: {amplitude: bend_2, stop: 1 s}}},
            turn_3: {hinge: h3, signal: {ramp: {amplitude: bend_3, stop: 1 s}}}}
collisions: {hit: {between: [arm, post], thickness: 10 mm, stiffness: 0.1 N/m}}
solver: {integrator: verlet, step: 0.1 ms}
run: {duration: 1.5 s, measure: {quantities: {
  miss: {of: "sqrt((tip.x - 0.15 m)^2 + (tip.y - 0.18 m)^2)", take: final}, clear: {of: least_gap, take: min}}}}
YAML
yaml reach.yaml <<'YAML'
study: An arm reaches around a post
model: arm.yaml
search:
  minimise: miss
  subject_to: ["clear >= 0 mm"]
  over: {bend_1: {from: -2, to: 2}, bend_2: {from: -2.5, to: 2.5}, bend_3: {from: -2.5, to: 2.5}}
  method: cma
  evaluations: 240
keep: [miss, clear]
YAML
sed '/subject_to/d' reach.yaml >free.yaml
expect 0 sweep reach.yaml -o reach --quiet
expect 0 sweep free.yaml -o free --quiet
best() { sed -n 2p "$1/best.csv" | cut -d, -f"$2"; }
awk "BEGIN { exit !($(best reach 8) >= 0 && $(best reach 7) < 0.03) }" || fail "the arm: $(cat reach/best.csv)"
awk "BEGIN { exit !($(best free 8) < 0 && $(best free 7) < 0.002) }" || fail "the free arm: $(cat free/best.csv)"
edit '/^collisions:/d' arm.yaml tells 2 "'least_gap' is of collisions, and the scene has none" check

# Everything else knows collisions.
shows 0 "drawn gap" check hinged.yaml
for file in cradle rods hinged; do writes_back $file.yaml; done
shows 0 "rest" modes peg.yaml --at equilibrium-2
expect 0 rigidity peg.yaml
expect 0 run hinged.yaml -o pictures --quiet --plot hinged.svg
expect 0 view pictures -o page.html
grep -q '"name":"hit","thickness":0.05,"nodes":\[2\],"members":\[0\]' page.html || fail "no collision on the page"

# ---- a disc that slides along a rod on which it lies: mu g takes its speed, in every method ----
yaml slides.yaml <<'END'
nodes: {a: {position: [-5, 0], fixed: both}, b: {position: [5, 0], fixed: both}, d: {position: [-2, 0.099], mass: 2}}
members: {rod: {kind: bar, nodes: [a, b], stiffness: 1000}}
collisions: {k: {node: d, member: rod, thickness: 0.1, stiffness: 10000, damping: 200, friction: {mu: 0.3, width: 0.1 mm/s}}}
gravity: [0, -5]
initial: {velocity: [2, 0]}
solver: {step: 0.1 ms}
run: {duration: 1 s}
END
for method in rk4 rk4-events verlet adaptive euler; do
  expect 0 run slides.yaml --integrator $method --json
  holds '(if .method == "euler" then 1e-3 else 1e-8 end) as $e |
    (.nodes.d.position[0] + 0.75 | fabs < $e) and (.energy.residual | fabs < $e)'
done
tells 1 "midpoint does not know the friction of collisions" run slides.yaml --integrator midpoint
# two discs side by side: what one loses along the other, the other gains
sed '/^members/d; /^gravity/d; s/^nodes.*/nodes: {b: {position: [0, 0], mass: 1}, d: {position: [0.099, 0], mass: 2}}/
  s/velocity: .*/velocities: {b: [0.5, 1], d: [0, 0]}}/; s/node: d, member: rod/nodes: [b, d]/; s/damping: 200/damping: 50/' \
  slides.yaml >side.yaml
expect 0 run side.yaml --integrator adaptive --json -o side
holds '(.energy.residual | fabs < 1e-6) and (.energy.dissipated_friction > 0.1)'
