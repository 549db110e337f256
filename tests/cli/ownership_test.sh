#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What strut did not write it does not overwrite: refused before anything is computed, with the name.
# What it wrote itself it replaces, wherever the same command is given again.
. "$(dirname "$0")/lib.sh"
pentagon=$here/pentagon.yaml

# refuses FILE WORD...: FILE is somebody else's and stays so, nothing new appears in its folder, and the
# message names it.
refuses() {
  file=$1
  shift
  mkdir -p "$(dirname "$file")"
  echo "mine, not strut's" >"$file"
  before=$(ls -A "$(dirname "$file")")
  tells 4 "$file' is not overwritten" "$@"
  [ "$(cat "$file")" = "mine, not strut's" ] || fail "$file: lost by strut $*"
  [ "$(ls -A "$(dirname "$file")")" = "$before" ] || fail "strut $*: left more than was there"
  rm "$file"
}

# Every file of a run, and of the other commands that write into a folder. A run without end shows that
# nothing is computed before.
for name in nodes.csv members.csv contacts.csv energy.csv summary.json scene.yaml trajectory.h5; do
  refuses "run/$name" run "$hopper" --set seconds=1e9 -o run
done
refuses shapes/equilibria.json equilibria "$pentagon" -o shapes
refuses shapes/rigidity.json rigidity "$pentagon" -o shapes
refuses shapes/modes.csv modes "$pentagon" -o shapes
refuses side/model-1.svg compare "$pentagon" "$hopper" -o side
refuses ./picture.svg run "$hopper" --set seconds=1e9 --plot ./picture.svg
refuses ./picture.pdf equilibria "$pentagon" --plot ./picture.pdf
refuses ./page.html view "$hopper" -o ./page.html
refuses ./new.yaml form "$pentagon" -o ./new.yaml

# A file of a study is refused before a point is computed; so is one of its pictures.
cp "$hopper" hopper.yaml
yaml study.yaml <<END
study: heights
model: hopper.yaml
axes: [{seconds: [0.1, 0.2]}]
figures: {velocities: {x: seconds, y: velocity}}
END
for name in table.csv velocities.svg study.yaml model.yaml; do
  refuses "points/$name" sweep study.yaml -o points --quiet
done
absent points/points.slots

# A device, a link or a pipe is nothing that strut wrote either.
ln -s elsewhere link.svg
expect 4 run "$hopper" --plot link.svg
[ -L link.svg ] || fail "a link was replaced"
mkfifo pipe.html
expect 4 view "$hopper" -o pipe.html
[ -p pipe.html ] || fail "a pipe was replaced"

# What strut wrote it replaces: the same command again, and another into the same folder.
expect 0 run "$hopper" --set seconds=0.2 -o run --plot picture.svg --quiet
expect 0 run "$hopper" --set seconds=0.3 -o run --plot picture.svg --quiet
expect 0 view run -o page.html --quiet
expect 0 view run -o page.html --quiet
expect 0 sweep study.yaml -o points --quiet
rm points/points.slots
expect 0 sweep study.yaml -o points --quiet
cp -r run copied # with all that is hidden in it
expect 0 run "$hopper" --set seconds=0.2 -o copied --quiet

# What was changed since is the user's again, until it is moved away.
echo "# a remark" >>run/nodes.csv
cp run/nodes.csv kept
tells 4 "run/nodes.csv' is not overwritten: strut did not write it, or it has been changed since" run "$hopper" --set seconds=1e9 -o run
same run/nodes.csv kept
rm run/nodes.csv
expect 0 run "$hopper" --set seconds=0.2 -o run --quiet

# An empty file holds nothing that could be lost: mktemp makes such.
: >empty.html
expect 0 view "$hopper" -o empty.html --quiet
[ -s empty.html ] || fail "an empty file was not written"

# A list that is garbage, or a link, makes nothing strut's.
expect 0 run "$hopper" --set seconds=0.2 -o odd --quiet
head -c 3000 /dev/urandom >odd/.strut-files
expect 4 run "$hopper" --set seconds=0.2 -o odd --quiet
mkdir linked && echo "untouched" >target && ln -s ../target linked/.strut-files
expect 0 run "$hopper" --set seconds=0.2 -o linked --quiet
[ "$(cat target)" = untouched ] || fail "a link was followed"
