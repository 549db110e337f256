/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A run: from a compiled model to its summary, with rows for recorders. */
#ifndef STRUT_ENGINE_RUN_SIMULATE_H
#define STRUT_ENGINE_RUN_SIMULATE_H

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
  bool without_balance; /* leaves works and energy residual of the summary 0; cheaper */
  bool scene_order;     /* steps the model as it is stored, however scattered its nodes are */
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

/*
 * Many runs on one core: similar ones side by side in the slots of a batch.
 *
 * A last step that is shorter than the others is made outside the batch.
 *
 * Every summary, row of a recording and failure is that of strut_simulate, bit for bit (except for
 * the sign of a NAN). Runs that do not fit a slot are made alone in between: methods other than rk4
 * and verlet-events, a topology other than that of the batch, rigid bars, ground laws other than
 * the default, mass groups too large for a dense inverse; with events also cables and slopes.
 */

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
   * A model of the topology that all slots share: points like it run in the batch. Must live until the end.
   */
  const strut_model *example;
  const char *integrator; /* method of the points that run in the batch */
  bool without_balance;   /* as in the options of those points */
  int32_t width;          /* 1, 2, 4 or 8 slots; 0: chosen for the processor */
  bool halves;            /* 8 slots in registers of 4 on every processor; see batch.h */
} strut_batch_source;

/** Runs all points; calls back from this thread only. */
STRUT_API void strut_simulate_batch(const strut_batch_source *source);

/** Does a run that ended so have a summary? */
static inline bool strut_run_has_results(strut_status status) {
  return status == STRUT_OK || status == STRUT_DIVERGED || status == STRUT_INTERRUPTED;
}

#endif
