#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A scene to measure growth with: a square net of X-frames of side 1 m with about N members, four per
# frame, prestressed, that hangs from its upper side. Prints YAML.
#
#   sh tests/bench/xgrid.sh N >grid.yaml
set -eu
members=${1:?"usage: xgrid.sh MEMBERS"}
case $members in *[!0-9]*) echo "xgrid.sh: '$members' is not a number" >&2; exit 1 ;; esac
[ "$members" -ge 6 ] || { echo "xgrid.sh: a frame has six members" >&2; exit 1; }

awk -v members="$members" 'BEGIN {
  side = int((sqrt(1 + 4 * members) - 1) / 4 + 0.5) # 4 side^2 + 2 side members
  if (side < 1) side = 1
  stiffness = 1e7; density = 1e4
  printf "# %d members: tests/bench/xgrid.sh %d\n", 4 * side * side + 2 * side, members
  printf "strut: 1\nname: X-frame net of %d by %d\n\n", side, side
  printf "groups:\n"
  printf "  inner: {kind: cable, stiffness: %g, mass: 0.01, force_density: %g}\n", stiffness,
    2 * density
  printf "  outer: {kind: cable, stiffness: %g, mass: 0.01, force_density: %g}\n", stiffness, density
  printf "  diagonal: {kind: bar, stiffness: %g, mass: 0.04, force_density: %g}\n", stiffness, -density
  printf "\nnodes:\n"
  for (j = 0; j <= side; j++)
    for (i = 0; i <= side; i++)
      if (j == 0) printf "  n%d_%d: {position: [%d, 0], fixed: both}\n", i, j, i
      else printf "  n%d_%d: [%d, %d]\n", i, j, i, -j
  printf "\nmembers:\n"
  for (j = 0; j <= side; j++)
    for (i = 0; i <= side; i++) {
      if (i < side)
        printf "  h%d_%d: {group: %s, nodes: [n%d_%d, n%d_%d]}\n", i, j,
          j == 0 || j == side ? "outer" : "inner", i, j, i + 1, j
      if (j < side)
        printf "  v%d_%d: {group: %s, nodes: [n%d_%d, n%d_%d]}\n", i, j,
          i == 0 || i == side ? "outer" : "inner", i, j, i, j + 1
      if (i < side && j < side) {
        printf "  u%d_%d: {group: diagonal, nodes: [n%d_%d, n%d_%d]}\n", i, j, i, j, i + 1, j + 1
        printf "  d%d_%d: {group: diagonal, nodes: [n%d_%d, n%d_%d]}\n", i, j, i + 1, j, i, j + 1
      }
    }
  printf "\ngravity: [0, -9.81]\n"
}'
