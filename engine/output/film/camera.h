/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Where a film looks: at rest if all of the motion fits, else after the structure, smoothly.
 */
#ifndef STRUT_ENGINE_OUTPUT_FILM_CAMERA_H
#define STRUT_ENGINE_OUTPUT_FILM_CAMERA_H

#include "engine/output/draw/structure.h"

/** The middle of every frame of a film, and what must be seen around it. */
typedef struct strut_camera {
  size_t count;
  double (*middle)[2]; /* (count) [m] */
  double half[2];      /* half of the width and height that show all nodes in every frame [m] */
  bool follows[2];     /* in x, in y */
} strut_camera;

/**
 * From the bounds of the structure in every frame (count >= 1). `reach`: how many frames before and
 * after count for where it looks. The middles are in the arena; false when there is no memory.
 */
bool strut_camera_plan(strut_camera *camera, const strut_bounds *bounds, size_t count, size_t reach,
                       strut_arena *arena);

#endif
