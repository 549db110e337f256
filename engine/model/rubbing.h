/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Elements that rub: feet, circular arcs at ends of members, which roll on the ground instead of the node there,
 * nodes that the ground holds by bristles (LuGre), and collisions with friction.
 *
 * How they press is an element of a one-sided linear law, so that every method and statics know it; the contact
 * of the node with each ground says with which stiffness, damping and friction. Friction is a term of its own
 * (engine/forces/rubbing.h).
 */
#ifndef STRUT_ENGINE_MODEL_RUBBING_H
#define STRUT_ENGINE_MODEL_RUBBING_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/scene/scene.h"

/** A foot or a node on one ground, or one element of a collision. */
typedef struct strut_rubbing_entry {
  int32_t element, contact; /* contact: of a foot or a node; else -1 */
  int32_t
      bend; /* where in velocities the bend of bristles stands, see strut_feedback_table; -1: none */
  double belt_speed; /* [m/s] */
  strut_friction friction;
} strut_rubbing_entry;

typedef struct strut_rubbing_table {
  int32_t count, bristles;         /* bristles: entries that have them */
  const strut_rubbing_entry *item; /* (count) */
  const int32_t *of_element;       /* (elements) its entry, or -1 */
  const int32_t *of_contact;       /* (contacts) likewise */
} strut_rubbing_table;

/** The foot at contact i of the scene, or -1. */
STRUT_API int32_t strut_foot_of_contact(const strut_scene *scene, size_t i);
/** Does a foot or bristles make the contact an element? */
STRUT_API bool strut_contact_is_element(const strut_scene *scene, size_t i);
/** Contacts with bristles, whose bends are internal states. */
STRUT_API size_t strut_bristle_count(const strut_scene *scene);
/** Does some collision of the scene have friction? */
STRUT_API bool strut_collisions_rub(const strut_scene *scene);

#endif
