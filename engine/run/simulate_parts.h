/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Parts of a run, which simulate.c steps to its end and stepping.c as it is asked. */
#pragma once

#include "engine/forces/observe.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/run/measure/measure.h"
#include "engine/run/measure/meter.h"
#include "engine/run/measure/monitors.h"
#include "engine/run/orbit/steady_detector.h"
#include "engine/run/recorder.h"
#include "engine/run/simulate.h"
#include "engine/scene/channels.h"

/*
 * Recording: lays out the rows of a run, samples the state and hands rows to the sinks.
 * Where the scene says how far samples are apart, those between two steps are taken by dense output.
 */

typedef struct strut_recording {
  strut_observer observer, *other; /* first: this is what the state knows; and the one behind it */
  strut_sink **sinks;
  size_t sink_count, begun;   /* sinks whose begin succeeded */
  strut_record_layout layout; /* union of the channels of all sinks */
  strut_record_channel channel[STRUT_CHANNEL_COUNT];
  double *rows; /* (capacity, width) rows not yet passed on */
  size_t row_count, capacity;
  strut_time_grid grid;
  double start, every; /* first sample, interval [s] */
  int64_t sampled,
      last;       /* samples so far; step of the latest at an end of one, -1 before the first */
  size_t in_step; /* most samples between two ends of steps */
  strut_dense dense;
  strut_instant instant;
  strut_column *column; /* (width) what each number of a row is, as strut_column_find finds it; */
  strut_observe **observe; /* its function; NULL: the sum of those before it, or the time */
  strut_arena arena;
} strut_recording;

/**
 * Lays out the channels and begins every sink; nothing without sinks. Of the recording, its sinks and grid
 * are the caller's. begin: start of the run without the offset of the grid [s].
 */
strut_status strut_recording_create(const strut_model *model, const strut_experiment *experiment,
                                    double begin, strut_recording *recording, strut_error *error);
/** Step after n at which to stop: a sample is due there or in the step after it; INT64_MAX without sinks. */
int64_t strut_recording_next_step(const strut_recording *recording, int64_t n);
/** Before a step, within which samples may be due. */
void strut_recording_begin_step(strut_recording *recording, strut_state *state);
/** After it: takes those that no observer has taken. */
void strut_recording_end_step(strut_recording *recording, strut_state *state);
/** Is a sample of step n missing? False without sinks. */
bool strut_recording_lacks(const strut_recording *recording, int64_t n);
/** Samples the state where that is due; passes rows on where another step's may have no room. */
strut_status strut_recording_sample(strut_state *state, strut_recording *recording, bool due,
                                    strut_error *error);
/** Passes all rows to the sinks; rows that a sink refuses are not offered again. */
strut_status strut_recording_flush(strut_recording *recording, strut_error *error);
/**
 * Passes the remaining rows on and ends every sink with the status of the run; returns the first
 * failure.
 */
strut_status strut_recording_finish(strut_recording *recording, strut_status run_status,
                                    strut_error *error);
/**
 * A recording of all channels that no sink hears, for strut_recording_observe: its row is `rows`.
 * STRUT_NO_MEMORY.
 */
strut_status strut_recording_create_alone(const strut_model *model, const strut_time_grid *grid,
                                          strut_recording *recording, strut_error *error);
/** Fills the channels of `wanted` (strut_channels bits) into its row. */
void strut_recording_observe(strut_state *state, strut_recording *recording, strut_channels wanted);
/** Frees the recording; ends sinks that are still open with STRUT_FILE_TROUBLE. */
void strut_recording_free(strut_recording *recording);

/** State of one run. */
typedef struct strut_run {
  const strut_model *model;
  const strut_experiment *experiment;
  const strut_run_options *options;
  const strut_integrator *method;
  strut_summary *summary;
  strut_error *error;
  strut_state *state;
  void *workspace;
  double dt;
  strut_time_grid grid;
  int64_t first, steps; /* first step number; last step number */
  int64_t chunk;        /* most steps between two samples */
  int64_t check;        /* step of the next check: a stop that nothing recorded asked for */
  bool ready;           /* preparation succeeded: the first step may be made */
  strut_measurement measure;
  strut_recording recording;
  /** What is watched. */
  struct {
    strut_step_limit_monitor limit;
    strut_stick_band band;
    strut_motion_frequency frequency;
    strut_energies initial;
    strut_balance_monitor balance;
  } watch;
  /** Where steady motion is detected. */
  struct {
    bool wanted;
    strut_steady_detector detector;
    int64_t period_steps;     /* per drive period */
    int64_t answer_periods;   /* least periods of the summary once the motion is steady */
    int64_t recorded_periods; /* and those that are recorded */
  } steady;
  /** When the summary is filled; later steps are recorded only. */
  struct {
    int64_t step;
    bool filled;
  } answer;
  /** Wall clock at the first step and at the latest progress report [s]. */
  struct {
    double start, progress;
  } clock;
  /** A collision that may have been passed through. */
  struct {
    int32_t element; /* + 1; or 0 */
    double speed;    /* at which its two sides moved [m/s]; 0: they were pressed together instead */
  } tunnel;
  /** The bristles that straighten fastest at a sample. */
  struct {
    int32_t item;
    double decay; /* [1/s] */
  } bristles;
} strut_run;

/**
 * Prepares everything before the first step. `run` and all arguments must stay in place until
 * strut_run_free, which must be called whatever is returned.
 */
strut_status strut_run_begin(const strut_model *model, const strut_experiment *experiment,
                             const strut_run_options *options, strut_summary *summary,
                             strut_error *error, strut_run *run);
/**
 * Between steps: checks, measures and records the state, which may change. *stop is the step at
 * which to sample next, or the present one where the run is over.
 */
strut_status strut_run_sample(strut_run *run, int64_t *stop);
/** Steps up to `stop`. */
void strut_run_step(strut_run *run, int64_t stop);
/** Time reached [s]. */
double strut_run_time(const strut_run *run);
/** Completes summary and recording; `status` is that of begin or sample. Returns it, or that of a sink. */
strut_status strut_run_complete(strut_run *run, strut_status status);
void strut_run_free(strut_run *run);

/* ---- run_diagnosis.c ---- */

/** Checks at intervals that the step is still stable for the present shape. */
strut_status strut_run_check_step_limit(strut_run *run);
/** First node with a NaN or runaway position, or -1. */
int32_t strut_run_find_lost_node(const strut_model *model, const strut_state *state);
/** Reports a lost node: STRUT_DIVERGED. */
strut_status strut_run_fail_lost_node(const strut_run *run, int32_t node);
/** Notes collisions whose sides move by more than their thickness in a step, or are deeper than half. */
void strut_run_watch_collisions(strut_run *run);
/** Notes how fast bristles straighten. */
void strut_run_watch_bristles(strut_run *run);
/** STRUT_DIVERGED with the name of a cell without area, or of a member that is wound in. */
strut_status strut_run_check_collapse(const strut_run *run);
/** STRUT_DIVERGED where a loss has given energy, or an energy is no longer finite. */
strut_status strut_run_check_balance(const strut_run *run);
/** STRUT_DIVERGED with the name of an internal state that is no longer a finite number. */
strut_status strut_run_check_states(const strut_run *run);
/** STRUT_STEP_TOO_LARGE with the internal state that settles too fast for the step. */
strut_status strut_run_check_rates(const strut_run *run);
/** Reports a method that failed: STRUT_DIVERGED. */
strut_status strut_run_fail_method(const strut_run *run);

/** Adds all warnings about the result to the summary, which must be complete. */
void strut_run_warn(const strut_run *run);
