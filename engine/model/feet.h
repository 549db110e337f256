/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Feet: circular arcs at ends of members, which roll on the ground instead of the node there.
 *
 * The contact of the node with each ground says with which stiffness, damping and friction. Its arc is an
 * element of the strain `foot` with a one-sided linear law, so that every method and statics know how it
 * presses; friction is a term of its own (engine/forces/feet.h).
 */
#ifndef STRUT_ENGINE_MODEL_FEET_H
#define STRUT_ENGINE_MODEL_FEET_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/scene/scene.h"

/** A foot on one ground. */
typedef struct strut_foot_entry {
  int32_t element, contact;
  double belt_speed; /* [m/s] */
  strut_friction friction;
} strut_foot_entry;

typedef struct strut_feet_table {
  int32_t count;
  const strut_foot_entry *item; /* (count) */
} strut_feet_table;

/** The foot at contact i of the scene, or -1. */
STRUT_API int32_t strut_foot_of_contact(const strut_scene *scene, size_t i);

#endif
