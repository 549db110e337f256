/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Random scenes that use everything a scene can have, and random motions of them.
 */
#pragma once

#include "engine/scene/scene.h"

/** Fills the scene; the same seed gives the same one. Free it with strut_scene_free. */
void random_scene(strut_scene *scene, uint64_t seed);

/** Positions about the drawn ones, velocities, and a time [s]; q and v: 2 * node_count each. */
void random_motion(const strut_scene *scene, uint64_t seed, double *t, double *q, double *v);
