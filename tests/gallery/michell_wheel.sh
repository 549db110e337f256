#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Michell wheels of several sizes, as models/gallery/michell-wheel.sh prints them: members, rank,
# states of self-stress, mechanisms (three rigid-body motions among them).
#
#   sh tests/gallery/michell_wheel.sh ROOT STRUT
set -eu
gallery=$(cd "$1" && pwd)/models/gallery
strut=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

sh "$gallery/michell-wheel.sh" 6 4 >"$scratch/wheel.yaml"
sed '/^#/d' "$gallery/michell-wheel.yaml" | cmp -s - "$scratch/wheel.yaml" ||
  fail "michell-wheel.yaml is not what michell-wheel.sh 6 4 prints"

while read -r sides layers which expected; do
  sh "$gallery/michell-wheel.sh" "$sides" "$layers" "$which" >"$scratch/wheel.yaml"
  got=$("$strut" rigidity "$scratch/wheel.yaml" --json |
    jq -r '"\(.members) \(.rank) \(.self_stress.count) \(.mechanisms.count)"') || got="no answer"
  [ "$got" = "$expected" ] || fail "$sides $layers $which: got $got, expected $expected"
done <<'END'
6 4 all 66 47 19 3
6 4 spokes 54 47 7 3
6 4 spirals 36 36 0 12
6 3 all 48 35 13 3
6 3 spokes 42 35 7 3
6 3 spirals 24 24 0 12
4 3 all 32 23 9 3
4 3 spokes 28 23 5 3
4 3 spirals 16 16 0 8
12 4 all 132 95 37 3
12 4 spokes 108 95 13 3
12 4 spirals 72 72 0 24
END
exit "$((failures > 0))"
