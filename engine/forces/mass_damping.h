/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Rayleigh's damping by mass, alpha M v; its part by stiffness is in the dampers of members and hinges. */
#ifndef STRUT_ENGINE_FORCES_MASS_DAMPING_H
#define STRUT_ENGINE_FORCES_MASS_DAMPING_H

#include "engine/model/algebra/sparse.h"
#include "engine/model/state.h"

/** Subtracts alpha M v from state->latest->force and accumulates what that takes as lost in members. */
void strut_mass_damping_apply(const strut_model *model, const strut_state *state,
                              const double *velocity);

/** Contributions of strut_mass_damping_add at most. */
static inline size_t strut_mass_damping_entries(const strut_model *model) {
  bool damped = model->terms & STRUT_TERM_MASS_DAMPING;
  return damped ? 2 * ((size_t)model->node_count + 3 * (size_t)model->members.count +
                       3 * (size_t)model->sliding.count)
                : 0;
}
/** Adds alpha M at the rows of free coordinates: row_of (length), -1 of the others. */
void strut_mass_damping_add(const strut_model *model, const int32_t *row_of, strut_triplets *sum);

#endif
