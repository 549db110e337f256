/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Many runs on one core: similar ones side by side in the lanes of a batch.
 *
 * A last step that is shorter than the others is made outside the lanes.
 *
 * Every summary, row of a recording and failure is that of strut_simulate, bit for bit (except for
 * the sign of a NAN). Runs that do not fit a lane are made alone in between: methods other than rk4
 * and verlet-events, a topology other than that of the batch, rigid bars, ground laws other than
 * the default, mass groups too large for a dense inverse; with events also cables and slopes.
 */
#ifndef STRUT_ENGINE_RUN_SIMULATE_BATCH_H
#define STRUT_ENGINE_RUN_SIMULATE_BATCH_H

#include "engine/run/simulate.h"

/** One run of many; owned by the caller until `result` returns it. */
typedef struct strut_batch_point {
  const strut_model *model;
  const strut_experiment *experiment;
  const strut_run_options *options;
  void *context; /* for the caller */
} strut_batch_point;

typedef struct strut_batch_source {
  void *context;
  /** Fills the next point; false: none at present. Called again after each result. */
  bool (*next)(void *context, strut_batch_point *point);
  /**
   * Receives the end of a point, in any order, as strut_simulate returned it. The summary passes to
   * the callee, and the model, experiment and options return to it.
   */
  void (*result)(void *context, const strut_batch_point *point, strut_status status,
                 strut_summary *summary, const strut_error *error);
  /**
   * A model whose topology the lanes share: points like it run in lanes. Must live until the end.
   */
  const strut_model *example;
  const char *integrator; /* method of the points that run in lanes */
  bool without_ledger;    /* as in the options of those points */
  int32_t width;          /* 1, 2, 4 or 8 lanes; 0: chosen for the processor */
  bool halves;            /* 8 lanes in registers of 4 on every processor; see batch.h */
} strut_batch_source;

/** Runs all points; calls back from this thread only. */
STRUT_API void strut_simulate_batch(const strut_batch_source *source);

#endif
