/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Many runs on one core: those that are alike side by side in the lanes of a batch.
 *
 * A last step that is shorter than the others is taken alone, out of the lanes.
 *
 * Every summary, row of a recording and failure is what strut_simulate would give, bit for bit (a NAN's
 * sign aside). Runs that no lane can take are run alone in between: other methods than rk4 and
 * verlet-events, another topology than the batch's, bars that are rigid, other laws of the ground than
 * the printed ones, mass groups too large for a dense inverse; with events also cables and slopes.
 */
#ifndef STRUT_ENGINE_RUN_SIMULATE_BATCH_H
#define STRUT_ENGINE_RUN_SIMULATE_BATCH_H

#include "engine/run/simulate.h"

/** One run of many: owned by the caller until `result` has it back. */
typedef struct strut_batch_point {
  const strut_model *model;
  const strut_experiment *experiment;
  const strut_run_options *options;
  void *context; /* the caller's own */
} strut_batch_point;

typedef struct strut_batch_source {
  void *context;
  /** Fills the next point; false: there is none now. After a result it is asked again. */
  bool (*next)(void *context, strut_batch_point *point);
  /** A point's end, in any order: as strut_simulate returned it. The summary belongs to the callee,
      and so do again the model, the experiment and the options. */
  void (*result)(void *context, const strut_batch_point *point, strut_status status,
                 strut_summary *summary, const strut_error *error);
  /** A model whose topology the lanes share: points like it run in lanes. Lives until the end. */
  const strut_model *example;
  const char *integrator; /* the method of the points that are to run in lanes */
  bool without_ledger;    /* as in the options of those points that are to run in lanes */
  int32_t width;          /* 1, 2, 4 or 8 lanes; 0: as many as the processor is good for */
  bool halves;            /* 8 lanes in registers of 4 whatever the processor has; see batch.h */
} strut_batch_source;

/** Runs all points. Calls back from this thread only. */
STRUT_API void strut_simulate_batch(const strut_batch_source *source);

#endif
