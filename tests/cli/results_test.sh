#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What -o DIR holds, and that equal runs give equal bytes.
. "$(dirname "$0")/lib.sh"
all="contacts.csv energy.csv members.csv nodes.csv scene.yaml summary.json trajectory.h5"

expect 0 run "$hopper" -o deep/er/one
err_empty
out_has "Hopper: completed"
files deep/er/one $all
expect 0 run "$hopper" -o two -q
out_empty
same_directory deep/er/one two
shows 0 '"wall_time":' run "$hopper" -o two --json # over the old ones, with the same bytes
grep -v '"wall_time":' out >without
same without two/summary.json
same_directory deep/er/one two

# The scene as it was run gives the same bits, in every file.
expect 0 run two/scene.yaml -o three -q
same_directory two three

# Headers and rows.
expected='time [s],foot.x [m],foot.y [m],foot.vx [m/s],foot.vy [m/s],body.x [m],body.y [m],'
expected=$expected'body.vx [m/s],body.vy [m/s],arm.x [m],arm.y [m],arm.vx [m/s],arm.vy [m/s]'
[ "$(head -n 1 two/nodes.csv)" = "$expected" ] || fail "header of nodes.csv"
[ "$(sed -n 2p two/nodes.csv | cut -d , -f 1-3)" = "0,0,0" ] || fail "first row of nodes.csv"
[ "$(head -n 1 two/members.csv | cut -d , -f 1-3)" = "time [s],leg.length [m],leg.force [N]" ] ||
  fail "header of members.csv"
[ "$(head -n 1 two/contacts.csv | cut -d , -f 1-3)" = \
  "time [s],foot.normal [N],foot.friction [N]" ] || fail "header of contacts.csv"
[ "$(head -n 1 two/energy.csv | cut -d , -f 1-2)" = "time [s],kinetic [J]" ] ||
  fail "header of energy.csv"
for name in nodes members contacts energy; do
  [ "$(wc -l <two/$name.csv)" -eq 502 ] || fail "rows of $name.csv"
done

# Channels decide the files; files of a run before do not stay, those of others do.
sed 's/channels: .*/channels: [position]}/' "$hopper" >less.yaml
echo mine >two/notes.txt
expect 0 run less.yaml -o two -q
files two nodes.csv notes.txt scene.yaml summary.json trajectory.h5

# Refusals leave everything as it was.
cp -r two before
expect 2 run less.yaml --set step=0 -o two
expect 3 run less.yaml --set "step=20 ms" -o two
expect 1 run less.yaml --qiet -o two
same_directory before two
expect 2 run less.yaml --set step=0 -o new
absent new

if command -v h5dump >/dev/null; then
  h5dump -H three/trajectory.h5 >out 2>err || fail "h5dump"
  out_has 'DATASET "position"' '( 501, 3, 2 )' 'DATASET "contact"' 'ATTRIBUTE "status"'
  h5dump -a status -a strut_version -a scene three/trajectory.h5 >out 2>err || fail "attributes"
  out_has '"completed"' 'strut: 1'
fi
