#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# How reading and the commands for structures at rest grow: X-frame chains and nets of 1e2 to 1e5 members
# that hang under their weight. Prints, for each command, seconds of CPU, how many times those of the size
# before, and the largest memory. `check` reads, compiles, and finds the largest stable steps.
#
#   sh tests/bench/statics.sh STRUT [MEMBERS...]
#
# Needs GNU time. One thread, so that seconds of CPU are those of a quiet machine's clock.
set -eu
strut=$1
shift
[ $# -gt 0 ] || set -- 100 1000 10000 100000
[ -x /usr/bin/time ] || { echo "statics.sh: install GNU time (Debian: time)" >&2; exit 1; }
here=$(dirname "$0")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

printf '%-9s %-10s %11s %8s %8s %8s\n' structure command members 'CPU [s]' growth MB
for structure in xchain xgrid; do
  for members; do sh "$here/$structure.sh" "$members" >"$scratch/$members.yaml"; done
  for command in check equilibria rigidity modes; do
    before=
    for members; do
      /usr/bin/time -o "$scratch/time" -f '%U %S %M' \
        "$strut" "$command" "$scratch/$members.yaml" >"$scratch/out" 2>&1 ||
        { cat "$scratch/out"; exit 1; }
      read -r user system memory <"$scratch/time"
      seconds=$(awk -v a="$user" -v b="$system" 'BEGIN { printf "%.2f", a + b }')
      awk -v structure="${structure#x}" -v command="$command" -v members="$members" \
        -v seconds="$seconds" -v before="$before" -v memory="$memory" 'BEGIN {
        growth = before > 0 ? sprintf("%.1f", seconds / before) : "-"
        printf "%-9s %-10s %11d %8.2f %8s %8.0f\n", structure, command, members, seconds, growth,
          memory / 1024
      }'
      before=$seconds
    done
  done
done
