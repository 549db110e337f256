#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The same bits from every compiler and optimisation: builds golden.c with each and compares the hash
# of a crawler run with tests/golden/crawler.hash. Usage: golden.sh ROOT SCRATCH INCLUDES LIBRARIES
#
# The hash may change only together with a change of the numerics that the changelog names: run this
# script, see all builds agree, and put the new hash into the file.
set -eu
root=$1 scratch=$2 includes=$3 libraries=$4
expected=$(cat "$root/tests/golden/crawler.hash")
mkdir -p "$scratch"
cd "$root"
sources="tests/golden/golden.c $(ls engine/base/*.c engine/scene/*.c engine/model/*.c \
  engine/forces/*.c engine/integrate/*.c engine/run/*.c parser/*.c)"
failed=0
for compiler in gcc clang; do
  command -v "$compiler" >/dev/null || { echo "skipped: no $compiler here"; continue; }
  for level in -O0 -O2 -O3 "-O3 -march=native"; do
    # shellcheck disable=SC2086
    "$compiler" -std=c17 -D_POSIX_C_SOURCE=200809L -DSTRUT_VERSION='"golden"' -ffp-contract=off \
      -fno-math-errno -Wno-psabi $level -I. $includes $sources -o "$scratch/golden" $libraries -lm
    found=$("$scratch/golden" tests/golden/crawler.yaml 20000)
    echo "$compiler $level: $found"
    [ "$found" = "$expected" ] || failed=1
  done
done
[ "$failed" = 0 ] || { echo "expected $expected"; exit 1; }
