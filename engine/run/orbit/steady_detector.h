/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Watching whether a driven motion has become steady: the period map of its shape.
 *
 * At the end of every drive period the state is compared with that of one, two, ... periods before.
 * Where the structure stands on the ground and nothing holds it along it, the travel along the
 * ground is taken out, since a gait repeats its shape and not its place. A motion counts as
 * period-n when several repetitions in a row agree, and what is left of the transient, extrapolated
 * by its own rate of decay, is within the tolerance too: a slow transient is not steady. Nor is
 * anything before the last signal has begun or ended, or where the signals do not repeat themselves.
 */
#ifndef STRUT_ENGINE_RUN_ORBIT_STEADY_DETECTOR_H
#define STRUT_ENGINE_RUN_ORBIT_STEADY_DETECTOR_H

#include "engine/model/state.h"
#include "engine/run/measure/measure.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

enum { STRUT_RING = 32, STRUT_REPEATS = 6, STRUT_LONGEST_REPEAT = 8, STRUT_MARKS = 129 };

typedef struct strut_steady_detector {
  const strut_model *model;
  double period;           /* [s] */
  double tolerance, floor; /* [1], [m/s] */
  double mean_tolerance;   /* of an irregular motion's mean [1] */
  int64_t least_irregular; /* periods before a motion may be called so */
  int32_t successive;
  bool travels;              /* the travel along the ground is taken out */
  int64_t seen;              /* period ends so far, the start being the first */
  double *state[STRUT_RING]; /* (2 length) positions, then velocities; of the latest period ends */
  double *middle;            /* (2 length) within the latest period */
  double place[STRUT_RING];  /* x of the measured point [m] */
  double amplitude;          /* how far the shape moves within a period [1] */
  double residual[STRUT_REPEATS][STRUT_RING]; /* of each repetition looked for, per period [1] */
  double change[STRUT_REPEATS][STRUT_RING];   /* of the velocity [m/s] */
  double not_before;                          /* periods until the last signal has begun or ended */
  double mark[STRUT_MARKS];     /* x of the measured point every `stride` periods [m] */
  double wandered[STRUT_MARKS]; /* sum of the residuals until then [1] */
  double wander;
  int32_t marks;
  int64_t stride;
  strut_steady_summary result;
  double velocity, spread; /* over the latest repetitions [m/s] */
  bool known;
  strut_arena arena;
} strut_steady_detector;

/** For a run from `begin` [s] by periods of `period` [s]. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_steady_detector_create(const strut_model *model, const strut_steady *wanted,
                                          double period, double begin,
                                          strut_steady_detector *watch);
/** Within a period, once: how far the shape moves. */
void strut_steady_detector_half_period(const strut_state *state, strut_steady_detector *watch);
/** At the end of a period, the start included. x: of the measured point. True once it is steady. */
bool strut_steady_detector_period(const strut_state *state, double x, strut_steady_detector *watch);
/** Velocity, spread and what was found; whether a motion that did not repeat itself is irregular. */
void strut_steady_detector_finish(strut_steady_detector *watch, strut_summary *summary);
void strut_steady_detector_free(strut_steady_detector *watch);

#endif
