/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Strains and laws once more, in long double and by their definitions; gradients are differences. No code
 * is shared with the engine. Coordinates are (x1, y1, x2, y2, ...).
 */
#pragma once

#include "engine/scene/scene.h"
#include "tests/support/widening.h"

enum { SLOW_MOST = 32 }; /* nodes of a strain */

typedef enum slow_kind {
  SLOW_PATH,  /* sum of the distances from node to node */
  SLOW_ANGLE, /* at the second of three nodes, nearest to `near` */
  SLOW_AREA,  /* of a polygon, positive as `near` is */
  SLOW_REACH, /* distance of the first node from the segment between the others */
  SLOW_ALONG, /* how far the second node is ahead of the first in the direction `near` */
  SLOW_OFFSET /* distance of the first node from the line through the others, positive on its left */
} slow_kind;

typedef struct slow_strain {
  slow_kind kind;
  size_t count;
  int32_t node[SLOW_MOST];
  long double near;
  bool held; /* of a reach: the nearest point stays at `share` of the segment */
  long double share;
} slow_strain;

slow_strain slow_path_of(const strut_member *member);
long double slow_strain_value(const slow_strain *s, const long double *q);
/** b (2 count): derivatives along each node's x and y; a node that stands twice has all of it once. q is
    moved, and left as it was; it is no constant. */
void slow_strain_gradient(const slow_strain *s, const long double *q, long double *b);

/** A law by its words in the language, without memory; k: the element's stiffness. */
long double slow_law_force(const strut_law *law, long double k, long double e, long double e0);
