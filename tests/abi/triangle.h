/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A falling, bouncing triangle: small, with a duration of its own; `duration` and what is recorded as texts. */
#pragma once

#define TRIANGLE(duration, channels)                                                               \
  "strut: 1\nname: triangle\nparameters: {drop: 20 mm}\ngravity: [0, -9.81]\n"                     \
  "nodes: {a: [0, drop], b: [100 mm, drop], c: {position: [50 mm, drop + 80 mm], mass: 10 g}}\n"   \
  "members:\n"                                                                                     \
  "  ab: {nodes: [a, b], kind: bar, stiffness: 100 kN/m, damping: 1 N s/m, mass: 30 g}\n"          \
  "  bc: {nodes: [b, c], kind: spring, stiffness: 1 kN/m, damping: 0.3 N s/m, mass: 10 g}\n"       \
  "  ca: {nodes: [c, a], kind: spring, stiffness: 1 kN/m, damping: 0.3 N s/m, mass: 10 g}\n"       \
  "ground: {stiffness: 20 kN/m, damping: 5 N s/m, nodes: all}\n"                                   \
  "solver: {integrator: rk4-events, step: 0.1 ms}\n"                                               \
  "run: {duration: " duration "}\noutput: {every: 1 ms" channels "}\n"
