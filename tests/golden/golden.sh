#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The same bits from every compiler and optimisation: builds golden.c with each and compares the
# hashes of crawler runs, of motion and of works by each method, with tests/golden/crawler.hash.
# Usage: golden.sh ROOT SCRATCH INCLUDES LIBRARIES BUILT|all
# BUILT is the program as the tests have built it: it takes the place of all but three levels.
#
# A hash may change only together with a change of the numerics that the changelog names: run this
# script, see all builds agree, and put the new hash into the file. A change of the energy
# balance leaves the motions' hashes as they are.
set -eu
root=$1 scratch=$2 includes=$3 libraries=$4 built=$5
rm -rf "$scratch"
mkdir -p "$scratch"
cd "$root"
expected=tests/golden/crawler.hash
# The mechanics are compiled for each level, the description and its reader once, or once by each
# compiler.
engine="tests/golden/golden.c engine/run/settle.c
  $(find engine/base engine/model engine/forces engine/integrate -name '*.c' ! -name integrator.c | sort)"
reader=$(find engine/scene parser/language/yaml parser/language/expression parser/language/keys parser/language/read -name '*.c' | sort)

options='-std=c17 -D_POSIX_C_SOURCE=200809L -DSTRUT_VERSION="golden"
  -ffp-contract=off -fno-math-errno -Wno-psabi'

# compare NAME PROGRAM OUTPUT: its hashes, one line for each method, to OUTPUT, and what is wrong with them.
compare() {
  "$2" tests/golden/crawler.yaml 20000 >"$scratch/run-$(basename "$2")"
  sed "s/^/$1: /" "$scratch/run-$(basename "$2")" >>"$3"
  diff "$expected" "$scratch/run-$(basename "$2")" | sed -n "s/^[<>]/$1: &/p" >>"$scratch/wrong"
}

# read_by COMPILER LEVEL: the reader, whose objects every level links.
read_by() {
  mkdir -p "$scratch/reader-$1"
  for source in $reader; do
    "$1" $options "$2" -I. $includes -c "$source" -o "$scratch/reader-$1/$(echo "$source" | tr / _).o"
  done
}

# build COMPILER READER: its hashes by each of its levels.
build() {
  [ "$built" != all ] || read_by "$1" -O2
  for level in -O0 -O2 -O3 "-O3 -march=native"; do
    case $built/$1/$level in
      all/* | */gcc/-O0 | */gcc/*native | */clang/-O3) ;;
      *) continue ;;
    esac
    "$1" $options $level -I. $includes $engine "$scratch/reader-$2"/*.o -o "$scratch/golden-$1" \
      $libraries -lm
    compare "$1 $level" "$scratch/golden-$1" "$scratch/$1"
  done
}

if [ "$built" != all ]; then
  compare built "$built" "$scratch/all"
  for first in gcc clang; do
    ! command -v "$first" >/dev/null || break
  done
  read_by "$first" -O0
fi

# The compilers side by side.
running=
for compiler in gcc clang; do
  command -v "$compiler" >/dev/null || { echo "skipped: no $compiler here"; continue; }
  build "$compiler" "${first:-$compiler}" &
  running="$running $compiler:$!"
done
failed=0
for one in $running; do
  wait "${one#*:}" || { echo "${one%:*} does not build it, or it does not run"; failed=1; }
done
for one in $running; do cat "$scratch/${one%:*}" 2>/dev/null || :; done >>"$scratch/all"
cat "$scratch/all"
[ ! -s "$scratch/wrong" ] || { echo "expected <, made >"; cat "$scratch/wrong"; failed=1; }
exit "$failed"
