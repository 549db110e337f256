#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the scene of a Michell wheel of n sides and q layers; michell-wheel.yaml is that of 6 and
# 4.
#
#   sh michell-wheel.sh N Q [all|spokes|spirals]
#
# `all` members (the default); without the radial ones: `spokes`; only the two families of
# `spirals`. Node i of layer k lies at the radius a^k and the angle (2 i - k) 180/n degrees.
set -eu
sides=${1:?sides} layers=${2:?layers} which=${3:-all}
exec awk -v n="$sides" -v q="$layers" -v which="$which" '
function joint(i, k) { return "j" k "_" (i + n) % n }
function member(name, group, from, to) {
  printf "  %s: {group: %s, nodes: [%s, %s]}\n", name, group, from, to
}
BEGIN {
  print "strut: 1"
  print "name: Michell wheel of " n " sides and " q " layers"
  print "description: Many states of self-stress - size, and rank decisions with a wide gap"
  print "source: Geometry of tnsgrt (michell.py), its spirals crossing the radius at 45 degrees"
  print "parameters:"
  print "  sides: " n
  print "  ratio: sin(45 deg)/sin(45 deg + 180 deg/sides)  # of radii of neighbouring layers"
  print "groups:"
  print "  bar: {kind: bar, stiffness: 1000 N/m, mass: 0.1 kg}"
  print "nodes: # layer 0 is the rim"
  if (which != "spirals") print "  hub: [0, 0]"
  for (k = 0; k < q; k++)
    for (i = 0; i < n; i++)
      printf "  %s: [ratio^%d*cos(%d*180 deg/sides), ratio^%d*sin(%d*180 deg/sides)]\n",
        joint(i, k), k, 2 * i - k, k, 2 * i - k
  print "members:"
  for (k = 0; k + 1 < q; k++)
    for (i = 0; i < n; i++) {
      member("left" k "_" i, "bar", joint(i, k), joint(i, k + 1))
      member("right" k "_" i, "bar", joint(i, k), joint(i + 1, k + 1))
    }
  if (which == "all")
    for (k = 0; k + 2 < q; k++)
      for (i = 0; i < n; i++) member("radial" k "_" i, "bar", joint(i, k), joint(i + 1, k + 2))
  if (which != "spirals")
    for (i = 0; i < n; i++) {
      member("rim_" i, "bar", joint(i, 0), joint(i + 1, 0))
      member("ring_" i, "bar", joint(i, q - 1), joint(i + 1, q - 1))
      member("spoke_" i, "bar", "hub", joint(i, q - 1))
    }
}'
