/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A tree of bounds over the segments of a profile, so that questions about all of them look at few.
 *
 * The tree covers the finite segments; the lines beyond the ends of a profile have no bounds, and callers
 * look at the first and the last segment one by one.
 */
#ifndef STRUT_ENGINE_SCENE_PROFILE_INDEX_H
#define STRUT_ENGINE_SCENE_PROFILE_INDEX_H

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/scene/scene.h"

/** A part of a straight line, from low to high times `along`. */
typedef struct strut_stretch {
  const double *from;
  strut_vec2 along;
  double low, high;
} strut_stretch;

/** Bounds of consecutive segments: an octagon, and the range of their directions. */
typedef struct strut_profile_bounds {
  double low[4], high[4]; /* of x, y, x + y, x - y [m] */
  double least, most;     /* angles turned along the profile [rad] */
} strut_profile_bounds;

typedef struct strut_profile_index {
  const strut_ground *ground;
  size_t segments;
  const strut_profile_bounds *node; /* a binary tree, the children of k at 2 k + 1 and 2 k + 2 */
} strut_profile_index;

/** Angles below this are those of one straight line [rad]. */
#define STRUT_PROFILE_STRAIGHT 1e-12

/** Segment k of a profile, with the line beyond its ends. */
strut_stretch strut_profile_stretch(const strut_ground *ground, size_t k);
/** Where a meets b, in lengths of a; NAN: nowhere. */
double strut_stretches_meet(const strut_stretch *a, const strut_stretch *b);

/** Do all segments advance along one direction, so that no two of them can meet? */
bool strut_profile_is_monotone(const strut_ground *ground);
/** Bounds of a valid profile but for crossings, in the arena; false: out of memory. */
bool strut_profile_index_create(strut_arena *arena, const strut_ground *ground,
                                strut_profile_index *index);
/** The first segment that meets one before it, other than its neighbour, and the first of those. */
bool strut_profile_find_crossing(const strut_profile_index *index, size_t *segment, size_t *other);
/** Where a ray from point `at` first meets another segment than the two there [lengths of ray->along];
    INFINITY: nowhere. */
double strut_profile_cast_ray(const strut_profile_index *index, const strut_stretch *ray,
                              size_t at);

#endif
