#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Copies of the models that come with strut.
. "$(dirname "$0")/lib.sh"

shows 0 "robot.yaml" examples robot
expect 0 check robot.yaml
err_empty
expect 0 run robot.yaml --json
err_empty
near '.velocity' 0.0614 0.001
holds '.status == "completed" and .accuracy.kept'
expect 0 run robot.yaml --set friction=0.2 --json
err_empty
holds '.status == "completed"'
expect 0 equilibria robot.yaml -q
expect 0 modes robot.yaml -q
expect 0 examples robot # it is here already
out_empty
echo "# mine" >>robot.yaml
cp robot.yaml mine
refuses 4 "'robot.yaml' exists already, and is left as it is" examples robot
same mine robot.yaml
mkdir links
ln -s nowhere links/robot.yaml
expect 4 examples robot -o links
[ ! -e links/nowhere ] || fail "written through a link"

# examples
expect 0 examples
err_empty
(cd "$models" && find . -name '*.yaml') | sed 's|^\./||' | LC_ALL=C sort >wanted
cut -d' ' -f1 out >got
same wanted got
out_has "Nine-member multistable crawler" "study: Figure 5"
mkdir here
cd here || exit 1
expect 0 examples crawler
same "$models/crawler/crawler.yaml" crawler.yaml
[ "$(ls)" = crawler.yaml ] || fail "one example: $(ls)"
expect 0 check crawler.yaml -q
expect 0 examples crawler/figure-8-stops.yaml -o studies
[ "$(ls studies | tr '\n' ' ')" = "crawler.yaml figure-8-stops.yaml stops.yaml " ] || fail "what a study names: $(ls studies)"
expect 0 check studies/figure-8-stops.yaml
expect 0 examples crawler/ -o all -q
out_empty
[ "$(ls all | wc -l)" -eq "$(ls "$models/crawler" | wc -l)" ] || fail "a folder"
expect 0 examples pendulum gallery/arm -o two
[ "$(ls two | tr '\n' ' ')" = "arm.yaml pendulum.yaml " ] || fail "two examples: $(ls two)"
tells 1 "there is no example 'crawlr'; 'strut examples' lists all" examples crawlr
tells 1 "missing NAME" examples -o nothing
absent nothing
cd "$work" || exit 1
expect 0 complete examples crawler/c
grep -qx "crawler/crawler.yaml" out || fail "completion of examples"

# From somewhere else: moved, the program finds what was moved with it, else it says so.
mkdir -p moved/bin
cp "$strut" moved/bin/strut
moved/bin/strut examples >out 2>err </dev/null
[ $? -eq 4 ] || fail "models that are not there"
err_has "the models are not installed with this program"
mkdir -p "moved/share/strut"
cp -R "$models" moved/share/strut/models
moved/bin/strut examples >out 2>err </dev/null || fail "the models of an installed program"
cut -d' ' -f1 out >got
same wanted got
