#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Statics of running cables, hinges and laws by strut equilibria and strut modes, against closed forms.
. "$(dirname "$0")/lib.sh"

# A weight on a frictionless ring rests at the bottom of an ellipse: both parts of the string carry
# W / (2 sqrt(1 - (a/L)^2)).
yaml ring.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], fixed: both},
        ring: {position: [0.3, -0.4], mass: 1}}
members: {string: {kind: cable, nodes: [a, ring, b], stiffness: 1e8, rest_length: 1.4}}
loads: {weight: {node: ring, force: [0, -10 N]}}
END
gives '.equilibria | length' 1 0 equilibria ring.yaml
near '.equilibria[0] | .nodes.ring[:2] + [.forces.string, .reactions.a[1]]' \
  '[0.5, -(0.49 - 0.25 | sqrt), 10 / (2 * (1 - 1 / (1.4 * 1.4) | sqrt)), 5]' 1e-6

# Two links with a hinge, pressed by 1.25 times the critical 2 kappa / l: the straight shape is a
# saddle, and in the others P = 2 kappa theta / (l sin theta).
yaml links.yaml <<'END'
groups: {rod: {kind: bar, stiffness: 1e8}}
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0.5, 0], mass: 1},
        c: {position: [1, 0], fixed: y, mass: 1}}
members: {ab: {group: rod, nodes: [a, b]}, bc: {group: rod, nodes: [b, c]}}
hinges: {h: {nodes: [a, b, c], stiffness: 2, rest_angle: 180 deg}}
loads: {press: {node: c, force: [-10, 0]}}
END
gives '[.equilibria[] | select(.label == "saddle")] | length' 1 0 equilibria links.yaml --all
near '[.equilibria[] | select(.label == "saddle")][0].nodes.b[0]' 0.5 1e-6
near '.equilibria[] | select(.label == "stable" and .nodes.c[0] > 0) | .nodes.b as $b | atan2($b[1] | fabs; $b[0]) as $angle |
  [2 * 2 * $angle / (0.5 * ($angle | sin)), .congruent_copies]' '[10, 2]' '1e-5'

# Hencky's chain of n links: the lowest stiffness falls to zero at 4 n^2 sin^2(pi / 2n) EI / L^2, as a
# line of the load.
chain() {
  jq -nr --argjson n "$1" --argjson factor "$2" '
    (4 * $n * $n * (3.141592653589793 / 2 / $n | sin | . * .)) as $critical
    | "strut: 1", "groups: {rod: {kind: bar, stiffness: 1e9}}", "nodes:",
      (range($n + 1) | "  n\(.): {position: [\(.)/\($n), 0], mass: 1\(
        if . == 0 then ", fixed: both" elif . == $n then ", fixed: y" else "" end)}"),
      "members:", (range($n) | "  m\(.): {group: rod, nodes: [n\(.), n\(. + 1)]}"),
      "hinges:", (range(1; $n) | "  h\(.): {nodes: [n\(. - 1), n\(.), n\(. + 1)], stiffness: \($n)}"),
      "loads: {press: {node: n\($n), force: [-\($critical * $factor), 0]}}"'
}
for n in 2 3 8; do
  chain $n 0.5 >chain.yaml
  half=$("$strut" modes chain.yaml --json | jq '.modes[0].eigenvalue')
  chain $n 0.99 >chain.yaml
  gives "(.modes[0].eigenvalue) as \$most | (0.99 * $half - 0.5 * \$most) / ($half - \$most)" 1 1e-6 modes chain.yaml
done

# A cantilever of four links and hinges under a couple: every hinge turns by the same angle M / kappa,
# with M = 2 a F cos(tip), as the forces keep their directions.
yaml cantilever.yaml <<'END'
parameters: {turn: 0.25, force: 4 * turn / (0.2 * cos(4 * turn))}
groups: {rod: {kind: bar, stiffness: 1e9}}
nodes: {wall: {position: [-1, 0], fixed: both}, n0: {position: [0, 0], fixed: both}, n1: {position: [0.25, 0]},
        n2: {position: [0.5, 0]}, n3: {position: [0.75, 0]}, n4: {position: [1, 0]}, u: {position: [1, 0.1]},
        w: {position: [1, -0.1]}}
members: {m0: {group: rod, nodes: [n0, n1]}, m1: {group: rod, nodes: [n1, n2]}, m2: {group: rod, nodes: [n2, n3]},
          m3: {group: rod, nodes: [n3, n4]}, u3: {group: rod, nodes: [n3, u]}, u4: {group: rod, nodes: [n4, u]},
          w3: {group: rod, nodes: [n3, w]}, w4: {group: rod, nodes: [n4, w]}}
hinges: {h0: {nodes: [wall, n0, n1], stiffness: 4, rest_angle: 180 deg},
         h1: {nodes: [n0, n1, n2], stiffness: 4, rest_angle: 180 deg},
         h2: {nodes: [n1, n2, n3], stiffness: 4, rest_angle: 180 deg},
         h3: {nodes: [n2, n3, n4], stiffness: 4, rest_angle: 180 deg}}
loads: {up: {node: u, force: [-force, 0]}, down: {node: w, force: [force, 0]}}
END
expect 0 equilibria cantilever.yaml --json
for k in 1 2 3 4; do
  near ".equilibria | map(select(.label == \"stable\" and .nodes.n4[1] > 0.3)) | min_by(.energy).nodes.n$k[0]" \
    "[range(1; $k + 1) | 0.25 * (0.25 * . | cos)] | add" 1e-6
done

# A weight on a logarithmic and on an exponential spring: L exp(W / (k L)), s ln(1 + W / (k s)).
yaml weights.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0.1, -1], mass: 1}, c: {position: [2, 0], fixed: both},
        d: {position: [2.1, -1], mass: 1}}
members: {log: {kind: spring, nodes: [a, b], stiffness: 10, rest_length: 1, law: logarithmic},
          exp: {kind: cable, nodes: [c, d], stiffness: 10, rest_length: 1, law: {kind: exponential, scale: 0.2}}}
loads: {one: {node: b, force: [0, -5]}, two: {node: d, force: [0, -5]}}
END
gives '.equilibria[] | select(.label == "stable") | [.nodes.b[1], .nodes.d[1], .forces.log, .forces.exp]' \
  '[-(0.5 | exp), -1 - 0.2 * (3.5 | log), 5, 5]' 1e-9 equilibria weights.yaml

# A shape with a hinge is shown as it was found: its mirror image, nearer to the drawn one, is none.
yaml bent.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, 1], fixed: x, mass: 1},
        c: {position: [-0.9, 1.2], mass: 1}}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 100, rest_length: 1},
          bc: {kind: bar, nodes: [b, c], stiffness: 100, rest_length: 1}}
hinges: {h: {nodes: [a, b, c], stiffness: 2, rest_angle: 90 deg}}
END
gives '[.equilibria[] | select(.label == "stable" and .nodes.b[1] > 0)][0].nodes.c[0]' 1 1e-6 equilibria bent.yaml

# What fixed steps miss is reported by name: a hinge whose angle jumps, and stops.
yaml jump.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}, c: {position: [2, 0.1], mass: 1}}
members: {ab: {kind: spring, nodes: [a, b], stiffness: 100}, bc: {kind: spring, nodes: [b, c], stiffness: 100}}
hinges: {h: {nodes: [a, b, c], stiffness: 3}}
actuators: {m: {hinge: h, signal: {square: {amplitude: 0.4, frequency: 2.3 Hz}}}}
solver: {step: 0.1 ms}
run: {duration: 1 s}
END
tells 0 "the drive of hinge 'h' changes its angle by 0.8 rad within one step" run jump.yaml
yaml stop.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}}
members: {m: {kind: spring, nodes: [a, b], stiffness: 1, longest: 1.1, stop_stiffness: 1e5, stop_damping: 300}}
initial: {velocities: {b: [3, 0]}}
solver: {step: 4 ms}
run: {duration: 0.1 s}
END
tells 0 "fixed steps pass over stops" run stop.yaml
# A bar or a spring that carries one sign only does so with the linear law, too.
for kind in bar spring; do
  for law in tension_only compression_only '{carries: tension}' '{carries: compression}'; do
    yaml one.yaml <<END
nodes: {o: {position: [0, 0], fixed: both}, m: {position: [at, 0], mass: 1, fixed: y}}
parameters: {at: 0.5}
members: {s: {nodes: [o, m], kind: $kind, stiffness: 100, rest_length: 1, law: $law}}
solver: {integrator: rk4-events, step: 1 ms}
run: {duration: 0.1}
END
    case $law in *tension*) idle=0.5 busy=1.5 ;; *) idle=1.5 busy=0.5 ;; esac
    gives '.nodes.m.position[0]' $idle 0 run one.yaml --set at=$idle
    gives '.nodes.m.position[0]' "1 + ($busy - 1) * (1 | cos)" 1e-6 run one.yaml --set at=$busy
  done
done
