#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A scene to measure growth with: a cantilever of N members, X-frames of side 1 m in a row, five
# members each: two cables along, one cable across, two bars as diagonals, prestressed. Prints YAML.
#
#   sh tests/bench/xchain.sh N [down|across] >chain.yaml
#
# down (the default): the chain hangs from its first side, and stretches by less than a thousandth.
# across: it reaches out to the right under as little gravity as lets it sag by a thousandth. Its
# softest stiffness falls with the fourth power of the length: a hard case of conditioning.
set -eu
members=${1:?"usage: xchain.sh MEMBERS [down|across]"}
way=${2:-down}
case $members in *[!0-9]*) echo "xchain.sh: '$members' is not a number" >&2; exit 1 ;; esac
case $way in down | across) ;; *) echo "xchain.sh: down or across, not '$way'" >&2; exit 1 ;; esac
[ "$members" -ge 5 ] || { echo "xchain.sh: a frame has five members" >&2; exit 1; }

awk -v members="$members" -v way="$way" 'BEGIN {
  cells = int(members / 5)
  stiffness = 1e7; density = 1e4; mass = 0.11 # per frame
  # Bending stiffness of two chords, and the load that bends them by a thousandth of the length.
  gravity = way == "down" ? 9.81 : 0.008 * (stiffness / 2) / (mass * cells ^ 3)
  printf "# %d members: tests/bench/xchain.sh %d %s\n", 5 * cells, members, way
  printf "strut: 1\nname: X-frame chain of %d members, %s\n\n", 5 * cells, way
  printf "groups:\n"
  printf "  along: {kind: cable, stiffness: %g, mass: 0.01, force_density: %g}\n", stiffness, density
  printf "  across: {kind: cable, stiffness: %g, mass: 0.01, force_density: %g}\n", stiffness,
    2 * density
  printf "  diagonal: {kind: bar, stiffness: %g, mass: 0.04, force_density: %g}\n", stiffness, -density
  printf "\nnodes:\n"
  for (i = 0; i <= cells; i++)
    for (side = 0; side < 2; side++) {
      name = (side ? "b" : "a") i
      place = way == "down" ? sprintf("[%d, %d]", side, -i) : sprintf("[%d, %d]", i, side)
      if (i == 0) printf "  %s: {position: %s, fixed: both}\n", name, place
      else printf "  %s: %s\n", name, place
    }
  printf "\nmembers:\n"
  for (i = 1; i <= cells; i++) {
    j = i - 1
    printf "  ta%d: {group: along, nodes: [a%d, a%d]}\n", i, j, i
    printf "  tb%d: {group: along, nodes: [b%d, b%d]}\n", i, j, i
    if (i < cells) printf "  r%d: {group: across, nodes: [a%d, b%d]}\n", i, i, i
    else printf "  r%d: {group: across, nodes: [a%d, b%d], force_density: %g}\n", i, i, i, density
    printf "  u%d: {group: diagonal, nodes: [a%d, b%d]}\n", i, j, i
    printf "  d%d: {group: diagonal, nodes: [b%d, a%d]}\n", i, j, i
  }
  printf "\ngravity: [0, -%.17g]\n", gravity
}'
