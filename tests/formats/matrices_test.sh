#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Matrix Market: the files, their names and numbers, all or none; and, where Octave is installed, that
# it gets the program's own frequencies and rank out of them.
. "$(dirname "$0")/../cli/lib.sh"

# Two points on a line, held in y: masses 2 and 3, stiffness 8, damping 11, tension 1 on length 4.
yaml pair.yaml <<'YAML'
nodes: {left: {position: [0, 0], mass: 2, fixed: y}, right: {position: [4, 0], mass: 3}}
members: {one: {kind: spring, nodes: [left, right], stiffness: 8, damping: 11, pretension: 1}}
YAML
formats 0 matrices pair.yaml -o m
out_empty
err_empty
files m node_names.csv rows.csv columns.csv connectivity.mtx equilibrium.mtx mass.mtx \
  stiffness_elastic.mtx stiffness_geometric.mtx damping.mtx

# is NAME LINE...: the file without its comments.
is() {
  name=$1
  shift
  printf '%s\n' "$@" >wanted
  grep -v '^%' "m/$name" >found
  cmp -s wanted found || { cat found; fail "$name is not as expected"; }
}
is node_names.csv row,node,x,y 1,left,0,0 '2,right,4,0'
is rows.csv row,node,coordinate 1,left,x '2,right,x' '3,right,y'
is columns.csv column,member,kind,from,to '1,one,spring,left,right'
is connectivity.mtx "2 1 2" "1 1 -1" "2 1 1"
is equilibrium.mtx "3 1 2" "1 1 -1" "2 1 1"
is mass.mtx "3 3 3" "1 1 2" "2 2 3" "3 3 3"
is stiffness_elastic.mtx "3 3 3" "1 1 8" "2 1 -8" "2 2 8"
is stiffness_geometric.mtx "3 3 1" "3 3 0.25"
is damping.mtx "3 3 3" "1 1 11" "2 1 -11" "2 2 11"
[ "$(head -n 1 m/mass.mtx)" = "%%MatrixMarket matrix coordinate real symmetric" ] || fail banner
[ "$(head -n 1 m/equilibrium.mtx)" = "%%MatrixMarket matrix coordinate real general" ] || fail banner

# On the ground: its stiffness too, and it goes again with an export of a shape that does not touch.
yaml ball.yaml <<'YAML'
parameters: {depth: 1 mm}
nodes: {ball: {position: [0, -depth], mass: 1}}
ground: {nodes: [ball], stiffness: 500, damping: 3}
YAML
formats 0 matrices ball.yaml -o m
is stiffness_contact.mtx "2 2 1" "2 2 500"
is damping.mtx "2 2 1" "2 2 3"
formats 0 matrices ball.yaml -o m --set depth='-1 mm'
absent m/stiffness_contact.mtx

# All or none.
cp -r m before
mkdir m/blocked
formats 1 matrices ball.yaml
err_has "-o"
formats 1 matrices ball.yaml -o m --at nowhere
formats 4 matrices missing.yaml -o m
rmdir m/blocked
same_directory before m
mkdir -p n/mass.mtx
formats 4 matrices ball.yaml -o n
err_has "mass.mtx"
files n mass.mtx

command -v octave-cli >/dev/null 2>&1 || exit 0
cp "$here/mm.m" .
formats 0 matrices "$crawler" -o c
expect 0 modes "$crawler" --at drawn --json
grep -o '"angular_frequency":[^,]*' out | tail -n 6 | cut -d: -f2 >own
octave-cli -q --no-gui --eval '
  K = mm("c/stiffness_elastic.mtx") + mm("c/stiffness_geometric.mtx"); M = mm("c/mass.mtx");
  w = sort(sqrt(abs(eig(full(K), full(M))))); own = load("own");
  assert(max(abs(w(end - 5:end) ./ own - 1)) < 1e-9);
  A = mm("c/equilibrium.mtx"); C = mm("c/connectivity.mtx"); assert(rank(full(A)) == 7);
  [i, j, v] = find(A); f = fopen("c/node_names.csv"); fgetl(f);
  x = textscan(f, "%*d %*s %f %f", "Delimiter", ","); d = [x{1}, x{2}]'"'"' * C;
  u = d ./ sqrt(sum(d .^ 2)); assert(norm(reshape(A(:, 1), 2, [])(:, 2) - u(:, 1)) < 1e-14);' \
  >out 2>&1 || fail "Octave does not agree"
