/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Node positions near the end of a run, to compare the motions of two runs. */
#ifndef STRUT_ENGINE_RUN_ACCURACY_ACCURACY_TRACK_H
#define STRUT_ENGINE_RUN_ACCURACY_ACCURACY_TRACK_H

#include "engine/model/model.h"
#include "engine/run/recorder.h"

typedef struct strut_track {
  const strut_model *model; /* any run of this model may be recorded */
  size_t capacity, count;   /* capacity; moments of the latest run */
  double *time;             /* (capacity) [s] */
  double *position;         /* (capacity, node_count, 2) [m] */
  strut_sink sink;          /* for the run */
} strut_track;

/** A track of up to `capacity` moments, in the arena. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_track_create(const strut_model *model, size_t capacity, strut_arena *arena,
                                strut_track *t);
/**
 * Largest distance between two tracks at the same moments over the nodes' range of motion: 0 for
 * the same motion, about 1 for unrelated ones. Travel along the ground is left out. HUGE_VAL where
 * the moments differ, except by whole periods [s] if `period` is not 0. Motions below 1e-4 of the
 * size count as that.
 */
double strut_track_distance(const strut_track *a, const strut_track *b, double period);

#endif
