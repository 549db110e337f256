/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Scenes without any jump, on which RK4 must show its order.
 */
#pragma once

#include "engine/scene/scene.h"

typedef struct smooth_scene {
  const char *name;
  void (*make)(strut_scene *scene); /* of an uninitialised scene */
  double step;                      /* the coarsest that still shows the order [s] */
  double duration;                  /* [s] */
} smooth_scene;

enum { SMOOTH_SCENES = 6 };
extern const smooth_scene smooth_scenes[SMOOTH_SCENES];
