#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# How reading, statics and 100 steps of rk4 grow: X-frame chains and nets of about 1e2 to 1e5 members that hang under
# their weight. Prints, for each command, seconds of CPU, how many times those of the size before, and the largest
# memory. `check` reads, compiles, and finds the largest stable steps.
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
for structure in chain net; do
  for command in check run equilibria rigidity modes; do
    before=0
    for members; do
      case $structure in chain) size=cells=$members/5 ;; *) size=side=$(awk "BEGIN { print int(sqrt($members) / 2) }") ;; esac
      /usr/bin/time -o "$scratch/time" -f '%U %S %M' "$strut" "$command" "$here/$structure.yaml" --set "$size" \
        >"$scratch/out" 2>&1 || { cat "$scratch/out"; exit 1; }
      awk -v row="$structure $command $members" -v before="$before" '{
        split(row, word, " ")
        growth = before > 0 ? sprintf("%.1f", ($1 + $2) / before) : "-"
        printf "%-9s %-10s %11d %8.2f %8s %8.0f\n", word[1], word[2], word[3], $1 + $2, growth, $3 / 1024
      }' "$scratch/time"
      before=$(awk '{ print $1 + $2 }' "$scratch/time")
    done
  done
done
