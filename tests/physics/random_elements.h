/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Random scenes of elements: running cables, hinges, members with every law, and stops.
 */
#pragma once

#include "engine/scene/scene.h"

/** A valid law of that kind for strains of about `size` and forces of about `force`. */
strut_law random_law(strut_scene *scene, strut_law_kind kind, double size, double force,
                     uint64_t *r);

/**
 * A ring of five to seven nodes of 1 m about the origin, the first held, with plain springs along it and
 * elements across: a running cable, springs of random laws, some with stops, and hinges. All is damped by
 * `damping` times its usual value. Free it with strut_scene_free.
 */
void random_elements(strut_scene *scene, uint64_t seed, double damping);
