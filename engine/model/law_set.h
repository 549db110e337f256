/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Sets of laws and strains: those that a model has, and those that a kernel computes.
 *
 * A kernel with formulas of its own lists what it computes. A model is given to it only where the list has
 * everything that the model has, so a law that is added to a table is computed by the kernels that loop
 * over the table, until it is added to the lists of the others, too.
 */
#ifndef STRUT_ENGINE_MODEL_LAW_SET_H
#define STRUT_ENGINE_MODEL_LAW_SET_H

#include <stdbool.h>
#include <stdint.h>

#include "engine/model/elements.h"

/** Bit k of each: the k-th of the enum. */
typedef struct strut_law_set {
  uint32_t friction; /* strut_friction_law */
  uint32_t damping;  /* strut_ground_damping */
  uint32_t law;      /* strut_law_kind, of elements */
  uint32_t strain;   /* strut_strain_kind, of elements */
} strut_law_set;

/** For lists: STRUT_HAS(STRUT_FRICTION, NONE) | ... */
#define STRUT_HAS(prefix, NAME) (UINT32_C(1) << prefix##_##NAME)
/** Of kernels that loop over the table. */
#define STRUT_HAS_ALL UINT32_MAX

/** What `has` has and `known` lacks. */
static inline strut_law_set strut_laws_beyond(strut_law_set has, strut_law_set known) {
  has.friction &= ~known.friction, has.damping &= ~known.damping;
  has.law &= ~known.law, has.strain &= ~known.strain;
  return has;
}

/** Does `known` have everything that `has` has? */
static inline bool strut_laws_within(strut_law_set has, strut_law_set known) {
  strut_law_set more = strut_laws_beyond(has, known);
  return !(more.friction | more.damping | more.law | more.strain);
}

#endif
