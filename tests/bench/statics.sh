#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# How the commands for structures at rest grow: X-frame chains of 1e2 to 1e5 members that hang under
# their weight. Prints seconds and, where GNU time is installed, the largest memory of each command.
#
#   sh tests/bench/statics.sh STRUT [MEMBERS...]
set -eu
strut=$1
shift
[ $# -gt 0 ] || set -- 100 1000 10000 100000
here=$(dirname "$0")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# seconds COMMAND...: wall time, and memory if it can be had.
seconds() {
  if [ -x /usr/bin/time ]; then
    /usr/bin/time -o "$scratch/time" -f '%e s %M kB' "$@" >"$scratch/out" 2>&1 || return 1
    cat "$scratch/time"
  else
    begin=$(date +%s%N)
    "$@" >"$scratch/out" 2>&1 || return 1
    echo "$((($(date +%s%N) - begin) / 1000000)) ms"
  fi
}

for members; do
  sh "$here/xchain.sh" "$members" >"$scratch/chain.yaml"
  for command in equilibria rigidity modes; do
    taken=$(seconds "$strut" "$command" "$scratch/chain.yaml") ||
      { cat "$scratch/out"; exit 1; }
    echo "$members members: $command $taken"
  done
done
