/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A run in parts, for whoever does the stepping: simulate.c one run, simulate_batch.c several at once.
 */
#ifndef STRUT_ENGINE_RUN_SIMULATE_PARTS_H
#define STRUT_ENGINE_RUN_SIMULATE_PARTS_H

#include "engine/integrate/limit/step_limit.h"
#include "engine/run/measure/balance.h"
#include "engine/run/measure/measure.h"
#include "engine/run/measure/step_limit_monitor.h"
#include "engine/run/measure/stick_band.h"
#include "engine/run/measure/time_grid.h"
#include "engine/run/orbit/steady_detector.h"
#include "engine/run/recording.h"
#include "engine/run/simulate.h"

/** All that belongs to one run. */
typedef struct strut_run {
  const strut_model *model;
  const strut_experiment *experiment;
  const strut_run_options *options;
  const strut_integrator *method;
  strut_step_limits *limits;
  strut_summary *summary;
  strut_error *error;
  strut_state *state;
  void *workspace;
  strut_measurement measure;
  strut_recording recording;
  strut_step_limit_monitor guard;
  strut_stick_band band;
  strut_energies initial;
  strut_balance_monitor balance;
  bool watching;
  strut_steady_detector watch;
  double dt;
  strut_time_grid grid;
  int64_t first, steps; /* the step number it begins with, and the one it is to end with */
  int64_t period_steps; /* of a drive period, where steady motion is watched for */
  int64_t more_periods; /* to run, and record, once it is steady */
  int64_t shot_periods; /* drive periods that shooting took */
  int64_t chunk;        /* the most steps between two looks */
  double began, told;   /* when stepping began, and when progress was told last */
  bool begun;           /* the first step may be taken */
} strut_run;

/**
 * Everything before the first step. `run` and what is given must stay where they are until
 * strut_run_end, which must be called whatever is returned. limits: of models seen before; may be NULL.
 */
strut_status strut_run_begin(const strut_model *model, const strut_experiment *experiment,
                             const strut_run_options *options, strut_step_limits *limits,
                             strut_summary *summary, strut_error *error, strut_run *run);
/**
 * Between steps: looks at the state, measures, records. *stop is the step to go on to before the next
 * look, or the present one where the run is over. May change the state's q, v.
 */
strut_status strut_run_sample(strut_run *run, int64_t *stop);
/** From a look to the next one. */
void strut_run_step(strut_run *run, int64_t stop);
/** Is the step that is due the last one, and shorter than the others? Only strut_run_step takes it. */
bool strut_run_last_step_due(const strut_run *run);
/** The time that the run has come to [s]. */
double strut_run_time(const strut_run *run);
/** Fills the summary and frees what belongs to the run; `status` is what begin or look returned. */
strut_status strut_run_end(strut_run *run, strut_status status);

/* ---- run_diagnosis.c ---- */

/** Every so many steps: does the step still suit the structure? */
strut_status strut_run_watch_step(strut_run *r);
/** The first node that is nowhere or too far away, or -1. */
int32_t strut_run_lost_node(const strut_model *model, const strut_state *state);
/** Fails for a lost node. */
strut_status strut_run_diverged(const strut_run *r, int32_t node);
/** Fails for a method that could not go on. */
strut_status strut_run_stuck(const strut_run *r);

/** At the end: what is to be said of the result goes into the summary, which is filled. */
void strut_run_warn(const strut_run *r);

#endif
