#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# An option and a value of a result are rows: docs/dev/recipes/*.udiff, applied to a copy of the
# program's sources and linked with the libraries of the build, make `strut modes` take the one, and print, write and
# explain the other.
# Usage: rows.sh ROOT BUILD SCRATCH CC
set -eu
root=$(cd "$1" && pwd) build=$(cd "$2" && pwd) scratch=$3 cc=$4
command -v patch >/dev/null || { echo "skipped: no patch here"; exit 77; }
[ -f "$build/parser/language/libstrut_parser.a" ] || { echo "skipped: no static libraries here"; exit 77; }
rm -rf "$scratch"
mkdir -p "$scratch"
cp -R "$root/engine" "$root/parser" "$scratch/"
cat "$root"/docs/dev/recipes/*.udiff >"$scratch/rows.diff"
cd "$scratch"
touched=$(sed -n 's/^+++ b\///p' rows.diff | tr '\n' ' ')
expected="engine/statics/modes/modes_values.c parser/program/command/arguments.h parser/program/command/analyses.c "
[ "$touched" = "$expected" ] || { echo "the patches touch other files: $touched"; exit 1; }
patch -s -p1 <rows.diff

rules=$build/parser/program/CMakeFiles/strut.dir
flags=$(sed -n 's/^C_[A-Z]* = //p' "$rules/flags.make" | tr '\n' ' ' | sed "s#-I$root #-I$PWD #g")
printf '%s\n' parser/program/*.c parser/program/*/*.c engine/statics/modes/modes_values.c |
  xargs -P 2 -n 12 sh -c 'cc=$1 flags=$2; shift 2
    for file; do eval "$cc $flags -O0 -w -c $file -o $(echo "$file" | tr / _).o" || exit 255; done' sh "$cc" "$flags"
libraries=$(tr ' ' '\n' <"$rules/link.txt" | grep -E '[.](a|so)$|^-l' | tr '\n' ' ')
(cd "$build/parser/program" && $cc -Wl,--export-dynamic "$OLDPWD"/*.o -o "$OLDPWD/strut" $libraries)
ln -s "$build/modules" modules

model=$root/models/crawler/crawler.yaml
fail() { echo "$*"; exit 1; }
all=$(./strut modes "$model" --json | grep -c '"period"')
some=$(./strut modes "$model" --below 100Hz --json | grep -c '"period"')
{ [ "$some" -gt 1 ] && [ "$some" -lt "$all" ]; } || fail "--below leaves $some of $all modes"
./strut modes "$model" -o out | grep -q 'frequency  *period  *damping' || fail "the table has no period"
grep -q 'frequency [[]Hz],period [[]s]' out/modes.csv || fail "the CSV has no period"
./strut keys --results | grep -q 'modes.period. | s | of an oscillation' || fail "the page of results has no period"
./strut modes --help | grep -q -- '--below FREQUENCY  *leave out higher modes' || fail "--below is not explained"
./strut complete modes --bel | grep -qx -- --below || fail "--below is not completed"
./strut modes "$model" --below 3kg 2>&1 | grep -q -- '--below expects a frequency' || fail "3kg is a frequency"
echo "rows do it: $some of $all modes"
