/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The walk along a path: what its steps share. For path.c and path_walk.c.
 */
#ifndef STRUT_ENGINE_STATICS_PATH_WALK_H
#define STRUT_ENGINE_STATICS_PATH_WALK_H

#include "engine/statics/path/path.h"
#include "engine/statics/path/events.h"

typedef struct strut_path_walk {
  strut_path_system system;
  strut_path *path;
  double *y, *tangent;            /* (n + 1) where it stands */
  double *next, *next_tangent;    /* where the step leads */
  double *trial, *spare, *upward; /* scratch; (0, ..., 0, 1) */
  double arc, step;
  int32_t negative; /* eigenvalues below zero, as the walk goes on from y */
  size_t point_room, event_room;
  bool failed; /* memory was out */
} strut_path_walk;

/** From y: what pulls and touches there, the tangent along which the load does work, a point. */
bool strut_path_walk_begin(strut_path_walk *walk);
/** One step, with all events on it; false: the path ends here, path->end says why. */
bool strut_path_walk_step(strut_path_walk *walk);

#endif
