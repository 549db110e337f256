/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The scene as statics sees it: nothing moves by itself, the ground is level, and static supports
 * may take the ground's place, as in (12): contact nodes held in turn.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_SUPPORTS_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_SUPPORTS_H

#include "engine/scene/experiment.h"
#include "engine/scene/scene.h"

typedef struct strut_level_frame {
  strut_scene scene;   /* without actuators, loads on a signal, friction and belt; in coordinates
                          along and across the ground. Shares texts with the original */
  double cosine, sine; /* of the slope that was turned away: 1, 0 on level ground */
  int32_t
      oblique_node; /* node held in one direction only on a slope, or -1; then nothing is turned */
  strut_arena arena;
} strut_level_frame;

/** The original must outlive it; strut_level_frame_free. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_level_frame_create(const strut_scene *original, strut_level_frame *level,
                                      strut_error *error);
void strut_level_frame_free(strut_level_frame *level);

/** Turns count vectors (x, y) between level and original coordinates, in place. */
void strut_level_frame_to_original(const strut_level_frame *level, size_t count, double *xy);
void strut_level_frame_from_original(const strut_level_frame *level, size_t count, double *xy);

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
strut_status strut_supports_choose(const strut_scene *level, const strut_search *search,
                                   const strut_node_set *wanted, strut_arena *arena,
                                   strut_supports *supports, strut_error *error);

/** Sets held (2 node_count and more) to 1 where a set holds a coordinate, else leaves it. */
void strut_supports_hold(const strut_supports *supports, const strut_node_set *set, uint8_t *held);

/**
 * Places a shape (node_count) on a set: the first node on the ground line at the x it is drawn at,
 * the second on the line, by a rigid motion where the scene allows one, else node by node.
 */
void strut_supports_place(const strut_supports *supports, const strut_scene *level,
                          const strut_node_set *set, double (*shape)[2]);

#endif
