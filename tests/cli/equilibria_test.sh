#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut equilibria as people meet it: the crawler's report, files, options, bad input, determinism.
. "$(dirname "$0")/lib.sh"

# First what stands and its barriers, then counts; --all has every row. Shapes are told apart.
expect 0 equilibria "$crawler"
err_empty
for text in "I                 stable  22.7061 J" "equilibrium  " "III" "collapsed" "1 crossing" \
  "barrier  over" "others, that --all lists                   203" "passes between stable ones"; do
  out_has "$text"
done
out_has_not "below ground ("
[ "$(wc -l <out)" -lt 45 ] || fail "the short table is long"
expect 0 equilibria "$crawler" --all --starts 60
out_has "tips over n4 onto n2 and n4: II" "below ground (" "presses with" "held-n1-n2-1 " "III, III-2"

# Numbers in names grow with the energy, and so does the list.
expect 0 equilibria "$models/basics/von-mises-truss.yaml" --json
holds '[.equilibria[] | select(.outcome == "stands") | .energy] | . == sort and .[0] < .[1]'
[ "$(jq -c '[.equilibria[] | select(.outcome == "stands")] | sort_by(.energy) | map(.name)' out)" = \
  '["equilibrium-1","equilibrium-2"]' ] || fail "names are not in the order of the energy"

# Of equal energies the list has the order of the names.
expect 0 equilibria "$models/parts/bistable-lattice.yaml" --json
holds '[.equilibria[].name | select(startswith("equilibrium-")) | ltrimstr("equilibrium-") | tonumber] | . == sort'
holds '.missed.unstable | startswith("passes")'

expect 0 equilibria "$crawler" --json -o results
cp out all.json
same all.json results/equilibria.json
files results equilibria.json
for key in name strut_version seed starts missed probability smallest_basin remark equilibria label energy \
  potential contacts supports outcome verdict tips_over ends_as shape congruent_copies found collapsed crossings nodes forces \
  reactions below_ground eigenvalues negative_eigenvalues zero_eigenvalues rest residual down \
  barriers from to height saddle via direct direct_saddle; do
  out_has "\"$key\":"
done

# The same bits whatever the number of threads; another seed is another search for the same shapes.
OMP_NUM_THREADS=1 "$strut" equilibria "$crawler" --json >one.json || fail "one thread"
OMP_NUM_THREADS=3 "$strut" equilibria "$crawler" --json >three.json || fail "three threads"
same one.json three.json
same one.json all.json
shows 0 '"seed":	7,' equilibria "$crawler" --json --seed 7 --supports n1,n4
out_has '"energy":	22.70613' '"energy":	22.71202'
grep -q '"supports":	\["n2", "n4"\]' out && fail "--supports holds others too"
# Names of what stands do not depend on the seed.
cp out seed-7
expect 0 equilibria "$crawler" --json --seed 8 --supports n1,n4
for file in seed-7 out; do
  jq -r '.equilibria[] | select(.outcome == "stands") | "\(.name) \(.energy * 1e6 | round)"' $file |
    grep -v n1-n2-n3-n4-n5 | sort >$file.names
done
same seed-7.names out.names
grep -q '^n2-n3-n4-1 22246013$' out.names || fail "names: $(cat out.names)"
expect 0 equilibria "$crawler" --starts 40 --supports n2,n5
err_empty

# A run may start at an equilibrium; the scene written has it as positions.
sed 's/^initial: .*/initial: {equilibrium: start}/' "$crawler" >start.yaml
for state in I II III; do
  shows 0 "positions:" export start.yaml --set "start=$state"
  grep -q "equilibrium:" out && fail "the effective scene still wants an equilibrium"
  cp out "$state.yaml"
  expect 0 check "$state.yaml"
done
expect 0 check start.yaml
expect 2 run start.yaml --set start=IV

# Wrong input.
refuses 1 "--supports: there is no node 'n6'; did you mean 'n" equilibria "$crawler" --supports n1,n6
tells 1 "named twice" equilibria "$crawler" --supports n1,n1
tells 1 "--supports" equilibria "$crawler" --supports ""
tells 1 "--starts" equilibria "$crawler" --starts -3
tells 1 "--seed" equilibria "$crawler" --seed many
expect 1 equilibria "$crawler" --friction
expect 4 equilibria missing.yaml
printf 'strut: 1\nnodez: {}\n' >bad.yaml
tells 2 "did you mean 'nodes'?" equilibria bad.yaml
yaml bar.yaml <<'YAML'
nodes: {a: [0, 0], b: [1, 0]}
members: {ab: {nodes: [a, b], kind: bar, stiffness: 1000, mass: 1}}
gravity: [0, -9.81]
YAML
tells 3 "nothing holds the structure: it falls freely, all nodes" equilibria bar.yaml
shows 3 '"equilibria":	[]' equilibria bar.yaml --json
out_has '"remark":	"nothing holds the structure'
tells 1 "supports" equilibria bar.yaml --supports a,b
# Cables that lie straight along their struts at rest: nodes off the line stretch them, if by little.
yaml hexagon.yaml <<'YAML'
groups: {cable: {kind: cable, stiffness: 1 N/m, rest_length: 0.9 m},
         strut: {kind: bar, stiffness: 10 N/m, rest_length: 1.8 m}, j: {mass: 1 kg}}
nodes: {n1: {position: [1, 0], group: j}, n2: {position: [cos(60 deg), sin(60 deg)], group: j},
        n3: {position: [cos(120 deg), sin(120 deg)], group: j}, n4: {position: [-1, 0], group: j},
        n5: {position: [cos(240 deg), sin(240 deg)], group: j},
        n6: {position: [cos(300 deg), sin(300 deg)], group: j}}
members: {c12: {group: cable, nodes: [n1, n2]}, c23: {group: cable, nodes: [n2, n3]},
          c34: {group: cable, nodes: [n3, n4]}, c45: {group: cable, nodes: [n4, n5]},
          c56: {group: cable, nodes: [n5, n6]}, c61: {group: cable, nodes: [n6, n1]},
          s13: {group: strut, nodes: [n1, n3]}, s35: {group: strut, nodes: [n3, n5]},
          s51: {group: strut, nodes: [n5, n1]}}
YAML
shows 0 "nodes n2, n4 and n6 meet no stiffness to second order" equilibria hexagon.yaml
out_has_not "one of many shapes"

# What rounding leaves of an energy is 0.
yaml four-bars.yaml <<'END'
nodes: {a: {position: [0.269, 1.695], fixed: both}, b: {position: [1.528, 0.51], fixed: both},
        c: {position: [0.991, 0.899], mass: 1}, d: {position: [1.303, 1.577], mass: 1}}
members: {p: {kind: bar, nodes: [a, c], stiffness: 3 kN/m}, q: {kind: bar, nodes: [b, c], stiffness: 7 kN/m},
          r: {kind: bar, nodes: [b, d], stiffness: 7 kN/m}, s: {kind: bar, nodes: [c, d], stiffness: 7 kN/m}}
END
shows 0 "stable         0 J" equilibria four-bars.yaml --all
out_has_not "fJ"

# Two diagonals cross in every frame, and no node lies on another: of structures for sparse algebra, too.
finds '.equilibria[0] | .crossings == 256 and .collapsed == false' equilibria "$here/../bench/net.yaml"
gives '.equilibria[0].crossings' 200 0 equilibria "$here/../bench/chain.yaml"
shows 0 "200 crossings" equilibria "$here/../bench/chain.yaml"

# Large ones end soon, and say so.
{
  printf 'strut: 1\ngravity: [0, -9.8 m/s^2]\ngroups:\n  bar: {kind: bar, stiffness: 1e6 N/m}\n'
  printf '  cable: {kind: cable, stiffness: 1e4 N/m, rest_length_ratio: 95 %%}\n'
  printf 'nodes:\n'
  for k in 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15; do
    fix=", mass: 0.1 kg"
    [ $k = 0 ] && fix=", fixed: both"
    printf '  a%s: {position: [0, 0.5*%s]%s}\n  b%s: {position: [0.6, 0.5*%s]%s}\n' $k $k "$fix" $k $k "$fix"
  done
  printf 'members:\n'
  for k in 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14; do
    n=$((k + 1))
    printf '  x%s: {group: bar, nodes: [a%s, b%s]}\n  y%s: {group: bar, nodes: [b%s, a%s]}\n' $k $k $n $k $k $n
    printf '  l%s: {group: cable, nodes: [a%s, a%s]}\n  r%s: {group: cable, nodes: [b%s, b%s]}\n' $k $k $n $k $k $n
    printf '  t%s: {group: cable, nodes: [a%s, b%s]}\n' $k $n $n
  done
} >tower.yaml
shows 0 "a search of all shapes, bounded to some ten seconds of work" equilibria tower.yaml
expect 0 equilibria "$crawler" --starts 20
out_has_not "cut short"
# A configuration without contacts lies on the side on which it is drawn, though others are alike but for a turn.
yaml sides.yaml <<'YAML'
groups: {rod: {kind: bar, stiffness: 100 kN/m, damping: 1 N s/m, mass: 50 g},
         cable: {kind: cable, stiffness: 500 N/m, damping: 0.5 N s/m, rest_length_ratio: 0.94}}
nodes: {a: [0, 0], b: [100 mm, 0], c: [80 mm, 60 mm], d: [0, 90 mm]}
members: {rising: {group: rod, nodes: [a, c]}, falling: {group: rod, nodes: [b, d]},
          floor: {group: cable, nodes: [a, b]}, right: {group: cable, nodes: [b, c]},
          roof: {group: cable, nodes: [c, d]}, left: {group: cable, nodes: [d, a]}}
gravity: [0, -9.81 m/s^2]
ground: {stiffness: 100 kN/m, damping: 50 N s/m}
configurations: {standing: {}}
YAML
shows 0 "a, b" equilibria sides.yaml
shows 0 "modes at          standing" modes sides.yaml --at standing
