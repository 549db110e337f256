#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The same bits from every compiler and optimisation: builds golden.c with each and compares the
# hash of a crawler run with tests/golden/crawler.hash. Of the method with events, whose bits no
# file holds, all builds must say the same. Usage: golden.sh ROOT SCRATCH INCLUDES LIBRARIES [all]
# Without `all`, two levels of each compiler.
#
# The hash may change only together with a change of the numerics that the changelog names: run this
# script, see all builds agree, and put the new hash into the file.
set -eu
root=$1 scratch=$2 includes=$3 libraries=$4 levels=${5:-some}
expected=$(cat "$root/tests/golden/crawler.hash")
rm -rf "$scratch"
mkdir -p "$scratch"
cd "$root"
# What the run executes, and no more: the mechanics are compiled for each level, the
# description and its reader once for each compiler.
engine="tests/golden/golden.c engine/run/settle.c engine/integrate/rk4.c
  $(ls engine/integrate/small_*.c engine/integrate/events/small_*.c engine/integrate/events/contact_coupling.c)
  $(ls engine/integrate/events/local_*.c)
  engine/integrate/events/verlet_events.c engine/integrate/events/event_stepping.c
  engine/integrate/events/event_log.c engine/integrate/events/event_location.c
  engine/integrate/events/contact_modes.c
  engine/integrate/events/contact_compliance.c engine/integrate/events/memory_modes.c
  engine/integrate/events/surface_contacts.c engine/integrate/events/variation.c
  engine/integrate/events/mode_tangent.c
  $(ls engine/base/*.c engine/model/*.c engine/forces/*.c)"
reader=$(find engine/scene parser/yaml parser/expression parser/language parser/read -name '*.c' | sort)

options='-std=c17 -D_POSIX_C_SOURCE=200809L -DSTRUT_VERSION="golden"
  -ffp-contract=off -fno-math-errno -Wno-psabi'

# build COMPILER: its hashes, one line for each level and method, to $scratch/COMPILER.
build() {
  mkdir -p "$scratch/reader-$1"
  for source in $reader; do
    # shellcheck disable=SC2086
    "$1" $options -O2 -I. $includes -c "$source" -o "$scratch/reader-$1/$(echo "$source" | tr / _).o"
  done
  for level in -O0 -O2 -O3 "-O3 -march=native"; do
    case $levels/$1/$level in
      all/* | */gcc/-O0 | */gcc/*native | */clang/-O2 | */clang/-O3) ;;
      *) continue ;;
    esac
    # shellcheck disable=SC2086
    "$1" $options $level -I. $includes $engine "$scratch/reader-$1"/*.o -o "$scratch/golden-$1" \
      $libraries -lm
    "$scratch/golden-$1" tests/golden/crawler.yaml 20000 >"$scratch/run-$1"
    sed "s/^/$1 $level: /" "$scratch/run-$1" >>"$scratch/$1"
  done
}

# The compilers side by side.
running=
for compiler in gcc clang; do
  command -v "$compiler" >/dev/null || { echo "skipped: no $compiler here"; continue; }
  build "$compiler" &
  running="$running $compiler:$!"
done
failed=0
for one in $running; do
  wait "${one#*:}" || { echo "${one%:*} does not build it, or it does not run"; failed=1; }
done
for one in $running; do cat "$scratch/${one%:*}" 2>/dev/null || :; done >"$scratch/all"
cat "$scratch/all"
wrong=$(grep ': rk4 ' "$scratch/all" | grep -vc ": rk4 $expected\$" || :)
[ "$wrong" = 0 ] || { echo "expected rk4 $expected"; failed=1; }
different=$(sed -n 's/.*: verlet-events //p' "$scratch/all" | sort -u | wc -l)
[ -z "$running" ] || [ "$different" = 1 ] || { echo "verlet-events: builds differ"; failed=1; }
exit "$failed"
