/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Surfaces of grounds: profiles and their convex pieces, where lines cross them, and their outlines.
 */
#pragma once

#include "engine/base/vec.h"
#include "engine/scene/scene.h"

/* ---- crossings with a line ---- */

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
double strut_stretches_meet(const strut_stretch *first, const strut_stretch *second);

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

/* ---- faults and pieces ---- */

typedef enum strut_profile_fault {
  STRUT_PROFILE_FINE,
  STRUT_PROFILE_SHORT,   /* fewer than two points */
  STRUT_PROFILE_POINT,   /* not finite */
  STRUT_PROFILE_ZERO,    /* a segment without length */
  STRUT_PROFILE_BACK,    /* a segment turns back onto the one before */
  STRUT_PROFILE_CROSSES, /* a segment, or the line beyond an end, meets another */
  STRUT_PROFILE_NO_MEMORY
} strut_profile_fault;

/** The first fault of a profile; *segment, *other: from 0, those that have it. */
STRUT_API strut_profile_fault strut_profile_check(const strut_ground *ground, size_t *segment,
                                                  size_t *other);
/** Number of convex pieces of a ground: 1, unless it is a profile with concave corners. */
STRUT_API size_t strut_ground_pieces(const strut_ground *ground);
/** The last point of the piece of a profile whose first point is `first`: where the next one begins. */
STRUT_API size_t strut_profile_piece_end(const strut_ground *ground, size_t first);
/**
 * How far the straight line beyond an end of a piece belongs to it [m]: half of its way to where it leaves
 * the solid; INFINITY where it does not. `forward`: beyond the end at point `at`, otherwise before it.
 */
STRUT_API double strut_profile_reach(const strut_profile_index *index, size_t at, bool forward);

/** How deep a point is inside the solid of a ground [m]; negative outside. */
STRUT_API double strut_ground_depth(const strut_ground *ground, const double point[2]);

/* ---- outlines to draw ---- */

/** Most points of the outline of a ground of `grounds`. */
STRUT_API size_t strut_outline_most(const strut_ground *ground);
/**
 * Points of the surface of one of a scene's grounds, the solid to the right of their direction; ends of
 * lines and profiles reach beyond `far` [m] from `middle`. Shifted by `place` [m], or by nothing if that is
 * NULL. Fills at most strut_outline_most points and returns their number.
 */
STRUT_API size_t strut_outline_of(const strut_ground *ground, const double *place,
                                  const double middle[2], double far, double (*points)[2]);
/** Displacement of a ground at time t [s]. */
STRUT_API void strut_ground_place(const strut_scene *scene, size_t ground, double t,
                                  double place[2]);
