#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The recipes for a friction law, a law of members, a strain, a number, a kind of thing, an observable and a method do what they promise:
# copies the sources, applies docs/dev/recipes/*.diff, compiles what recipes.c runs, and runs it.
# Usage: recipes.sh ROOT SCRATCH CC INCLUDES LIBRARIES
set -eu
root=$1 scratch=$2 cc=$3 includes=$4 libraries=$5
command -v patch >/dev/null || { echo "skipped: no patch here"; exit 77; }
rm -rf "$scratch"
mkdir -p "$scratch/tests"
cp -R "$root/engine" "$root/parser" "$scratch/"
cp -R "$root/tests/recipes" "$scratch/tests/"
cat "$root"/docs/dev/recipes/*.diff >"$scratch/recipes.diff"
# a number of a hinge that is read, checked, acts, is set from outside and recorded takes its row, its field and its use
number=$(grep -c '^+++ b' "$root/docs/dev/recipes/number.diff")
[ "$number" -eq 3 ] || { echo "a number of a hinge takes $number files"; exit 1; }
cd "$scratch"
touched=$(sed -n 's/^+++ b\///p' recipes.diff | sort -u | tr '\n' ' ')
expected="engine/forces/observe.c engine/forces/strains/strains.h engine/integrate/euler_forward.c \
engine/integrate/events/location/between.c \
engine/model/elements.c engine/model/elements.h engine/scene/experiment.h engine/scene/law.h \
engine/scene/laws/friction.h engine/scene/laws/springs.h engine/scene/observables.h engine/scene/scene.c \
engine/scene/scene.h engine/scene/things_table.h parser/language/keys/keys_table.h parser/language/read/read_scene.c \
parser/language/read/read_things.c parser/language/write/write_scene.c "
[ "$touched" = "$expected" ] || { echo "the recipes touch other files: $touched"; exit 1; }
patch -s -p1 <recipes.diff

sources="tests/recipes/recipes.c tests/recipes/things.c tests/recipes/observable.c $(ls engine/base/*.c \
  engine/statics/search/*.c engine/statics/equilibria/*.c |
    grep -v _values.c) \
  $(find engine/scene engine/model engine/forces engine/integrate parser/language/yaml parser/language/expression parser/language/keys parser/language/read parser/language/write parser/language/study engine/run -name '*.c')
  engine/output/csv.c engine/output/file.c engine/output/buffer.c engine/output/results.c engine/statics/curvature.c engine/statics/dense_algebra.c engine/statics/sparse_algebra.c
  engine/statics/minimise.c engine/statics/potential.c engine/statics/spectrum.c"
printf '%s\n' $sources | xargs -P 2 -n 12 sh -c 'cc=$1 includes=$2; shift 2
  for file; do
    $cc -std=c17 -D_POSIX_C_SOURCE=200809L -DSTRUT_VERSION="\"recipes\"" -ffp-contract=off \
      -fno-math-errno -Wno-psabi -Wswitch -Werror=switch -O0 -I. $includes -c "$file" \
      -o "$(echo "$file" | tr / _).o" || exit 255
  done' sh "$cc" "$includes"
$cc ./*.o -o recipes $libraries -lpthread -lm
./recipes
