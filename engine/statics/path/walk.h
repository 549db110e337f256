/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The walk along a path: what its steps share. For path.c, walk.c and events.c.
 */
#ifndef STRUT_ENGINE_STATICS_PATH_WALK_H
#define STRUT_ENGINE_STATICS_PATH_WALK_H

#include "engine/statics/path/events.h"
#include "engine/statics/path/path.h"

typedef struct strut_path_walk {
  strut_path_system system;
  strut_path *path;
  double *y, *next;               /* (2 n + 2) the present point, and the next */
  double *tangent, *next_tangent; /* (n + 1) there */
  double *trial, *spare, *upward; /* (2 n + 2) scratch; (0, ..., 0, 1) */
  double arc, step;
  int32_t negative; /* eigenvalues below zero, as the walk goes on from y */
  size_t point_room, event_room;
  bool failed; /* memory was out */
} strut_path_walk;

/** From y: what pulls and touches there, the tangent along which the load does work, a point. */
bool strut_path_walk_begin(strut_path_walk *walk);
/** One step, with all events on it; false: the path ends here, path->end says why. */
bool strut_path_walk_step(strut_path_walk *walk);

/** Switches this close to zero change together, in units of the structure's size. */
#define STRUT_PATH_EVEN 1e-9

/**
 * Throws the switch `which` at walk->y, and those that stand at zero there and are thrown with it,
 * and reports them and what the kink does to parameter and stability. `beyond` is where the old
 * stiffness would have led. The new tangent goes on into the side that they were thrown to. False:
 * there is none.
 */
bool strut_path_pass_kink(strut_path_walk *walk, int32_t which, const double *beyond);

/** Eigenvalues below zero at walk->y, into walk->negative. */
void strut_path_count_negative(strut_path_walk *walk);

/** Name of the path's parameter, as the subject of a sentence. */
const char *strut_path_subject(const strut_path_walk *walk);
/**
 * "can grow no further" where the parameter turns that went on by `turn` [ranges], or "grows again
 * from".
 */
const char *strut_path_turn(const strut_path_walk *walk, double turn);

/** Distance of two points of the path in y. */
double strut_path_distance(const strut_path_walk *walk, const double *a, const double *b);
/** Keeps walk->y; `negative` as the path goes on. */
void strut_path_add_point(strut_path_walk *walk, int32_t negative);
/** Keeps y, in the order of the path. `detail` is copied. */
void strut_path_add_event(strut_path_walk *walk, strut_path_event_kind kind, const double *y,
                          int32_t index, int32_t before, int32_t after, const char *detail);

#endif
