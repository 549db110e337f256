#!/bin/sh
# Cables over circles: pulleys, and discs that push a cable aside, against closed forms.
. "$(dirname "$0")/lib.sh"

# ---- Atwood's machine: 2 m + half a circumference of rope; masses of 1 and 1.5 kg accelerate by g / 5 ----
yaml atwood.yaml <<'END'
nodes: {a: {position: [-1, -3], mass: 1}, p: {position: [0, 0], fixed: both}, b: {position: [1, -5], mass: 1.5}}
members: {rope: {kind: cable, nodes: [a, p, b], stiffness: 100 kN/m, pretension: 11.772, guide_radius: 1}}
gravity: [0, -9.81]
solver: {integrator: rk4-events, step: 0.1 ms}
run: {duration: 0.5}
output: {channels: [position, length, force]}
END
for method in rk4 rk4-events verlet adaptive midpoint; do
  expect 0 run atwood.yaml --integrator $method --json
  holds '(.nodes.b.position[1] + 5 + 0.125 * 9.81 / 5 | fabs < 1e-4) and (.energy.residual | fabs < 1e-6)'
done

# ---- a disc pushed into a cable by 30 N: at rest the tension's two parts balance it; none touches before ----
yaml disc.yaml <<'END'
nodes:
  a: {position: [-2, 0], fixed: both}
  disc: {position: [0, -1.5], mass: 2}
  b: {position: [2, 0], fixed: both}
members:
  rope: {kind: cable, nodes: [a, disc, b], stiffness: 200, rest_length: 3.9, guide_radius: 1, guide_side: right}
  weak: {kind: spring, nodes: [disc, ground], stiffness: 10, rest_length: 0.5}
END
sed -i -e 's/ground\]/low]/' -e 's/^members:/  low: {position: [0, -2], fixed: both}\nmembers:/' disc.yaml
echo 'loads: {up: {node: disc, force: [0, 30]}}' >>disc.yaml
expect 0 path disc.yaml --over disc.y --until '1.5 m' --json
# h: the height of the disc's top over the straight cable; tangents of length t, half the arc about the angle of a tangent
holds '[.points[] | .nodes.disc[1] as $y | (4 + $y * $y) as $d2 | ($d2 - 1 | if . > 0 then sqrt else 0 end) as $t |
    (($y | if . == 0 then 1e-300 else . end) as $z | (if $y < 0 then (2 / -$z | atan) else 3.141592653589793 - (2 / $z | atan) end) - ($t | atan)) as $half |
    if $y <= -1 then .forces.rope - 20 else
      .forces.rope - 200 * (2 * $t + 2 * $half - 3.9) end | fabs] | max < 1e-7'
expect 0 path disc.yaml --json
# twice the rope's part upwards and the weak spring's pull hold 30 N
holds '.points[-1] | .nodes.disc[1] as $y | (3 + $y * $y | sqrt) as $t | (4 + $y * $y) as $d2 |
  .forces.rope * 2 * ($t * $y + 2) / $d2 + .forces.weak - 30 | fabs < 1e-8'
finds '.equilibria | map(select(.label == "stable")) | length > 0' equilibria disc.yaml

# ---- what is refused ----
edit 's/guide_radius: 1}/guide_radius: 4}/' atwood.yaml tells 2 "nodes 'a' and 'p' of member 'rope' are too close for guides with this radius" check
edit 's/guide_radius: 1}/guide_radius: 1, guide_friction: 0.1}/' atwood.yaml tells 2 "only guides that are points rub" check
edit 's/\[a, p, b\]/[a, b]/' atwood.yaml tells 2 "has guide_radius, but runs over no guides" check
edit 's/, guide_side: right//; s/\[0, -1.5\]/[0, 0]/' disc.yaml tells 2 "is drawn straight over 'disc': say by guide_side" check
{ cat atwood.yaml; echo 'actuators: {pull: {member: rope, force: {constant: 1 N}}}'; } >forced.yaml
tells 2 "whose guides have a radius" check forced.yaml
if formats 2 mjcf -o a.xml atwood.yaml; then err_has "guides with a radius"; fi
