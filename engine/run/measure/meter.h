/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Reduces the values of one quantity over the window and over each of its periods, by its samples
 * between the steps.
 *
 * A part so short that the values change evenly needs no samples between its ends: its integral and
 * its extremes are those of the parabola through these and the value before. Any other one is halved
 * until a parabola through its samples meets those between. There integrals are by Simpson's rule,
 * extremes and arrivals are searched for where the samples show one.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_METER_H
#define STRUT_ENGINE_RUN_MEASURE_METER_H

#include "engine/run/measure/summary.h"
#include "engine/scene/quantity.h"

/** Samples are at most so deep: 2^depth parts. */
enum { STRUT_DEEPEST = 5, STRUT_MOST_SAMPLES = (1 << STRUT_DEEPEST) + 1 };

/** Sums and extremes over a stretch of the window. */
typedef struct strut_meter_stretch {
  double integral, square; /* integrals of the value and its square over the time */
  double low, high;
  double begin;   /* value at the start */
  double origin;  /* position at the start, where its change is the integral */
  double time;    /* start [s] */
  double rise;    /* sum of all increases */
  double arrival; /* when the target was first reached or passed [s]; NAN: not yet */
} strut_meter_stretch;

typedef struct strut_meter {
  const strut_quantity_definition *definition;
  size_t *index;  /* (length) the columns of the program */
  size_t rate_of; /* column whose change is the integral of a single velocity; or -1 */
  bool inner;     /* what happens between steps matters */
  double value;   /* at the end of the latest part */
  double before;  /* at its begin, `elapsed` earlier [s] */
  double elapsed; /* 0: none, or something has switched since */
  double largest; /* absolute value in the window */
  double
      doubt; /* uncertainty of the result, where the interpolation is too coarse; that of MEAN, RMS and
                   RISE over the whole window times its length [s] */
  strut_meter_stretch whole, part; /* since the start of the window; since the latest mark */
  double result;                   /* up to the latest mark */
  int64_t parts; /* periods so far; mean of their values; sum of squares about it */
  double part_mean, part_square;
} strut_meter;

/** Part of a piece of the motion, with samples of one quantity at equal distances. */
typedef struct strut_samples {
  double begin, length; /* [s] */
  int count;            /* 2^depth + 1 */
  double value[STRUT_MOST_SAMPLES];
  double doubt; /* difference that polynomials of one order less make in the middle */
  /** The quantity at the fraction `at` of the part. */
  double (*sample)(void *context, double at);
  void *context;
} strut_samples;

/** Starts the window; place: of the column rate_of. */
void strut_meter_open(strut_meter *m, double time, double value, double place);
/** A mark of the window: ends one period and starts the next. */
void strut_meter_mark(strut_meter *m, double time, double value, double place);
/** The value jumps, or the way it changes does, at a time [s]. */
void strut_meter_jump(strut_meter *m, double time, double value);
/** Does the value change so evenly to `value`, within `length` [s], that this end tells enough? */
bool strut_meter_is_even(const strut_meter *m, double value, double length);
/** Adds a part by its ends alone; `begin` and `length` in [s]. */
void strut_meter_add_even(strut_meter *m, double value, double begin, double length);
/** Do the samples tell enough? Those at odd places are compared with what the others foretell. */
bool strut_meter_is_resolved(const strut_meter *m, const strut_samples *samples);
/** Adds a part by its samples, searching for extremes and arrivals between them. */
void strut_meter_add(strut_meter *m, const strut_samples *samples);

#endif
