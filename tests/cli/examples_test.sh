#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A scene to start from, and copies of the models that come with strut.
models=$(realpath "$2")
. "$(dirname "$0")/lib.sh"

# new
expect 0 examples --new robot
err_empty
out_has "robot.yaml is written"
files . err out robot.yaml
grep -q '^name: "robot"$' robot.yaml || fail "the name of the scene"
grep -q 'strut run robot.yaml' robot.yaml || fail "the name of the file"
grep -q '@' robot.yaml && fail "a mark is left"
cp robot.yaml first
expect 4 examples --new robot
out_empty
err_has "'robot.yaml' exists already, and is left as it is"
same first robot.yaml
expect 4 examples --new robot.yaml
same first robot.yaml
expect 0 check robot.yaml
err_empty
expect 0 run robot.yaml --json
err_empty
near '.velocity' 0.0614 0.001
jq -e '.status == "completed" and .accuracy.kept' out >/dev/null || fail "the scene does not run"
expect 0 run robot.yaml --set friction=0.2 --json
err_empty
jq -e '.status == "completed"' out >/dev/null || fail "a comment of the scene is wrong"
expect 0 equilibria robot.yaml -q
expect 0 modes robot.yaml -q
expect 0 examples --new other.yml --quiet
out_empty
[ -s other.yml ] || fail "other.yml"
mkdir folder
expect 0 examples --new "folder/a \"b\""
expect 0 check "folder/a \"b\".yaml"
out_has 'a "b": valid'
expect 4 examples --new missing/a
err_has "cannot write 'missing/a.yaml': No such file or directory"
for name in folder/ . "" "$(printf 'a\nb')"; do
  expect 1 examples --new "$name"
  err_has "expected a name for the scene's file"
done
expect 1 examples --new
err_has "option '--new' needs a value"
ln -s nowhere dangling.yaml
expect 4 examples --new dangling
[ ! -e nowhere ] || fail "written through a link"

# examples
expect 0 examples
err_empty
(cd "$models" && find . -name '*.yaml') | sed 's|^\./||' | LC_ALL=C sort >wanted
cut -d' ' -f1 out >got
same wanted got
out_has "Nine-member multistable crawler"
out_has "study: Figure 5"
mkdir here
cd here || exit 1
expect 0 examples crawler
same "$models/crawler/crawler.yaml" crawler.yaml
[ "$(ls)" = crawler.yaml ] || fail "one example: $(ls)"
expect 0 check crawler.yaml -q
expect 4 examples figure-5 # its model is here already
err_has "'crawler.yaml' exists already, and is left as it is"
[ "$(ls)" = crawler.yaml ] || fail "a refused example: $(ls)"
expect 0 examples crawler/figure-8-stops.yaml -o studies
[ "$(ls studies | tr '\n' ' ')" = "crawler.yaml figure-8-stops.yaml stops.yaml " ] || fail "what a study names: $(ls studies)"
expect 0 check studies/figure-8-stops.yaml
expect 0 examples crawler/ -o all -q
out_empty
[ "$(ls all | wc -l)" -eq "$(ls "$models/crawler" | wc -l)" ] || fail "a folder"
expect 0 examples pendulum arm -o two
[ -s two/basics/pendulum.yaml ] && [ -s two/gallery/arm.yaml ] || fail "two folders: $(ls two)"
expect 1 examples crawlr
err_has "there is no example 'crawlr'; did you mean 'crawler'?"
expect 1 examples -o nothing
err_has "missing NAME"
absent nothing
cd "$work" || exit 1
expect 0 complete examples crawler/c
grep -q "^crawler/crawler.yaml	Nine" out || fail "completion of examples"

# From somewhere else: moved, the program finds what was moved with it, else it says so.
mkdir -p moved/bin
cp "$strut" moved/bin/strut
moved/bin/strut examples >out 2>err </dev/null
[ $? -eq 4 ] || fail "models that are not there"
err_has "the models are not installed with this program"
moved/bin/strut examples -q --new plain || fail "new needs nothing that is installed"
[ "$(head -c 20 plain.yaml)" = "# A frame of two leg" ] || fail "a schema that is not there"
mkdir -p "moved/share/strut"
cp -R "$models" moved/share/strut/models
echo '{}' >moved/share/strut/strut-1.schema.json
moved/bin/strut examples >out 2>err </dev/null || fail "the models of an installed program"
cut -d' ' -f1 out >got
same wanted got
moved/bin/strut examples -q --new schema || fail "new with a schema"
head -n 1 schema.yaml | grep -qxF "# yaml-language-server: \$schema=$(realpath moved)/share/strut/strut-1.schema.json" ||
  fail "the schema is not named"
done_testing
