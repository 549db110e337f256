/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The parts of a comparison: each fills its cells of one column.
 */
#ifndef STRUT_ENGINE_STUDY_COMPARE_COMPARE_PARTS_H
#define STRUT_ENGINE_STUDY_COMPARE_COMPARE_PARTS_H

#include "engine/statics/equilibria/equilibria.h"
#include "engine/study/compare/compare.h"

/** A column being filled. */
typedef struct strut_compare_work {
  const strut_compare_options *options;
  strut_compare_column *column;
  strut_arena *arena;    /* of the result */
  strut_rest_state rest; /* q is NULL if there is none */
} strut_compare_work;

void strut_compare_put(strut_compare_work *work, strut_compare_quantity quantity, double value);
/** Leaves rows first .. last empty for a reason (kept: a constant or a text of the arena). */
void strut_compare_leave(strut_compare_work *work, strut_compare_quantity first,
                         strut_compare_quantity last, const char *reason);
/**
 * The same after a failure; returns STRUT_OK unless memory is out or the user interrupts. `failed`:
 * the column reports an error, as this should have worked.
 */
strut_status strut_compare_leave_failed(strut_compare_work *work, strut_compare_quantity first,
                                        strut_compare_quantity last, const strut_error *error,
                                        strut_status status, bool failed);

/* Each returns STRUT_OK, STRUT_NO_MEMORY or STRUT_INTERRUPTED. */

/** Counts, mass, and what contacts and drive are like. */
strut_status strut_compare_structure(strut_compare_work *work, const strut_model *model);
/** Self-stress and mechanisms of the drawn shape; forces of the one in which it stands. */
strut_status strut_compare_rigidity(strut_compare_work *work, const strut_model *model);
/** Stable states with energies and barriers. */
strut_status strut_compare_states(strut_compare_work *work, const strut_model *model);
strut_status strut_compare_frequencies(strut_compare_work *work, const strut_model *model);
/** Stiffness of every node under a unit load in x and in y where it stands. */
strut_status strut_compare_stiffness(strut_compare_work *work, const strut_model *model);
/** Velocity, travel, energy, duty and cost; the scene's start has been resolved. */
strut_status strut_compare_motion(strut_compare_work *work, const strut_model *model);

#endif
