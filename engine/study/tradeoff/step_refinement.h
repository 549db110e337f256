/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Ladders: the settings of one method from coarse to fine, run and timed one after the other.
 */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_STEP_REFINEMENT_H
#define STRUT_ENGINE_STUDY_TRADEOFF_STEP_REFINEMENT_H

#include "engine/study/tradeoff/tradeoff_parts.h"

enum { STUDY_MOST_LADDERS = 64 };

/* Settings that differ by their step alone. */
typedef struct study_ladder {
  int fidelity, group;
  study_setting first; /* its step is the method's limit */
  bool limited;        /* there is one */
  double last_cost;    /* CPU time of the latest row [s]; 0: none yet */
  bool over;           /* the budget does not suffice for the next */
} study_ladder;

typedef struct study_ladders {
  study_ladder at[STUDY_MOST_LADDERS];
  size_t count;
} study_ladders;

/** One run at the first point, its values thrown into s->scratch. */
strut_status strut_study_probe(const study *s, int fidelity, study_setting setting,
                               study_outcome *outcome);
/**
 * Runs a setting at every point as a new row, with its cost; `base` where costs are relative to it.
 * Where its method cannot, there is no row.
 */
strut_status strut_study_run_row(study *s, study_ladder *from, study_setting setting, bool base,
                                 bool *cannot);
/** Adds one ladder for each way in which a method can refine that makes a difference here. */
strut_status strut_study_add_method(study *s, study_ladders *all, int fidelity,
                                    const strut_integrator *method);
/**
 * Runs all ladders side by side from coarse to fine, as far as the share of the budget goes; the
 * progress goes between two fractions.
 */
strut_status strut_study_climb(study *s, study_ladders *all, double share, double from, double to);

#endif
