/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Values of channels: each row of STRUT_CHANNEL_TABLE has a function record_NAME here that fills its numbers
 * from a model and its state.
 */
#ifndef STRUT_ENGINE_RUN_CHANNELS_H
#define STRUT_ENGINE_RUN_CHANNELS_H

#include "engine/model/state.h"
#include "engine/scene/channels.h"

/** Two numbers of each of some things, which are measured together, once for a state. */
typedef struct strut_measured_pair {
  double *first, *second; /* (things) */
  bool fresh;             /* those of the present state */
} strut_measured_pair;

/** A state of a model, and what channels share that is measured of it. */
typedef struct strut_channel_view {
  const strut_model *model;
  strut_state *state;
  double time;                          /* [s] */
  bool observed;                        /* forces are those of the state */
  strut_measured_pair members;          /* lengths, forces */
  strut_measured_pair hinges;           /* angles, moments */
  strut_measured_pair cells;            /* areas, pressures */
  const int32_t *hinge, *cell;          /* their elements */
  double *momentum, *relative_velocity; /* (nodes, 2) scratch */
} strut_channel_view;

/** Allocates what channels share from the arena; false: memory is out. */
bool strut_channel_view_create(const strut_model *model, strut_arena *arena,
                               strut_channel_view *view);
/** From now on the view shows this state at time t [s]; nothing is measured of it yet. */
void strut_channel_view_show(strut_channel_view *view, strut_state *state, double t);
/** Fills the (items, components) numbers of the channel. */
void strut_channel_record(strut_channel_view *view, strut_channel id, double *out);

#endif
