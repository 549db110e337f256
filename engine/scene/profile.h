/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Profiles of the ground: polylines with the solid to the right of their direction.
 *
 * A concave corner, where the profile turns to the left, divides it: a node in that corner touches both
 * sides at once. The pieces between such corners bound convex solids, of which a node that is inside has
 * one nearest segment. The straight line beyond an end of a piece runs within the solid for a while, so that
 * a node deep in the corner still touches the piece.
 */
#ifndef STRUT_ENGINE_SCENE_PROFILE_H
#define STRUT_ENGINE_SCENE_PROFILE_H

#include "engine/scene/profile_index.h"

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

#endif
