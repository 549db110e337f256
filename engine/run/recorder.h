/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Channels over time: the rows that a run passes to its sinks.
 *
 * The recorder writes no files. It collects rows of doubles and passes them to the sinks in blocks,
 * between steps. A row begins with the time; each channel has its offset. What is between them is for other sinks.
 */
#pragma once

#include <stddef.h>

#include "engine/base/status.h"
#include "engine/scene/experiment.h"

/** One quantity of every item of a kind: (items, components) doubles of a row from `offset` on. */
typedef struct strut_record_channel {
  strut_channels id;
  const char *name; /* "position", "velocity", "length", "force", "contact", "angle", ... */
  const char *unit; /* "m", "m/s", "m", "N", "N", "rad", ...; "SI": each item has its own */
  size_t items, components, offset;
  const char *const
      *item_names; /* (items) of nodes, members, hinges or cells; {"total"} for energy */
  const char *const *component_names; /* (components) {"x", "y"}; {""} for a single one;
                                         contact: {"normal", "friction"}; energy: {"kinetic", ...} */
  const char *const *item_units;      /* (items); NULL: the same of all */
} strut_record_channel;

/** The columns of a row: width doubles, the first is the time [s]. */
typedef struct strut_record_layout {
  size_t width, channel_count;
  const strut_record_channel *channels;
  size_t expected_rows; /* an estimate for progress and chunk sizes */
} strut_record_layout;

/**
 * Receives the rows of a run; the layout is gone after begin. A sink that fails stops the run with its status. end is called once
 * if begin succeeded, with the status of the run: a sink that writes files completes them even when
 * the run diverged or was interrupted (and marks them so), and removes them for STRUT_FILE_TROUBLE
 * or STRUT_NO_MEMORY. NULL: it has nothing to do then.
 */
typedef struct strut_sink {
  void *context;
  strut_status (*begin)(void *context, const strut_record_layout *layout, strut_error *error);
  strut_status (*rows)(void *context, const double *rows, size_t count, strut_error *error);
  strut_status (*end)(void *context, strut_status run_status, strut_error *error);
  strut_channels channels; /* of its rows; 0: those of the experiment */
} strut_sink;
