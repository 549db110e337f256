/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The structures that several tests look at.
 */
#pragma once

#include "tests/support/motion.h"

/** Snelson's X-frame: a square with four cables as sides and two bars as diagonals. */
typedef struct x_frame {
  double side;          /* [m] */
  double force_density; /* of the cables [N/m]; the bars' is the opposite */
  struct {
    double stiffness, damping, mass; /* [N/m], [N s/m], [kg] */
  } cable, bar;
} x_frame;

/** Stands free and square about the origin; nodes 0 to 3 anticlockwise from lower left. */
void structure_x_frame(strut_scene *scene, const x_frame *frame);

/** All nodes get the velocity of a rigid body: at the origin (x, y) [m/s], spin [rad/s]. */
void structure_throw(strut_scene *scene, double x, double y, double spin);

/**
 * The paper's crawler in state I, or in state II: its mirror image in x, in which nodes 1 and 2
 * change names; member 8 (index 7) is driven by amplitude [m] and frequency [Hz] (signal 0).
 */
void structure_crawler(strut_scene *scene, double frequency, double amplitude, double mu,
                       bool state_two);

/**
 * `frames` X-frames in a row, 5 members each, held at the left end: masses in the bars only, so a
 * consistent mass needs the sparse factor as soon as there are more than 8 nodes.
 */
void structure_chain(strut_scene *scene, size_t frames, strut_mass_model mass_model);

/**
 * X-frames side by side and on top of each other, the lowest nodes at a height of y [m]: columns times
 * rows nodes, column by column, bars of 0.1 kg as diagonals, cables along and up; damped as said
 * [N s/m]. Under gravity, free, and every node may touch the ground at 0, with friction mu, or with
 * none where mu is 0.
 */
void structure_grid(strut_scene *scene, int32_t columns, int32_t rows, strut_mass_model mass_model,
                    double y, double damping, double mu);

/**
 * Rods that hang from a pin at the origin, each a bar of 1 m and 1 kg: the first at angle a [rad]
 * from below, a second one at angle b if `second`.
 */
void structure_pendulum(strut_scene *scene, double stiffness, double a, bool second, double b);
