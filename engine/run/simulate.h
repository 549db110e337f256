/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The run: from a compiled model to its summary, with rows for whoever records.
 */
#ifndef STRUT_ENGINE_RUN_SIMULATE_H
#define STRUT_ENGINE_RUN_SIMULATE_H

#include <signal.h>

#include "engine/model/model.h"
#include "engine/run/measure/summary.h"
#include "engine/run/recorder.h"
#include "engine/scene/experiment.h"

/** A state to go on from, or to keep: coordinate arrays of the model's length, owned by the caller. */
typedef struct strut_snapshot {
  double *q, *v;  /* [m], [m/s] */
  double time;    /* [s]: where drives and loads stand */
  double refined; /* refinement after a touchdown still lasts so long [s] */
} strut_snapshot;

/** How to run; zero-initialised it means: obey the step limit, tell nobody, record nothing. */
typedef struct strut_run_options {
  bool force;                             /* run even above the step limit */
  const volatile sig_atomic_t *interrupt; /* stops soon after it becomes non-zero; may be NULL */
  void (*progress)(void *context, double fraction); /* a few times a second; may be NULL */
  void (*phase)(void *context, const char *name); /* a run in several parts begins another one, such
                                 as "checking by adaptive"; may be NULL */
  void *progress_context;                         /* of both */
  strut_sink **sinks;                             /* (sink_count) */
  size_t sink_count;
  const strut_snapshot *from; /* instead of the scene's start; in a run that stops when it is steady
                                 its time becomes a whole number of steps; may be NULL */
  strut_snapshot *to;         /* filled at the end; may be NULL */
  int64_t
      most_evaluations; /* of the forces: the run ends soon after with STRUT_WORK_LIMIT; 0: any */
  bool chosen;          /* method and step were chosen for a wanted accuracy */
  bool without_ledger;  /* no works and no energy residual in the summary: 0. Cheaper */
} strut_run_options;

/**
 * Runs an experiment on a model, whose `accuracy` is not obeyed. The summary is filled whenever a run began: also with
 * STRUT_DIVERGED and STRUT_INTERRUPTED, up to where it came; free it with strut_summary_free.
 * Other failures: STRUT_USAGE (no such method, or a start equilibrium that strut_resolve_start_equilibrium has not
 * resolved), STRUT_STEP_TOO_LARGE (nothing was run), STRUT_NOT_SETTLED, STRUT_SINGULAR (no
 * mass), STRUT_NO_MEMORY, and what a sink returned.
 */
STRUT_API strut_status strut_simulate(const strut_model *model, const strut_experiment *experiment,
                                      const strut_run_options *options, strut_summary *summary,
                                      strut_error *error);

/** A clock that never goes back [s]; for how long things take, never for results. */
STRUT_API double strut_run_clock(void);

#endif
