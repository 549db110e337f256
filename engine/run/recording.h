/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Recording: lays out the rows of a run, samples the state and hands rows to the sinks.
 */
#ifndef STRUT_ENGINE_RUN_RECORDING_H
#define STRUT_ENGINE_RUN_RECORDING_H

#include "engine/model/state.h"
#include "engine/run/measure/time_grid.h"
#include "engine/run/recorder.h"

enum { STRUT_CHANNELS = 6 };

/** What one sink is given: the channels it wants, as a layout of their own. */
typedef struct strut_recording_part {
  bool whole; /* all that is recorded: rows are passed on as they are */
  strut_record_layout layout;
  strut_record_channel channel[STRUT_CHANNELS];
  size_t from[STRUT_CHANNELS]; /* where each stands in a whole row */
} strut_recording_part;

typedef struct strut_recording {
  strut_sink **sinks;
  size_t sink_count, begun;   /* sinks whose begin succeeded */
  strut_record_layout layout; /* of all that some sink wants */
  strut_record_channel channel[STRUT_CHANNELS];
  strut_recording_part *parts; /* (sink_count) */
  double *rows;                /* (capacity, width) waiting to be handed over */
  double *picked;              /* (capacity, width) those of one sink; NULL where all want all */
  size_t row_count, capacity;
  strut_time_grid grid;
  double start, every;    /* first sample, interval [s] */
  int64_t sampled, last;  /* samples taken; the step of the latest, -1 before the first */
  double *length, *force; /* (members) scratch */
  strut_arena arena;
} strut_recording;

/** Lays out the channels and begins every sink. Without sinks it costs nothing. begin: the time at
    which the run begins, less the grid's offset [s]. */
strut_status strut_recording_create(const strut_model *model, const strut_experiment *experiment,
                                    const strut_time_grid *grid, double begin, strut_sink **sinks,
                                    size_t sink_count, strut_recording *recording,
                                    strut_error *error);
/** The number of the step at whose end the next sample is due; INT64_MAX without sinks. */
int64_t strut_recording_next_step(const strut_recording *recording);
/** Is there no sample of step n yet? Not without sinks. */
bool strut_recording_lacks(const strut_recording *recording, int64_t n);
/** Takes a sample of the state now; hands rows over when enough have gathered. */
strut_status strut_recording_sample(const strut_model *model, strut_state *state,
                                    strut_recording *recording, strut_error *error);
/** Hands over the rest and ends every sink with the run's status; the first failure is returned. */
strut_status strut_recording_finish(strut_recording *recording, strut_status run_status,
                                    strut_error *error);
/** Frees; sinks that were begun but not finished are ended with STRUT_FILE_TROUBLE. */
void strut_recording_free(strut_recording *recording);

#endif
