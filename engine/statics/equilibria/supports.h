/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Static supports in place of the ground, as in (12): which contact nodes are held in turn, and
 * how.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_SUPPORTS_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_SUPPORTS_H

#include "engine/scene/experiment.h"

/** More sets than this are not tried unless the scene names them. */
enum { STRUT_MOST_SUPPORTS = 120 };

typedef struct strut_supports {
  size_t count;         /* 0: the real ground alone */
  strut_node_set *sets; /* (count) */
  bool pin;             /* the first of each set is held along the ground too, the others roll */
  bool loose;           /* the scene itself holds no coordinate: shapes may be turned and moved */
  bool many;            /* there would be more sets than STRUT_MOST_SUPPORTS */
} strut_supports;

/**
 * The sets for a scene on level ground: `wanted`, else those the scene names, else every set of as
 * many contact nodes as it takes to hold the rigid motions that the scene leaves free: pairs where
 * it holds nothing, single nodes where one motion is left, none where its own supports suffice.
 * Arrays in the arena. STRUT_OK, STRUT_NO_MEMORY, or STRUT_USAGE for a wanted node that cannot
 * touch.
 */
strut_status strut_supports_choose(const strut_scene *flat, const strut_search *search,
                                   const strut_node_set *wanted, strut_arena *arena,
                                   strut_supports *supports, strut_error *error);

/** Sets held (2 node_count and more) to 1 where a set holds a coordinate, else leaves it. */
void strut_supports_hold(const strut_supports *supports, const strut_node_set *set, uint8_t *held);

/**
 * Places a shape (node_count) on a set: the first node on the ground line at the x it is drawn at,
 * the second on the line, by a rigid motion where the scene allows one, else node by node.
 */
void strut_supports_place(const strut_supports *supports, const strut_scene *flat,
                          const strut_node_set *set, double (*shape)[2]);

#endif
