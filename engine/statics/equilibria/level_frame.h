/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The scene as statics sees it: nothing moves by itself, and the ground is level.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_LEVEL_FRAME_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_LEVEL_FRAME_H

#include "engine/scene/scene.h"

typedef struct strut_level_frame {
  strut_scene scene;   /* without actuators, loads on a signal, friction and belt; in coordinates
                          along and across the ground. Shares texts with the original */
  double cosine, sine; /* of the slope that was turned away: 1, 0 on level ground */
  int32_t askew;       /* a node held in one direction only on a slope: nothing was turned; or -1 */
  strut_arena arena;
} strut_level_frame;

/** The original must outlive it; strut_level_frame_free. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_level_frame_create(const strut_scene *original, strut_level_frame *flat,
                                      strut_error *error);
void strut_level_frame_free(strut_level_frame *flat);

/** Turns count vectors (x, y) between the flat scene's and the original's coordinates, in place. */
void strut_level_frame_to_original(const strut_level_frame *flat, size_t count, double *xy);
void strut_level_frame_from_original(const strut_level_frame *flat, size_t count, double *xy);

#endif
