/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What taking a trajectory and reading one share.
 */
#ifndef STRUT_ENGINE_OUTPUT_TRAJECTORY_PARTS_H
#define STRUT_ENGINE_OUTPUT_TRAJECTORY_PARTS_H

#include <stdbool.h>

#include "engine/output/trajectory.h"

enum { STRUT_TRAJECTORY_ARRAYS = 7 };

/** One array of a trajectory: `size` doubles of each frame. */
typedef struct strut_trajectory_array {
  double **values;
  size_t size, offset; /* in a recorded row */
} strut_trajectory_array;

/** Where a channel's array is. */
double **strut_trajectory_array_of(strut_trajectory *trajectory, strut_channel id);
/** Fills contact_node. False when memory is out. */
bool strut_trajectory_contacts(strut_trajectory *trajectory, const strut_scene *scene);

#endif
