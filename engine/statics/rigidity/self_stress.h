/* SPDX-License-Identifier: GPL-3.0-or-later */
/** States of self-stress in readable form: local and scaled; and which of them cables can bear. */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_SELF_STRESS_H
#define STRUT_ENGINE_STATICS_RIGIDITY_SELF_STRESS_H

#include "engine/statics/rigidity/null_spaces.h"

/**
 * A state is scaled so that its first cable carries 1, of those with a hundredth of the largest
 * force; without cables its first spring, else its first member. Cables pull where one sign does
 * it.
 */
typedef struct strut_self_stress {
  int32_t count;     /* s */
  double *force;     /* (count, members, then hinges) [1]; NULL: none or too many to list */
  bool *cables_pull; /* (count) no cable is pressed in it */
} strut_self_stress;

/**
 * Turns the null space into states that involve few members each, in the arena. STRUT_OK or
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_self_stress_sort(const strut_model *model,
                                              const strut_null_spaces *spaces, strut_arena *arena,
                                              strut_self_stress *states);

/** Requirements on a combination of states. */
typedef struct strut_stress_wish {
  bool cables;         /* all cables that any state loads must pull */
  int32_t motions;     /* it must be positive definite on this many motions; 0: no requirement */
  const double *forms; /* (count of states, motions, motions) their forms on them */
  const double *scale; /* (count of states) their largest force densities: what forms compare to */
} strut_stress_wish;

/**
 * Searches for a combination (members) that meets the requirements, by the perceptron rule, which
 * finds one if one with some margin exists; *found: it did. Scaled to a largest force of 1.
 */
STRUT_API strut_status strut_self_stress_combine(const strut_model *model,
                                                 const strut_self_stress *states,
                                                 const strut_stress_wish *wish, double *force,
                                                 bool *found);

/**
 * Finds a combination (members) that pulls all cables that any state loads, by a linear programme:
 * the least sum of cable forces with each at least 1, then scaled to a largest force of 1. *found
 * false: none exists.
 */
STRUT_API strut_status strut_self_stress_pull_cables(const strut_model *model,
                                                     const strut_self_stress *states, double *force,
                                                     bool *found);

#endif
