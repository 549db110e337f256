/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The surface of a ground as points to draw. */
#ifndef STRUT_ENGINE_SCENE_OUTLINE_H
#define STRUT_ENGINE_SCENE_OUTLINE_H

#include "engine/scene/scene.h"

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

#endif
