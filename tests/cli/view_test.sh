#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# strut view: what it says, files that appear whole or not at all, and refusals.
. "$(dirname "$0")/lib.sh"

yaml swing.yaml <<'END'
name: Swing
nodes: {a: {position: [0, 0], fixed: both}, b: {position: [1, 0], mass: 1}}
members: {ab: {kind: bar, nodes: [a, b], stiffness: 1e4}}
gravity: [0, -9.81]
solver: {step: 1 ms}
run: {duration: 0.2 s}
output: {every: 1 ms, channels: [position, force]}
END
expect 0 run swing.yaml -q -o swing

# A run, a model, a model on the standard input.
expect 0 view swing -o swing.html
err_empty
[ "$(sed 's/, [0-9.]* MB$//' out)" = "swing.html: 201 frames" ] || fail "says: $(cat out)"
expect 0 view swing/ -o Swing.HTM -q
out_empty
same swing.html Swing.HTM
expect 0 view swing.yaml -o model.html
[ "$(sed 's/: [0-9.]* MB$//' out)" = "model.html" ] || fail "says: $(cat out)"
grep -q '"motion":null' model.html || fail "a model moves"
"$strut" view - -o - </dev/null >out 2>err
[ $? -eq 1 ] || fail "-o -"
"$strut" view - -o stdin.html -q <swing.yaml >out 2>err || fail "a model on the standard input"
sed 's/"swing.yaml"//' model.html | cmp -s - stdin.html || fail "another page from the standard input"
[ "$(ls -A | grep -c html)" -eq 3 ] || fail "$(ls -A)"

# Without -o: beside the run or the model, and never over a file that strut did not write.
mkdir beside
cp -r swing beside/swing
cp swing.yaml beside/model.yaml
expect 0 view beside/swing/
sed 's#beside/##' beside/swing.html | cmp -s - swing.html || fail "another page without -o"
expect 0 view beside/swing -q
expect 0 view beside/model.yaml -q
[ -s beside/model.html ] || fail "no page of the model"
echo mine >beside/swing.html
tells 4 "strut did not write it" view beside/swing
[ "$(cat beside/swing.html)" = mine ] || fail "overwrote a file"
tells 1 "missing -o FILE.html" view - </dev/null

# Two runs on one page, named by their paths; the first is that of the page alone.
edit 's/duration: 0.2/duration: 0.1/' swing.yaml expect 0 run -q -o beside/short
expect 0 view swing beside/short/ -o two.html
[ "$(sed 's/, [0-9.]* MB$//' out)" = "two.html: 201 frames, beside 101 frames" ] || fail "says: $(cat out)"
grep -q '"label":"swing"' two.html || fail "the first run has no label"
grep -q '"label":"beside/short"' two.html || fail "the second run has no label"
[ "$(grep -c 'id="strut-' two.html)" -eq 2 ] || fail "two runs have other elements"
[ "$(grep -c 'id="strut-' swing.html)" -eq 1 ] || fail "one run has other elements"
tells 1 "two runs can be shown side by side, but 'swing.yaml' is a model" view swing swing.yaml -o none.html
tells 1 "'swing.yaml' is a model" view swing.yaml swing -o none.html
tells 1 "unexpected argument 'swing'" view swing swing swing -o none.html
tells 4 "nowhere" view swing nowhere -o none.html
tells 1 "--set needs a model" view swing swing -o none.html --set x=1
absent none.html

grep -q "script-src 'unsafe-inline'; style-src" swing.html || fail "policy of a page"

# The same page in any locale and with any number of threads.
for locale in C C.UTF-8 de_DE.UTF-8; do
  LC_ALL=$locale OMP_NUM_THREADS=1 expect 0 view swing -o again.html -q
  same swing.html again.html
done
expect 0 view swing.yaml --equilibria none -o none.html
expect 0 view swing.yaml --equilibria all -o again.html
same model.html again.html

# Ctrl-C while it searches: no page.
timeout --preserve-status -s INT 0.1 "$strut" view "$crawler" -o stopped.html >out 2>err
[ $? -eq 130 ] || fail "Ctrl-C"
absent stopped.html

# Wrong use: a sentence, and nothing is written.
tells 1 "missing -o FILE.html" view .
tells 1 "must end in .html" view swing -o page.pdf
expect 1 view swing -o .html
tells 1 "some" view swing -o page.html --equilibria some
tells 1 "--set needs a model" view swing -o page.html --set x=1
tells 1 "missing RUN|MODEL" view -o page.html
expect 1 view swing -o page.html --plot a.svg
absent page.html

# Files: where the page cannot go is found out first; what is no run is said to be none.
tells 4 "no/such/folder" view no-such-model.yaml -o no/such/folder/page.html
mkdir folder.html
expect 4 view swing -o folder.html
tells 4 "nowhere" view nowhere -o page.html
mkdir empty
tells 4 "holds no run" view empty -o page.html
cp -r swing still
rm still/trajectory.h5
tells 4 "no recorded motion" view still -o page.html
mkfifo still/trajectory.h5
tells 4 "'still/trajectory.h5' is not a regular file" view still -o page.html
rm still/trajectory.h5; echo nonsense >still/trajectory.h5
expect 4 view still -o page.html
cp -r swing damaged
echo '{"status": ' >damaged/summary.json
expect 0 view damaged -o damaged.html -q
grep -q '"value":"summary.json cannot be read"' damaged.html || fail "nothing on the summary"
rm damaged/summary.json
expect 0 view damaged -o damaged.html -q
grep -q '"summary":\[\]' damaged.html || fail "rows from no summary"
edit 's/\[position, force\]/[force]/' swing.yaml expect 0 run -q -o blind
tells 4 "recorded no positions" view blind -o page.html
expect 2 view /dev/null -o page.html
absent page.html
if small_disk 16; then
  expect 4 view swing -o disk/page.html
  [ -z "$(ls -A disk)" ] || fail "left on a full disk: $(ls -A disk)"
  no_disk
fi
