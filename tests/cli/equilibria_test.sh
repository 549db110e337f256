#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut equilibria as people meet it: the crawler's report, files, options, bad input, determinism.
. "$(dirname "$0")/lib.sh"
crawler=$here/../../models/crawler/crawler.yaml

expect 0 equilibria "$crawler"
err_empty
for text in "I            n1,n4      stable      22.706131 J" "stands" \
  "tips over n4 onto n2 and n4: II" "below ground (" "III" "unstable ones, saddles and maxima" \
  "from         to                  barrier straight there  over"; do out_has "$text"; done

expect 0 equilibria "$crawler" --json -o results
cp out all.json
same all.json results/equilibria.json
files results equilibria.json
for key in name strut_version seed starts missed chance bound remark equilibria label energy \
  potential contacts supports fate verdict tips_over ends_as shape placements found nodes forces \
  reactions below_ground eigenvalues negative_eigenvalues zero_eigenvalues rest residual down \
  barriers from to height saddle via direct direct_saddle; do
  out_has "\"$key\":"
done

# The same bits whatever the number of threads; another seed is another search for the same shapes.
OMP_NUM_THREADS=1 "$strut" equilibria "$crawler" --json >one.json || fail "one thread"
OMP_NUM_THREADS=3 "$strut" equilibria "$crawler" --json >three.json || fail "three threads"
same one.json three.json
same one.json all.json
expect 0 equilibria "$crawler" --json --seed 7 --supports n1,n4
out_has '"seed":	7,'
out_has '"energy":	22.70613'
out_has '"energy":	22.71202'
grep -q '"supports":	\["n2", "n4"\]' out && fail "--supports holds others too"
expect 0 equilibria "$crawler" --starts 40 --supports n2,n5
err_empty

# A run may start at an equilibrium; the scene written has it as positions.
sed 's/^initial: .*/initial: {equilibrium: start}/' "$crawler" >start.yaml
for state in I II III; do
  expect 0 write start.yaml --set "start=$state"
  out_has "positions:"
  grep -q "equilibrium:" out && fail "the effective scene still wants an equilibrium"
  cp out "$state.yaml"
  expect 0 check "$state.yaml"
done
expect 0 check start.yaml
expect 2 run start.yaml --set start=IV

# Wrong input.
expect 1 equilibria "$crawler" --supports n1,n6
out_empty
err_has "--supports: there is no node 'n6'; did you mean 'n"
expect 1 equilibria "$crawler" --supports n1,n1
err_has "named twice"
expect 1 equilibria "$crawler" --supports ""
err_has "--supports"
expect 1 equilibria "$crawler" --starts -3
err_has "--starts"
expect 1 equilibria "$crawler" --seed many
err_has "--seed"
expect 1 equilibria "$crawler" --friction
expect 4 equilibria missing.yaml
printf 'strut: 1\nnodez: {}\n' >bad.yaml
expect 2 equilibria bad.yaml
err_has "did you mean 'nodes'?"
cat >bar.yaml <<'YAML'
strut: 1
nodes: {a: [0, 0], b: [1, 0]}
members: {ab: {nodes: [a, b], kind: bar, stiffness: 1000, mass: 1}}
gravity: [0, -9.81]
YAML
expect 3 equilibria bar.yaml
err_has "nothing holds the structure: it falls freely, all nodes"
expect 3 equilibria bar.yaml --json
out_has '"equilibria":	[]'
out_has '"remark":	"nothing holds the structure'
expect 1 equilibria bar.yaml --supports a,b
err_has "supports"
done_testing
