/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Where the nodes are at some moments near the end of a run. By their tracks two runs are known to be
 * the same motion, which one number that both give, such as a mean velocity, cannot show.
 */
#ifndef STRUT_ENGINE_RUN_ACCURACY_ACCURACY_TRACK_H
#define STRUT_ENGINE_RUN_ACCURACY_ACCURACY_TRACK_H

#include "engine/model/model.h"
#include "engine/run/recorder.h"

typedef struct strut_track {
  const strut_model *model; /* of the scene; any run of it may be recorded */
  size_t room, count;       /* moments there is memory for; moments of the latest run */
  double *time;             /* (room) [s] */
  double *position;         /* (room, node_count, 2) [m] */
  strut_sink sink;          /* to be given to the run */
} strut_track;

/** For `room` moments at most, memory from `arena`. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_track_create(const strut_model *model, size_t room, strut_arena *arena,
                                strut_track *track);
/**
 * The largest distance between two tracks at the same moments, over how far the nodes move in them: 0 for
 * the same motion, about 1 for two that have nothing in common. How far the whole has travelled along
 * the ground is left out. HUGE_VAL where the moments differ, but for whole periods [s] where `period` is not 0.
 * Motions below 1e-4 of the structure's size count as that.
 */
double strut_track_distance(const strut_track *a, const strut_track *b, double period);

#endif
