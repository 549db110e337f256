#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Several grounds, profiles, circles and shaken ground, against closed forms.
. "$(dirname "$0")/lib.sh"

# last FILE COLUMN: of the last row of a table of the latest run.
last() {
  awk -F, -v want="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, want " ") == 1) c = i }
    END { if (!c) exit 1; print $c }' "run/$1.csv" || fail "no column $2 in $1.csv"
}
# go SCENE METHOD [OPTION...]: runs it into run/.
go() {
  scene=$1 method=$2
  shift 2
  rm -rf run
  expect 0 run "$scene" --integrator "$method" "$@" --quiet -o run
}
# at FILE COLUMN EXPECTED TOLERANCE...: the last row of tables of the latest run.
at() { while [ $# -gt 0 ]; do near_number "$(last "$1" "$2")" "$3" "$4" "$2 of $scene by $method" && shift 4; done; }
# recorded FILE: as yaml, with the channels that are looked at.
recorded() { { cat && echo 'output: {channels: [position, velocity, contact, energy]}'; } | yaml "$1"; }
# closes TOLERANCE WHAT: the energy balance of the latest run.
closes() { near_number "$(jq -r .energy.residual run/summary.json)" 0 "$1" "energy of $2"; }
plain="rk4 euler verlet"
located="rk4-events verlet-events euler-events adaptive"

# ---- a ball in a V of slopes 40 and 60 degrees: N_left sin 40 = N_right sin 60, no sideways force ----
recorded v.yaml <<'END'
gravity: [0, -10]
nodes: {ball: {position: [0, 1 mm], mass: 2}}
grounds:
  left: {slope: -40 deg, through: [0, 0], stiffness: 1e4, damping: 60}
  right: {normal: [-1.7320508075688772, 1], through: [0, 0], stiffness: 1e4, damping: 60}
solver: {integrator: rk4, step: 0.2 ms}
run: {duration: 2 s}
END
for method in $plain $located; do
  go v.yaml "$method"
  at contacts ball.left.normal 17.587704831436334 1e-4 contacts ball.right.normal 13.054072893322784 1e-4
done
closes 1e-12 "the V"
gives '.equilibria | length' 1 0 equilibria v.yaml
gives '[.modes[].eigenvalue] | add' 10000 1e-6 modes v.yaml # the trace of the stiffness
# A profile with the same corner is the same ground in two pieces.
sed -e '/left:/d' -e '/right:/d' -e 's/^grounds:/ground: {profile: [[-1, 0.8390996311772800], [0, 0], [1, 1.7320508075688772]], stiffness: 1e4, damping: 60}/' v.yaml >corner.yaml
go corner.yaml rk4-events
at contacts ball.1.normal 17.587704831436334 1e-4 contacts ball.2.normal 13.054072893322784 1e-4
# Friction holds it: the forces of both contacts balance the weight.
sed 's/damping: 60}/damping: 60, friction: {mu: 0.5, stick_velocity: 1 mm\/s}}/' v.yaml >rough.yaml
for method in rk4 rk4-events verlet-events; do
  go rough.yaml "$method"
  at nodes ball.vy 0 1e-3
  awk -v a="$(last contacts ball.left.normal)" -v f="$(last contacts ball.left.friction)" \
    -v b="$(last contacts ball.right.normal)" -v g="$(last contacts ball.right.friction)" 'BEGIN {
    p = atan2(0, -1) / 180; x = a * sin(40 * p) + f * cos(40 * p) - b * sin(60 * p) + g * cos(60 * p)
    y = a * cos(40 * p) - f * sin(40 * p) + b * cos(60 * p) + g * sin(60 * p) - 20
    exit !(x * x + y * y < 1e-10) }' || fail "balance in the rough V by $method"
done

# ---- a wall at 45 degrees turns horizontal motion into vertical motion ----
recorded wall.yaml <<'END'
nodes: {ball: {position: [0, 0.2], mass: 1}}
grounds: {floor: {stiffness: 1e4}, wall: {normal: [-1, 1], through: [1, 0.2], stiffness: 1e6}}
initial: {velocity: [3, 0]}
solver: {integrator: rk4, step: 0.05 ms}
run: {duration: 1 s}
END
for method in $plain $located; do
  go wall.yaml "$method"
  at nodes ball.vx 0 2e-3 nodes ball.vy 3 2e-3
done
at nodes ball.vy 3 1e-9
# It meets the wall after 1/3 s and is pressed into it for half a period, pi ms, sideways by pi / 2 * 3 mm.
at nodes ball.x 1.00471238898 1e-9 nodes ball.y 2.19528761102 1e-9

# ---- a mass slides off a step: at rest at depth d = m g / k; the corner pushes it on by k d^2 / m ----
recorded step.yaml <<'END'
gravity: [0, -9.81]
nodes: {m: {position: [-0.5, -9.81e-6], mass: 1}}
ground: {profile: [[-1, 0], [0, 0], [0, -1], [1, -1]], stiffness: 1e6, damping: 2000}
initial: {velocity: [1, 0]}
solver: {integrator: rk4-events, step: 0.2 ms}
run: {duration: 1.5 s}
END
for method in rk4-events verlet-events adaptive; do
  go step.yaml "$method"
  at nodes m.vx 1.0000481168925 1e-7 nodes m.y -1.00000981 1e-7 contacts m.2.normal 9.81 1e-4
done
go step.yaml adaptive --tolerance 1e-9
closes 1e-7 "the step"

# ---- without friction in a circular pipe: a pendulum, by elliptic functions ----
recorded pipe.yaml <<'END'
gravity: [0, -9.81]
nodes: {m: {position: [0.5, -0.8660254037844386], mass: 1}}
ground: {circle: {centre: [0, 0], radius: 1, inside: yes}, stiffness: 1e9}
solver: {integrator: rk4, step: 10 us}
run: {duration: 2 s}
END
for method in rk4 verlet verlet-events rk4-events; do
  go pipe.yaml "$method"
  at nodes m.x 0.49643145900515577649 3e-6
  closes 1e-4 "the pipe by $method"
done
at nodes m.x 0.49643145900515577649 1e-7
gives '.modes[0].eigenvalue' 9.81 1e-6 modes pipe.yaml

# ---- on a turning drum: held until g sin(theta) = mu (g cos(theta) - v^2 / R) ----
recorded drum.yaml <<'END'
parameters: {speed: 0.5 m/s}
gravity: [0, -9.81]
nodes: {m: {position: [0, 0.99999999], mass: 1}}
ground: {circle: {centre: [0, 0], radius: 1}, belt_speed: speed, stiffness: 1e7, damping: 5000,
         friction: {law: coulomb, mu: 0.5}}
initial: {velocity: [speed, 0]}
solver: {integrator: rk4-events, step: 50 us}
run: {duration: 0.8 s}
END
for method in rk4-events verlet-events adaptive; do
  go drum.yaml "$method"
  at nodes m.x 0.389418342 2e-6 contacts m.friction -3.8202 1e-3
  closes 1e-6 "the drum by $method"
done
# Faster, it flies at once: v^2 > g R.
go drum.yaml adaptive --set speed=4
at contacts m.normal 0 0

# ---- a shaken table: held by friction, or bouncing once a period beyond pi (1 - e) / (1 + e) ----
recorded held.yaml <<'END'
gravity: [0, -9.81]
nodes: {m: {position: [0, -9.81e-6], mass: 1}}
ground: {motion: {x: {sine: {amplitude: 2 mm, frequency: 5 Hz}}}, stiffness: 1e6, damping: 500,
         friction: {law: coulomb, mu: 0.5}}
solver: {integrator: rk4-events, step: 0.1 ms}
run: {duration: 1.05 s}
END
for method in rk4-events verlet-events adaptive; do
  go held.yaml "$method"
  at nodes m.vx 0 1e-5 contacts m.friction -1.97392088 1e-4 nodes m.x 0.002 5e-4
  closes 1e-6 "the held mass by $method"
done
[ "$(jq -r '.energy.belt_work > 0' run/summary.json)" = true ] || fail "the table's work"
# e = exp(-zeta acos(zeta) / sqrt(1 - zeta^2)) = 0.45, so that the threshold is 1.1916.
recorded bounce.yaml <<'END'
parameters: {shake: 1.3, phase: 23.56 deg, start: 1.2912 mm}
gravity: [0, -9.81]
nodes: {m: {position: [0, start], mass: 1}}
ground: {motion: {y: {sine: {amplitude: shake * 9.81 / (2*pi*10)^2 * 1 m, frequency: 10 Hz, phase: phase}}},
         stiffness: 1e8, damping: 14468.8}
initial: {velocity: [0, 0.4905]}
solver: {integrator: rk4-events, step: 50 us}
run: {duration: 3 s, measure: {last: 1 s}}
END
# bounce GAMMA PHASE START: share of time in contact within the last second
bounce() {
  go bounce.yaml adaptive --set "shake=$1" --set "phase=$2" --set "start=$3"
  jq -r .contacts.m.duty run/summary.json
}
duty=$(bounce 1.21 0.1748 0.523e-3)
awk -v d="$duty" 'BEGIN { exit !(d < 0.02) }' || fail "bounces above the threshold: $duty in contact"
duty=$(bounce 1.17 0 0)
awk -v d="$duty" 'BEGIN { exit !(d > 0.3) }' || fail "rests below the threshold: $duty in contact"

# ---- a block on an incline that is given by its normal: g (sin - mu cos), or held ----
recorded incline.yaml <<'END'
parameters: {mu: 0.5}
gravity: [0, -10]
nodes: {m: {position: [0, 0], mass: 1}}
ground: {normal: [-3, 4], through: [4, 3], stiffness: 1e6, damping: 500, friction: {law: coulomb, mu: mu}}
solver: {integrator: rk4-events, step: 0.1 ms}
run: {duration: 1 s}
END
go incline.yaml rk4-events
at nodes m.vx -1.6 1e-3
go incline.yaml rk4-events --set mu=0.8
at nodes m.vx 0 1e-6
shows 0 "slope: 0.6435011087932844" export incline.yaml
sed 's/^ground: {\(.*\)}$/grounds: {incline: {\1}}/' incline.yaml >named.yaml
go named.yaml rk4-events
at nodes m.vx -1.6 1e-3
head -n 1 run/contacts.csv | grep -qF 'm.normal [N]' || fail "one surface, so contacts are named by nodes"

# ---- a wheel of bars rolls over a bump; its mirror image does so the other way ----
recorded wheel.yaml <<'END'
parameters: {way: 1}
gravity: [0, -9.81]
groups: {rim: {kind: bar, stiffness: 2e4, damping: 4}}
nodes: {hub: {position: [0, 0.1], mass: 0.2}, n0: {position: [way * 0.1, 0.1], mass: 0.05},
        n1: {position: [way * 0.05, 0.18660254], mass: 0.05}, n2: {position: [way * -0.05, 0.18660254], mass: 0.05},
        n3: {position: [way * -0.1, 0.1], mass: 0.05}, n4: {position: [way * -0.05, 0.01339746], mass: 0.05},
        n5: {position: [way * 0.05, 0.01339746], mass: 0.05}}
members: {r0: {group: rim, nodes: [n0, n1]}, r1: {group: rim, nodes: [n1, n2]}, r2: {group: rim, nodes: [n2, n3]},
          r3: {group: rim, nodes: [n3, n4]}, r4: {group: rim, nodes: [n4, n5]}, r5: {group: rim, nodes: [n5, n0]},
          s0: {group: rim, nodes: [hub, n0]}, s1: {group: rim, nodes: [hub, n1]}, s2: {group: rim, nodes: [hub, n2]},
          s3: {group: rim, nodes: [hub, n3]}, s4: {group: rim, nodes: [hub, n4]}, s5: {group: rim, nodes: [hub, n5]}}
grounds:
  floor: {profile: PROFILE, stiffness: 1e5, damping: 30, friction: {law: coulomb, mu: 0.6}}
  stone: {circle: {centre: [way * 0.9, 0], radius: 20 mm}, stiffness: 1e5, damping: 30, friction: {law: coulomb, mu: 0.6}}
initial: {velocity: [way * 2.5, 0]}
solver: {integrator: adaptive, step: 0.5 ms, tolerance: 1e-8}
run: {duration: 0.5 s}
END
sed 's/PROFILE/[[-0.5, 0], [0.2, 0], [0.3, 0.03], [0.4, 0], [2, 0]]/' wheel.yaml >right.yaml
sed -e 's/PROFILE/[[-2, 0], [-0.4, 0], [-0.3, 0.03], [-0.2, 0], [0.5, 0]]/' -e 's/way: 1/way: -1/' wheel.yaml >left.yaml
go right.yaml adaptive
closes 1e-6 "the wheel"
x=$(last nodes hub.x)
awk -v x="$x" 'BEGIN { exit !(x > 0.35) }' || fail "the wheel got to $x only"
go left.yaml adaptive
at nodes hub.x "-$x" 1e-6

# ---- a path against a ceiling and a wall: as against the floor, mirrored and turned ----
yaml floor.yaml <<'YAML'
parameters: {gap: 0.2}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, -0.1], mass: 1}, c: {position: [2, 0], fixed: both}}
members: {l: {kind: spring, nodes: [a, b], stiffness: 100}, r: {kind: spring, nodes: [b, c], stiffness: 100}}
ground: {height: -gap, stiffness: 1e4, nodes: [b]}
loads: {p: {node: b, force: [1, -20]}}
YAML
sed 's/-0.1/0.1/; s/height: -gap/through: [5, gap], normal: [0, -1]/; s/-20/20/' floor.yaml >ceiling.yaml
sed -e 's/\[1, -0.1\]/[-0.1, -1]/; s/\[2, 0\]/[0, -2]/; s/\[1, -20\]/[-20, -1]/' \
  -e 's/height: -gap/through: [-gap, 7], normal: [1, 0]/' floor.yaml >wall.yaml
ends_as_on_the_floor() { # MODEL X Y: the point of the floor that the node's last place stands for
  expect 0 path "$1" $over --json
  jq -e --slurpfile floor floor.last "[.points[-1] | $2, $3, .contacts.b] as \$x |
    [range(3) | \$x[.] - \$floor[0][.] | fabs] | max < 1e-9" out >/dev/null ||
    fail "$1 $over ends at $(jq -c '.points[-1] | [.nodes.b, .contacts.b]' out), not $(cat floor.last)"
}
for over in '' '--over gap --until 0.05'; do
  expect 0 path floor.yaml $over --json
  jq -c '[.points[-1] | .nodes.b[], .contacts.b]' out >floor.last
  holds '.points[-1].contacts.b > 1'
  ends_as_on_the_floor ceiling.yaml '.nodes.b[0]' '-.nodes.b[1]'
  ends_as_on_the_floor wall.yaml '-.nodes.b[1]' '.nodes.b[0]'
done

# ---- what is drawn and written ----
mkdir seen
expect 0 run right.yaml --step '1 ms' --quiet -o seen/run --plot seen/run.svg
expect 0 view seen/run -o seen/run.html
formats 0 vtk -o seen/vtk seen/run &&
  { grep -q 'NumberOfLines="2"' seen/vtk/ground.vtp || fail "outlines for ParaView"; }
grep -q surfaces seen/run.html || fail "outlines on the page"
expect 0 check right.yaml
writes_back right.yaml
# A path between a wall, a ceiling and a floor: each is touched where it is, and takes what springs leave of the load.
yaml walls.yaml <<'END'
nodes: {left: {position: [-1, 0], fixed: both}, right: {position: [1, 0], fixed: both}, pin: [0, 0]}
members: {a: {kind: spring, nodes: [left, pin], stiffness: 10, pretension: 5},
          b: {kind: spring, nodes: [right, pin], stiffness: 10, pretension: 5}}
grounds: {ceiling: {normal: [0, -1], through: [0, 0.2], stiffness: 1000, nodes: [pin]},
          wall: {normal: [-1, 0], through: [0.1, 0], stiffness: 1000, nodes: [pin]},
          floor: {height: -0.3, stiffness: 1000, nodes: [pin]}}
loads: {push: {node: pin, force: [4, 4]}}
END
gives '.events[0].nodes.pin[0]' 0.1 1e-9 path walls.yaml --until 2
near '.events[1].nodes.pin[1]' 0.2 1e-9
holds '[.events[].detail] | (.[0] | test("pin touches wall")) and (.[1] | test("pin touches ceiling"))'
pull='def pull($x): (($x + 1) * ($x + 1) + .[1] * .[1] | sqrt) as $l | 10 * ($l - 0.5) / $l;'
near ".points[-1] | .contacts[\"pin.wall\"] as \$n | .nodes.pin | \$n - 1000 * (.[0] - 0.1)" 0 1e-9
near ".points[-1] | .contacts[\"pin.wall\"] as \$n | .nodes.pin | $pull 8 - \$n - pull(.[0]) * (1 + .[0]) + pull(-.[0]) * (1 - .[0])" 0 1e-8
finds '[.events[].detail] | any(test("pin touches floor"))' path walls.yaml --until -2
sed -e 's/^gravity/bars: rigid\ngravity/' -e 's/, friction: [^}]*}//' right.yaml >rigid.yaml
tells 1 "rigid bars need a ground that is one straight line at rest" run rigid.yaml --integrator rk4
edit 's/0.01339746\], mass: 0.05}/-0.05], mass: 0.05}/' right.yaml tells 0 "nodes n4, n5 start inside the ground" check
