/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The law of the ground for single contacts: the text of scene/laws/ground.h for doubles.
 */
#ifndef STRUT_ENGINE_MODEL_CONTACT_LAW_H
#define STRUT_ENGINE_MODEL_CONTACT_LAW_H

#include "engine/model/model.h"
#include "engine/scene/laws/ground.h"

/** The numbers of a contact as the law takes them. */
static inline strut_law_ground_numbers strut_contact_numbers(const strut_contact_entry *e) {
  return (strut_law_ground_numbers){-e->stiffness, -e->damping, e->dissipation};
}

#endif
