/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Recording: lays out the rows of a run, samples the state and hands rows to the sinks.
 */
#ifndef STRUT_ENGINE_RUN_RECORDING_H
#define STRUT_ENGINE_RUN_RECORDING_H

#include "engine/forces/observe.h"
#include "engine/run/measure/meter.h"
#include "engine/run/recorder.h"
#include "engine/scene/channels.h"

/** Channels of one sink, as a layout of their own. */
typedef struct strut_recording_part {
  bool whole; /* all channels: rows are passed on unchanged */
  strut_record_layout layout;
  strut_record_channel channel[STRUT_CHANNEL_COUNT];
  size_t from[STRUT_CHANNEL_COUNT]; /* offset of each in a full row */
} strut_recording_part;

typedef struct strut_recording {
  strut_sink **sinks;
  size_t sink_count, begun;   /* sinks whose begin succeeded */
  strut_record_layout layout; /* union of the channels of all sinks */
  strut_record_channel channel[STRUT_CHANNEL_COUNT];
  strut_recording_part *parts; /* (sink_count) */
  double *rows;                /* (capacity, width) rows not yet passed on */
  double *picked; /* (capacity, width) rows of one sink; NULL where every sink takes all channels */
  size_t row_count, capacity;
  strut_time_grid grid;
  double start, every;   /* first sample, interval [s] */
  int64_t sampled, last; /* samples so far; step of the latest, -1 before the first */
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
/** Step at whose end the next sample is due; INT64_MAX without sinks. */
int64_t strut_recording_next_step(const strut_recording *recording);
/** Is a sample of step n missing? False without sinks. */
bool strut_recording_lacks(const strut_recording *recording, int64_t n);
/** Samples the state; passes rows on when the block is full. */
strut_status strut_recording_sample(strut_state *state, strut_recording *recording,
                                    strut_error *error);
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

#endif
