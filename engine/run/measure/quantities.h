/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Measured quantities of a run: evaluated over the pieces of the motion in the window, between their
 * ends too (dense.h), and reduced over it and over each of its periods (meter.h).
 *
 * The mean of a single velocity, or of the rate of a length, is displacement over time.
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
  double offset;      /* of the grid, see time_grid.h [s] */
  size_t count;       /* of marks */
  const double *time; /* (count) [s] */
} strut_marks;

/** Allocates for the quantities of the scene in the arena; NULL: out of memory. */
strut_quantities *strut_quantities_create(const strut_model *model,
                                          const strut_experiment *experiment, strut_arena *arena);
/** Does a quantity of the scene need works or losses, which only the ledger has? */
bool strut_quantities_need_ledger(const strut_experiment *experiment);
/** Does a quantity depend on the motion between steps? */
bool strut_quantities_need_pieces(const strut_quantities *quantities);
/** The method shows its pieces: from the next window on they are measured instead of the steps of the grid. */
void strut_quantities_observe(strut_quantities *quantities);
/** Samples the values before the first step of a window; the state is observed until its end. */
void strut_quantities_begin(strut_quantities *quantities, const strut_marks *marks,
                            strut_state *state);
/** Measures after each step of `length` [s] from then on, shorter where the run ends. Allocates nothing. */
void strut_quantities_step(strut_quantities *quantities, double length, strut_state *state);
/** Fills summary->measured from the marks passed so far. */
void strut_quantities_finish(strut_quantities *quantities, strut_summary *summary);

#endif
