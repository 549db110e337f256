/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Detects steady motion of a driven structure by the period map of its shape.
 *
 * At the end of every drive period the state is compared with those of 1, 2, ... periods before.
 * Where the structure stands on the ground and can travel, its travel is removed, since a gait
 * repeats its shape and not its place. A motion counts as period-n when several repetitions in a
 * row agree, and the rest of the transient, extrapolated with its own rate of decay, is within the
 * tolerance too: a slow transient is not steady. Nothing is steady before the last signal has
 * started or ended, or where the signals do not repeat themselves. Where it is wanted, a motion without a
 * period ends, too, if it has long been slower than matters, and its shape does not change more and more.
 */
#pragma once

#include "engine/model/state.h"
#include "engine/run/measure/measure.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

enum { STRUT_RING = 32, STRUT_REPEATS = 6, STRUT_LONGEST_REPEAT = 8, STRUT_MARKS = 129 };

typedef struct strut_steady_detector {
  const strut_model *model;
  double period; /* [s] */
  bool travels;  /* its travel along the ground is removed */
  strut_steady_summary result;
  double velocity, spread; /* over the latest repetitions [m/s] */
  bool known;
  /** When a motion counts as steady. */
  struct {
    double tolerance, floor; /* [1], [m/s] */
    double mean_tolerance;   /* of an irregular motion's mean [1] */
    int64_t least_irregular; /* fewest periods of an irregular motion */
    int32_t successive;
    double not_before;   /* periods until the last signal has begun or ended */
    double creep;        /* motions that stay slower end as creeping [m/s]; 0: none does */
    int64_t creep_after; /* periods before, in which they may yet repeat themselves */
  } rules;
  /** The latest period ends. */
  struct {
    int64_t seen;                               /* so far, the start being the first */
    double *state[STRUT_RING];                  /* (2 length) positions, then velocities */
    double *middle;                             /* (2 length) within the latest period */
    double place[STRUT_RING];                   /* x of the measured point [m] */
    double amplitude;                           /* range of the shape within a period [1] */
    double residual[STRUT_REPEATS][STRUT_RING]; /* of each tested repetition, per period [1] */
    double change[STRUT_REPEATS][STRUT_RING];   /* of the velocity [m/s] */
  } latest;
  /** What an irregular motion has done so far. */
  struct {
    double mark[STRUT_MARKS];     /* x of the measured point every `stride` periods [m] */
    double wandered[STRUT_MARKS]; /* sum of the residuals until then [1] */
    double wander;
    int32_t marks;
    int64_t stride;
  } drift;
  strut_arena arena;
} strut_steady_detector;

/** Creates a detector for a run from `begin` [s] with periods of `period` [s]. STRUT_OK or STRUT_NO_MEMORY. */
strut_status strut_steady_detector_create(const strut_model *model, const strut_steady *wanted,
                                          double period, double begin,
                                          strut_steady_detector *detector);
/** Samples the shape once within each period, for its range. */
void strut_steady_detector_half_period(const strut_state *state, strut_steady_detector *detector);
/** Samples the end of a period, the start included; x: of the measured point. True: the motion is steady. */
bool strut_steady_detector_period(const strut_state *state, double x,
                                  strut_steady_detector *detector);
/** Fills velocity, spread and kind of motion; tests whether a motion that never repeated itself is irregular. */
void strut_steady_detector_finish(strut_steady_detector *detector, strut_summary *summary);
void strut_steady_detector_free(strut_steady_detector *detector);
