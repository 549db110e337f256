#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The recipes for a friction law, a law of members, a strain and a method of integration do what they promise:
# copies the sources, applies the ```diff blocks of docs/recipes.md, compiles what recipes.c runs, and runs it.
# Usage: recipes.sh ROOT SCRATCH CC INCLUDES LIBRARIES
set -eu
root=$1 scratch=$2 cc=$3 includes=$4 libraries=$5
command -v patch >/dev/null || { echo "skipped: no patch here"; exit 77; }
rm -rf "$scratch"
mkdir -p "$scratch/tests"
cp -R "$root/engine" "$root/parser" "$scratch/"
cp -R "$root/tests/recipes" "$scratch/tests/"
awk '/^```diff/ { inside = 1; blocks++; next } /^```/ { inside = 0 } inside { print }
  END { exit blocks == 0 }' "$root/docs/recipes.md" >"$scratch/recipes.diff"
cd "$scratch"
touched=$(sed -n 's/^+++ b\///p' recipes.diff | sort | tr '\n' ' ')
expected="engine/forces/elements.c engine/forces/strains/span.h engine/integrate/euler_forward.c \
engine/model/elements.c engine/model/elements.h engine/scene/experiment.h engine/scene/friction.h \
engine/scene/law.h engine/scene/laws/stiffening.h "
[ "$touched" = "$expected" ] || { echo "the recipes touch other files: $touched"; exit 1; }
patch -s -p1 <recipes.diff

# The texts of exported code, which recipes.c has no use for, are empty.
{
  echo '#include "engine/output/code/templates.h"'
  sed -n 's/.*extern//; s/strut_embedded//; /_template\[\]/p' engine/output/code/templates.h |
    grep -o 'strut_code_[a-z]*_template' | sed 's/.*/const strut_embedded &[] = {{0}};/'
} >templates.c
sources="tests/recipes/recipes.c templates.c $(ls engine/base/*.c engine/scene/*.c \
  engine/model/*.c engine/forces/*.c engine/statics/search/*.c engine/statics/equilibria/*.c \
  engine/output/code/*.c) $(find engine/integrate parser/yaml parser/expression parser/language \
  parser/read parser/write -name '*.c') $(ls engine/run/settle*.c engine/output/buffer.c \
  engine/output/file.c engine/output/results.c)
  engine/statics/curvature.c engine/statics/dense_algebra.c engine/statics/minimise.c
  engine/statics/potential.c engine/statics/rigid_motions.c engine/statics/spectrum.c"
# shellcheck disable=SC2086
printf '%s\n' $sources | xargs -P 2 -n 12 sh -c 'cc=$1 includes=$2; shift 2
  for file; do
    $cc -std=c17 -D_POSIX_C_SOURCE=200809L -DSTRUT_VERSION="\"recipes\"" -ffp-contract=off \
      -fno-math-errno -Wno-psabi -Wswitch -Werror=switch -O0 -I. $includes -c "$file" \
      -o "$(echo "$file" | tr / _).o" || exit 255
  done' sh "$cc" "$includes"
# shellcheck disable=SC2086
$cc ./*.o -o recipes $libraries -lpthread -lm
./recipes
