/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A run: from a compiled model to its summary, with rows for recorders. */
#pragma once

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/run/measure/summary.h"
#include "engine/run/recorder.h"
#include "engine/scene/experiment.h"

/**
 * A state to start from or to store; coordinate arrays of the length of the model, owned by the
 * caller.
 */
typedef struct strut_snapshot {
  double *q, *v;  /* [m], [m/s] */
  double time;    /* time of drives and loads [s] */
  double refined; /* refinement after a touchdown lasts this much longer [s] */
  double *memory; /* (strut_history_count of the model) what elements remember; NULL: nothing */
  const strut_energy *balance; /* up to there, which that of a run from there continues; not stored;
                                  NULL: works and losses begin anew */
} strut_snapshot;

/** Options of a run. Zero: obey the step limit, no callbacks, no recording. */
typedef struct strut_run_options {
  bool force;                  /* run even above the step limit */
  const strut_flag *interrupt; /* stops soon after it becomes non-zero; may be NULL */
  void (*progress)(void *context, double fraction); /* a few times a second; may be NULL */
  void (*phase)(
      void *context,
      const char *
          name); /* a run in several parts begins another, such as "checking by adaptive"; may be NULL */
  void *progress_context; /* of both */
  strut_sink **sinks;     /* (sink_count); the summary does not depend on what is recorded */
  size_t sink_count;
  const strut_snapshot *
      from; /* start instead of that of the scene; its time becomes a whole number of steps in a run that stops when it is steady; may be NULL */
  strut_snapshot *to; /* filled at the end; may be NULL */
  int64_t
      most_evaluations; /* force evaluations after which the run ends with STRUT_WORK_LIMIT; 0: no limit */
  bool chosen;          /* method and step were chosen for a wanted accuracy */
  const strut_run_samples *samples; /* that divide the window in place of periods; may be NULL */
  bool without_balance;             /* leaves works and energy residual of the summary 0; cheaper */
} strut_run_options;

/**
 * Runs an experiment on a model; ignores its `accuracy`. The summary is filled whenever stepping
 * started, also with STRUT_DIVERGED and STRUT_INTERRUPTED up to that time; free it with
 * strut_summary_free. Other failures: STRUT_USAGE (no such method, or a start equilibrium not yet
 * resolved by strut_resolve_start_equilibrium), STRUT_STEP_TOO_LARGE (before the first step),
 * STRUT_NOT_SETTLED, STRUT_SINGULAR (no mass), STRUT_NO_MEMORY, and those of a sink.
 */
STRUT_API strut_status strut_simulate(const strut_model *model, const strut_experiment *experiment,
                                      const strut_run_options *options, strut_summary *summary,
                                      strut_error *error);

/** Monotonic clock [s], for durations only, never for results. */
STRUT_API double strut_run_clock(void);

/** Does a run that ended so have a summary? */
static inline bool strut_run_has_results(strut_status status) {
  return status == STRUT_OK || status == STRUT_DIVERGED || status == STRUT_INTERRUPTED;
}
