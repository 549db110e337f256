/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A run that is stepped from outside: some steps at a time, with inputs that are held between.
 *
 * The steps are those of strut_simulate, bit for bit, however they are divided into calls. Inputs may change between
 * two calls; a change is an event from which methods begin anew, and what it does to the stored energy is work of
 * the drive. With a sink it is recorded, measured and summarised as a run is, else nothing is.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/run/measure/summary.h"
#include "engine/run/recorder.h"
#include "engine/scene/experiment.h"

typedef struct strut_stepping strut_stepping;
typedef struct strut_stepping_snapshot strut_stepping_snapshot;

/** Arrays that the caller writes between two calls. */
typedef enum strut_input {
  STRUT_INPUT_REST,      /* (members) rest lengths, to which drives are added [m] */
  STRUT_INPUT_ACTUATORS, /* (actuators) the signal's value; NAN: as the scene says */
  STRUT_INPUT_LOAD,      /* (nodes, 2) forces beside the scene's [N] */
  STRUT_INPUT_RATES, /* (actuators) at which these values move from the next step on, per second */
  STRUT_INPUTS
} strut_input;

/**
 * A stepping at the start of the experiment on a scene, both of which become its own: they are changed by
 * inputs, must stay in place, and are not released by it. force: run even above the step limit. The start
 * must be resolved and the step be given. The sink hears of what is recorded, each row before inputs change at its
 * time, and the experiment's end is that of the steps; NULL: they have no end. Fails as strut_simulate before its
 * first step.
 */
STRUT_API strut_status strut_stepping_create(strut_setup *setup, bool force,
                                             const strut_flag *interrupt, strut_sink *sink,
                                             strut_stepping **stepping, strut_error *error);
/**
 * Ends the recording and gives its summary away, whose names are the setup's. The simulation stays where it is.
 * Returns the status of the run: STRUT_INTERRUPTED before its end, or that of the sink.
 */
STRUT_API strut_status strut_stepping_finish(strut_stepping *stepping, strut_summary *summary);
STRUT_API void strut_stepping_free(strut_stepping *stepping); /* NULL is allowed */

/**
 * Steps; inputs that have changed count from here on. STRUT_USAGE, without a step, where an input is not
 * valid; STRUT_DIVERGED, STRUT_INTERRUPTED: it stands where it came to. After a divergence every call
 * fails, until a restore.
 */
STRUT_API strut_status strut_stepping_advance(strut_stepping *stepping, int64_t steps,
                                              strut_error *error);
/** Time reached, and length of a step [s]. */
STRUT_API double strut_stepping_time(const strut_stepping *stepping);
STRUT_API double strut_stepping_step(const strut_stepping *stepping);

/**
 * A channel as a recording has it, (items, components), which from now on follows every call; NULL where
 * there is none.
 */
STRUT_API const strut_record_channel *strut_stepping_channel(strut_stepping *stepping,
                                                             strut_channels id,
                                                             const double **data);
/** An input; *count numbers. NULL: memory is out. */
STRUT_API double *strut_stepping_input(strut_stepping *stepping, strut_input input, size_t *count);
/** Work that changes of inputs have done [J]. */
STRUT_API double strut_stepping_input_work(const strut_stepping *stepping);

/** Rows that the sink gets of what was done; after a restore it may have more. */
STRUT_API int64_t strut_stepping_recorded(const strut_stepping *stepping);

/** All that changes while it is stepped, inputs too. NULL: memory is out. */
STRUT_API strut_stepping_snapshot *strut_stepping_store(strut_stepping *stepping);
/** Back to a snapshot of the same stepping: what follows has the same bits. False: it is of another. */
STRUT_API bool strut_stepping_restore(strut_stepping *stepping,
                                      const strut_stepping_snapshot *snapshot);
STRUT_API void strut_stepping_snapshot_free(
    strut_stepping_snapshot *snapshot); /* NULL is allowed */
