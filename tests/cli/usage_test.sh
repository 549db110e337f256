#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The command line: commands, options, help, suggestions, exit codes 0, 1, 2 and 4.
. "$(dirname "$0")/lib.sh"
hopper=$here/hopper.yaml

expect 1
out_empty
err_has "missing COMMAND"
expect 1 rum
err_has "unknown command 'rum'; did you mean 'run'?"
expect 1 help chek
err_has "did you mean 'check'?"
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
expect 0 help help
out_has "Usage: strut help"
expect 0 help --help
for words in help --help -h; do
  expect 0 $words
  err_empty
  for command in run check export keys; do out_has "  $command "; done
done
for command in run check export keys; do
  expect 0 $command --help
  out_has "Usage: strut $command"
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
expect 1 run "$hopper" --jsno
err_has "unknown option '--jsno'; did you mean '--json'?"
expect 1 run "$hopper" --js
err_has "unknown option '--js'; did you mean '--json'?"
expect 1 run "$hopper" --out x
err_has "unknown option '--out'; did you mean '--output'?"
expect 1 run "$hopper" --out=x
err_has "unknown option '--out'; did you mean '--output'?"
expect 1 run "$hopper" --se step=1
err_has "did you mean '--set'?"
absent x
expect 1 run "$hopper" --json=3
err_has "option '--json' takes no value"
expect 1 run "$hopper" -x
err_has "unknown option '-x'"
expect 1 run "$hopper" -qx
err_has "unknown option '-x'"
expect 1 run "$hopper" -o
err_has "option '-o' needs a value"
expect 1 run "$hopper" --set
err_has "option '--set' needs a value"
expect 1 run "$hopper" --set step
err_has "--set expects NAME=VALUE, not 'step'"
expect 1 run "$hopper" --set =3
err_has "--set expects NAME=VALUE"
expect 1 check "$hopper" --force
err_has "unknown option '--force'"
expect 1 run
err_has "missing MODEL"
expect 1 run "$hopper" other.yaml
err_has "unexpected argument 'other.yaml'"
expect 1 keys "$hopper"
out_empty
err_has "there is no section or key"
expect 1 keys --schema "$hopper"
out_empty
err_has "'strut keys --schema --help' lists the options"
expect 1 run --
err_has "missing MODEL"
expect 0 run -q -- "$hopper"
expect 0 run --quiet "$hopper" --set seconds=0.01
out_empty
err_empty
POSIXLY_CORRECT=1 expect 0 run "$hopper" -q
out_empty

# Parameters.
expect 0 run "$hopper" --json --set seconds=0.02 --set "step=0.05 ms"
out_has '"steps":	400,'
expect 0 run "$hopper" --json --set=seconds=0.02
out_has '"steps":	200,'
expect 2 run "$hopper" --set secnods=0.02
out_empty
err_has "did you mean"
err_has "seconds"
expect 2 run "$hopper" --set "step=1 kg"
expect 2 run "$hopper" --set step=
expect 2 run "$hopper" --set step=-1e-4

# Models.
expect 4 run missing.yaml
err_has "missing.yaml"
err_has "No such file or directory"
expect 4 run "$work"
err_has "Is a directory"
printf 'strut: 1\nnodez: {}\n' >bad.yaml
for command in run check export; do
  expect 2 $command bad.yaml
  out_empty
  err_has "bad.yaml:2:1: error: "
  err_has "did you mean 'nodes'?"
done
printf '' >empty.yaml
expect 2 run empty.yaml
err_has "empty.yaml:"
"$strut" run - --json <"$hopper" >out 2>err || fail "a scene on the standard input"
out_has '"completed"'
"$strut" check - <bad.yaml >out 2>err && fail "a bad scene on the standard input"
err_has ":2:1: error: "

# -q: every command has it, and prints no report.
for command in $(awk '{print $1}' list); do
  expect 0 $command --help
  out_has "-q, --quiet"
done
cat >snap.yaml <<'YAML'
strut: 1
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0.3], mass: 1}, c: {position: [2, 0], fixed: both}}
members:
  ab: {nodes: [a, b], kind: bar, stiffness: 1000}
  bc: {nodes: [b, c], kind: bar, stiffness: 1000}
loads: {push: {node: b, force: [0, -1 N]}}
YAML
for command in check modes equilibria rigidity path; do
  expect 0 $command snap.yaml -q
  out_empty
  err_empty
  expect 0 $command snap.yaml --json -q
  out_has "{"
done
expect 0 check "$hopper" -q
out_empty
for words in "run $hopper -o run" "view run -o p.html" "export run --format vtk -o vtk" \
  "plot run/nodes.csv --plot p.svg" "compare snap.yaml snap.yaml" "form snap.yaml -o form.yaml"; do
  expect 0 $words -q
  out_empty
  err_empty
done

# The other commands.
expect 0 keys --schema
out_has '"rest_length_ratio"'
err_empty
cp out scene.json
expect 0 keys --schema --study
out_has '"variants"'
cmp -s out scene.json && fail "both schemas are the same"
expect 1 keys --schema --studi
err_has "did you mean '--study'?"
expect 1 keys --schema scene
err_has "unexpected argument 'scene'"
expect 0 keys
out_has rest_length_ratio
err_empty
expect 0 export "$hopper"
cp out written.yaml
expect 0 export written.yaml
sed '/^#/d' written.yaml >first
sed '/^#/d' out >second
same first second
expect 0 check "$hopper"
grep -q omitted out && fail "check lists what is absent"
expect 0 check "$hopper" --verbose
err_empty
for text in "Hopper: valid" "nodes              3, with 6 degrees of freedom" \
  "bars 1, springs 1, cables 1" "slack test" "omitted" "inclined ground" "largest step" \
  "rest length" "force density"; do out_has "$text"; done
expect 0 check "$hopper" --json
out_has '"degrees_of_freedom":	6,'
out_has '"rest_length":	0.055,'
out_has '"slack test":	true'
out_has '"inclined ground":	false'

# A scene for statics: check takes it, run does not.
cat >truss.yaml <<'EOF'
strut: 1
nodes: {a: {position: [0, 0], fixed: both}, b: [1, 0.1], c: {position: [2, 0], fixed: both}}
members:
  ab: {nodes: [a, b], kind: bar, stiffness: 1000}
  bc: {nodes: [b, c], kind: bar, stiffness: 1000}
EOF
expect 0 check truss.yaml
out_has "statics only"
expect 0 check truss.yaml --json
out_has '"runnable":	false'
expect 2 run truss.yaml
err_has "truss.yaml"
done_testing
