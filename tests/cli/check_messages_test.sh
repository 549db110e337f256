#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# check --json: messages with their places, for editors; and studies.
unpack=$(realpath "$2")
bad=$(realpath "$(dirname "$0")/../language/bad")
studies=$(realpath "$(dirname "$0")/../language/studies")
. "$(dirname "$0")/lib.sh"

yaml b.yaml <<'END'
nodes: {a: [0, 0], ä: [1 kg, 2]}
members: {ab: {nodes: [a, c], kind: bar, stifness: 3}}
END
expect 2 check b.yaml --json
err_empty
cat >wanted <<'END'
b.yaml:2:24:4: error: expected a length such as '10 mm' for 'position' of node 'ä', found a mass [null]
b.yaml:3:27:1: error: unknown node 'c' in 'nodes' of member 'ab' [null]
b.yaml:3:42:8: error: unknown key 'stifness' in member 'ab' [did you mean 'stiffness'?]
END
jq -r '.messages[] | "\(.file):\(.line):\(.column):\(.length): \(.severity): \(.message) [\(.hint)]"' out >got
same wanted got
holds '.valid == false and .unlisted == 0'
"$strut" check - --json <b.yaml >out 2>err
[ $? -eq 2 ] || fail "the exit code of a bad scene on the standard input"
holds '.messages[0].file == "<stdin>" and (.messages | length) == 3'
# JSON and text say the same, in the same order.
count=0
mkdir bad
"$unpack" "$bad" bad || fail "no bad scenes"
for file in bad/*.yaml; do
  count=$((count + 1))
  [ $((count % 25)) -eq 0 ] || continue
  "$strut" check "$file" --json >out 2>err
  code=$?
  "$strut" check "$file" >plain 2>text
  [ $? -eq $code ] || fail "$file: exit code $code with --json"
  [ $code -eq 2 ] || continue
  jq -r '.messages[] | select(.severity == "error") |
    "\(.line):\(.column): error: \(.message)\(if .hint then "; " + .hint else "" end)"' out | head -n 50 | grep -v "^1:1:" >got
  sed -n 's/^[^ ]*\.yaml:\([0-9]*:[0-9]*: error: \)/\1/p' text | grep -v "^1:1:" >wanted
  same wanted got
done

# The text as vim takes it apart, with the pattern of docs/editor.md.
if command -v vim >/dev/null; then
  expect 2 check -q b.yaml
  vim -es -u NONE --not-a-term -c 'set errorformat=%f:%l:%c:\ %trror:\ %m' -c 'cgetfile err' \
    -c 'call writefile(map(filter(getqflist(), "v:val.valid"), "v:val.lnum . \":\" . v:val.col . v:val.type"), "got")' \
    -c 'qa!' </dev/null >/dev/null 2>&1
  printf '2:24e\n3:27e\n3:42e\n' >wanted
  same wanted got
else
  echo "no vim"
fi

# A warning about a thing of a copy is where its part says it, or where it is placed.
printf 'strut: 1\nparts:\n  rod: {nodes: {a: {position: [0, 0], mass: 1 kg}}}\nnodes: {b: {position: [0, 0], mass: 1 kg}, c: {position: [0, 1], mass: 1 kg}}\nmembers: {bc: {kind: spring, nodes: [b, c], stiffness: 1 N/m, rest_length: 1 m}}\nplace:\n  one: {part: rod, repeat: {count: 2, step: [1, 0]}}\n' >copies.yaml
printf 'run: {duration: 1 s}\nsolver: {step: 1 ms}\n' >>copies.yaml
expect 0 check copies.yaml --json
holds '.messages[0] | (.message | startswith("nodes one.0.a, one.1.a have mass")) and .line == 3 and .column == 17'

# Notes and other files.
printf 'strut: 1\nparts: {rod: {use: part.yaml}}\nplace: {one: {part: rod}}\n' >used.yaml
printf 'strut: 1\nnodes: {a: [0, 0], b: [1, 0]}\nmembers: {m: {kind: bra, nodes: [a, b], stiffness: 1}}\n' >part.yaml
expect 2 check used.yaml --json
holds '.messages[0] | (.file | endswith("part.yaml")) and .line == 3 and .column == 21'

# A valid scene: nothing else has changed, and warnings have places.
yaml w.yaml <<'END'
nodes:
  a: {position: [0, 0], fixed: both}
  b: {position: [1, 0], mass: 1}
members:
  one: {nodes: [a, b], kind: bar, stiffness: 100}
  two: {nodes: [a, b], kind: bar, stiffness: 100}
END
expect 0 check w.yaml --json
holds '.valid and .nodes == 2 and .members.one.stiffness == 100' '.messages | length == 1'
holds '.messages[0] | .severity == "warning" and (.line == 6 or .line == 7) and .column == 3 and .length == 3'
holds '.messages[0].message == .warnings[0].text'
# What has no place stands at the beginning of the file.
yaml f.yaml <<'END'
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [0, -1], mass: 1}}
members: {m: {nodes: [a, b], kind: spring, stiffness: 100}}
ground: {height: -2, stiffness: 1000, friction: {law: coulomb, mu: 0.1}}
solver: {integrator: rk4, step: 1 ms}
run: {duration: 1 s}
END
"$strut" check f.yaml >out 2>err
code=$?
[ $code -ne 0 ] || fail "Coulomb friction with a method without events"
expect $code check f.yaml --json
err_empty
holds '.valid == false and (.messages | length == 1)'
holds '.messages[0] | .file == "f.yaml" and .line == 1 and .column == 1 and .length == 0'
refuses 4 "No such file" check missing.yaml --json

# Studies.
cp -R "$studies" studies
"$unpack" studies/bad studies/bad || fail "no bad studies"
for study in studies/good/*.yaml; do
  shows 0 ": valid" check "$study"
  expect 0 check "$study" -q
  out_empty
  finds '.valid and .points >= 1 and (.study | length > 0)' check "$study"
done
for study in studies/bad/*.yaml; do
  [ "$study" != studies/bad/study-is-model.yaml ] || continue
  "$strut" sweep "$study" --count >out 2>text
  code=$?
  [ $code -ne 0 ] || continue # what sweep finds out later
  expect $code check "$study"
  out_empty
  same text err
  expect $code check "$study" --json
  err_empty
  jq -r '.messages[] | select(.severity == "error") |
    "\(.line):\(.column): error: \(.message)\(if .hint then "; " + .hint else "" end)"' out | head -n 50 | grep -v "^1:1:" >got
  sed -n 's/^[^ ]*\.[a-z]*:\([0-9]*:[0-9]*: error: \)/\1/p' text | grep -v "^1:1:" >wanted
  [ ! -s wanted ] || same wanted got
  holds ".valid == false and (.messages | length > 0)"
done
tells 1 "--step needs a model, not the study" check studies/good/path.yaml --step 1ms
