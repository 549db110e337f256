/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * States of self-stress that people can read: local, scaled, and which of them cables can bear.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_SELF_STRESS_H
#define STRUT_ENGINE_STATICS_RIGIDITY_SELF_STRESS_H

#include "engine/statics/rigidity/null_spaces.h"

/**
 * A state is scaled so that its first cable carries 1, of those with a hundredth of the largest
 * force; without cables its first spring, else its first member. Cables pull where one sign does it.
 */
typedef struct strut_self_stress {
  int32_t count;     /* s */
  double *force;     /* (count, members) [1]; NULL: none or too many to list */
  bool *cables_pull; /* (count) no cable is pressed in it */
} strut_self_stress;

/**
 * Turns the null space into states that involve few members each, in the arena. STRUT_OK or
 * STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_self_stress_sort(const strut_model *model,
                                              const strut_null_spaces *spaces, strut_arena *arena,
                                              strut_self_stress *states);

/** What a combination of states is wanted to do. */
typedef struct strut_stress_wish {
  bool cables;         /* pull all cables that any state loads */
  int32_t motions;     /* and be positive definite on so many motions, 0: not asked */
  const double *forms; /* (count of states, motions, motions) their forms on them */
  const double *scale; /* (count of states) their largest force densities: what forms compare to */
} strut_stress_wish;

/**
 * Looks for a combination (members) that fulfils the wish, by the perceptron's rule: it finds one
 * wherever there is one with some margin; *found says whether it did. Largest force 1.
 */
STRUT_API strut_status strut_self_stress_combine(const strut_model *model,
                                                 const strut_self_stress *states,
                                                 const strut_stress_wish *wish, double *force,
                                                 bool *found);

/**
 * Looks for a combination (members) that pulls all cables that any state loads, by a linear
 * programme: the one with the least sum of cable forces where each has at least 1, then scaled to a largest
 * force of 1. Not *found means that there is none.
 */
STRUT_API strut_status strut_self_stress_pull_cables(const strut_model *model,
                                                     const strut_self_stress *states, double *force,
                                                     bool *found);

#endif
