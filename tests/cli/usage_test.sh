#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The command line: commands, options, help, suggestions, exit codes 0, 1, 2 and 4.
. "$(dirname "$0")/lib.sh"

expect 1
out_empty
err_has "missing COMMAND"
tells 1 "unknown command 'rum'; did you mean 'run'?" rum
tells 1 "did you mean 'check'?" help chek
tells 1 "unknown command 'fit'; 'strut sweep STUDY' computes studies" fit "$hopper"
tells 1 "unknown command 'optimise'; 'strut sweep STUDY' computes studies" optimise "$hopper"
expect 0 --version
grep -qE '^strut [0-9]+\.[0-9]+\.[0-9]+$' out || fail "no version"
err_empty
cp out version
expect 0 -V
same version out
# Commands and their summaries stand in two columns, whatever the longest name.
expect 0 help
grep '^  [a-z]' out >list
[ "$(wc -l <list)" -le 16 ] || fail "more than 16 commands"
[ "$(sed -E 's/^(  [a-z]+ +).*/\1/' list | awk '{print length($0)}' | sort -u | wc -l)" -eq 1 ] ||
  fail "the list of commands is not aligned"
shows 0 "Usage: strut help" help help
expect 0 help --help
for words in help --help -h; do
  expect 0 $words
  err_empty
  for command in run check export keys; do out_has "  $command "; done
done
for command in run check export keys; do
  shows 0 "Usage: strut $command" $command --help
  out_has "--help"
  err_empty
  cp out first
  expect 0 help $command
  same first out
  expect 0 $command -h
  same first out
done
expect 0 run --help
for option in --set --output --json --quiet --force; do out_has "$option"; done
expect 0 check --help
grep -q -- --force out && fail "check has no --force"

# Options: whole names only, suggestions, values where they belong.
tells 1 "unknown option '--jsno'; did you mean '--json'?" run "$hopper" --jsno
tells 1 "unknown option '--js'; did you mean '--json'?" run "$hopper" --js
tells 1 "unknown option '--out'; did you mean '--output'?" run "$hopper" --out x
tells 1 "did you mean '--friction-law', or of a parameter '--set friction=VALUE'?" run "$hopper" --friction 0.2
tells 1 "unexpected argument 'Hz'; a value with a space is quoted: NAME='20 Hz'" run "$hopper" --set f=20 Hz
tells 1 "--accuracy must be at most 20 %, found 100 %; 1 % is 0.01" run "$hopper" --accuracy 1
tells 1 "unknown option '--film'; did you mean '--animate'?" run "$hopper" --film x.mp4
tells 1 "unknown option '--movie'; 'strut run --animate FILE' makes films" sweep "$hopper" --movie=x.mp4
tells 1 "unknown option '--out'; did you mean '--output'?" run "$hopper" --out=x
tells 1 "did you mean '--set'?" run "$hopper" --se step=1
absent x
tells 1 "option '--json' takes no value" run "$hopper" --json=3
tells 1 "unknown option '-x'" run "$hopper" -x
tells 1 "unknown option '-x'" run "$hopper" -qx
tells 1 "option '-o' needs a value" run "$hopper" -o
tells 1 "option '--set' needs a value" run "$hopper" --set
tells 1 "--set expects NAME=VALUE, not 'step'" run "$hopper" --set step
tells 1 "--set expects NAME=VALUE" run "$hopper" --set =3
tells 1 "unknown option '--force'" check "$hopper" --force
tells 1 "missing MODEL" run
tells 1 "unexpected argument 'other.yaml'" run "$hopper" other.yaml
refuses 1 "there is no section or key" keys "$hopper"
refuses 1 "'strut keys --schema --help' lists the options" keys --schema "$hopper"
expect 0 keys --results
cmp out "$here/../../docs/results.md" || fail "docs/results.md is not what strut keys --results prints"
tells 1 "missing MODEL" run --
expect 0 run -q -- "$hopper"
expect 0 run --quiet "$hopper" --set seconds=0.01
out_empty
err_empty
POSIXLY_CORRECT=1 expect 0 run "$hopper" -q
out_empty

# Parameters.
shows 0 '"steps":	400,' run "$hopper" --json --set seconds=0.02 --set "step=0.05 ms"
shows 0 '"steps":	200,' run "$hopper" --json --set=seconds=0.02
expect 2 run "$hopper" --set secnods=0.02
out_empty
err_has "did you mean" "seconds"
expect 2 run "$hopper" --set "step=1 kg"
expect 2 run "$hopper" --set step=
expect 2 run "$hopper" --set step=-1e-4

# Models.
tells 4 "missing.yaml" run missing.yaml
err_has "No such file or directory"
tells 4 "Is a directory" run "$work"
printf 'strut: 1\nnodez: {}\n' >bad.yaml
for command in run check export; do
  expect 2 $command bad.yaml
  out_empty
  err_has "bad.yaml:2:1: error: " "did you mean 'nodes'?"
done
printf '' >empty.yaml
tells 2 "empty.yaml:" run empty.yaml
"$strut" run - --json <"$hopper" >out 2>err || fail "a scene on the standard input"
out_has '"completed"'
"$strut" check - <bad.yaml >out 2>err && fail "a bad scene on the standard input"
err_has ":2:1: error: "

# -q: every command has it, and prints no report.
for command in $(awk '{print $1}' list); do
  shows 0 "-q, --quiet" $command --help
done
yaml snap.yaml <<'YAML'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0.3], mass: 1}, c: {position: [2, 0], fixed: both}}
members: {ab: {nodes: [a, b], kind: bar, stiffness: 1000}, bc: {nodes: [b, c], kind: bar, stiffness: 1000}}
loads: {push: {node: b, force: [0, -1 N]}}
YAML
for command in check modes equilibria rigidity path; do
  expect 0 $command snap.yaml -q
  out_empty
  err_empty
  shows 0 "{" $command snap.yaml --json -q
done
expect 0 check "$hopper" -q
out_empty
for words in "run $hopper -o run" "view run -o p.html" \
  "plot run/nodes.csv --plot p.svg" "compare snap.yaml snap.yaml" "form snap.yaml -o form.yaml"; do
  expect 0 $words -q
  out_empty
  err_empty
done

# The other commands.
shows 0 '"rest_length_ratio"' keys --schema
err_empty
cp out scene.json
shows 0 '"variants"' keys --schema --study
cmp -s out scene.json && fail "both schemas are the same"
tells 1 "did you mean '--study'?" keys --schema --studi
tells 1 "unexpected argument 'scene'" keys --schema scene
shows 0 rest_length_ratio keys
err_empty
expect 0 export "$hopper"
cp out written.yaml
expect 0 export written.yaml
sed '/^#/d' written.yaml >first
sed '/^#/d' out >second
same first second
expect 0 check "$hopper"
err_empty
out_has "Hopper: valid" "largest step of rk4 " "rest length" "force density"
for row in 'nodes +3' 'degrees of freedom +6' 'bars +1' 'springs +1' 'cables +1'; do
  grep -qE "^  $row\$" out || fail "check prints no row '$row'"
done
expect 0 check "$hopper" --format latex
out_has '% Hopper: valid' 'degrees of freedom & 6 \\' 'memory & ' '\begin{tabular}'
expect 0 run "$hopper" --format latex
out_has '%   mean velocity ' '% node' 'node & x & y \\' '%   energy residual '
grep -qE '^[^%\]*(velocity|energy)' out && fail "a line of text is no comment in LaTeX"
shows 0 '"degrees_of_freedom":	6,' check "$hopper" --json
out_has '"rest_length":	0.055,'

# A scene for statics: check takes it, run does not.
yaml truss.yaml <<'EOF'
nodes: {a: {position: [0, 0], fixed: both}, b: [1, 0.1], c: {position: [2, 0], fixed: both}}
members: {ab: {nodes: [a, b], kind: bar, stiffness: 1000}, bc: {nodes: [b, c], kind: bar, stiffness: 1000}}
EOF
shows 0 "statics only" check truss.yaml
shows 0 '"runnable":	false' check truss.yaml --json
tells 2 "truss.yaml" run truss.yaml
