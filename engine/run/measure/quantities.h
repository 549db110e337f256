/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Measured quantities of a run: evaluated after each step of the window, reduced over it and over
 * each of its periods.
 *
 * Means are integrals by the trapezoidal rule over the steps, divided by the time; the mean of a
 * single velocity, or of the rate of a length, is displacement over time. Where a mark of the window
 * lies within a step, values there are interpolated linearly, positions by a cubic. Largest and
 * smallest values are those at the ends of steps, and where five of them in a row lie on a smooth
 * curve, the vertex of the parabola through the middle three.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_QUANTITIES_H
#define STRUT_ENGINE_RUN_MEASURE_QUANTITIES_H

#include "engine/model/state.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

typedef struct strut_quantities strut_quantities;

/** Marks that divide the window: see measure.h. */
typedef struct strut_marks {
  double step;        /* dt [s] */
  double length;      /* of the latest step, which is shorter where the run ends [s] */
  size_t count;       /* of marks */
  const double *time; /* (count) [s] */
} strut_marks;

/** Allocates for the quantities of the scene in the arena; NULL: out of memory. */
strut_quantities *strut_quantities_create(const strut_model *model,
                                          const strut_experiment *experiment, double step,
                                          strut_arena *arena);
/** Does a quantity of the scene need works or losses, which only the ledger has? */
bool strut_quantities_need_ledger(const strut_experiment *experiment);
/** Samples the values before the first step of a window. */
void strut_quantities_begin(strut_quantities *quantities, const strut_marks *marks,
                            strut_state *state);
/** Measures after each step from then on. Allocates nothing. */
void strut_quantities_step(strut_quantities *quantities, const strut_marks *marks,
                           strut_state *state);
/** Fills summary->measured from the marks passed so far. */
void strut_quantities_finish(strut_quantities *quantities, strut_summary *summary);

#endif
