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
#pragma once

#include <stdint.h>

#include "engine/integrate/integrator.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/quantity.h"

/*
 * End times of the steps of a run: whole multiples of the step, except for a shorter last one.
 * Interpolation within a step.
 */

typedef struct strut_time_grid {
  double step;   /* [s] */
  double offset; /* time of step 0, not 0 in a run that starts between two steps [s] */
  int64_t last;  /* last step, which ends at `end`; -1: none */
  double end;    /* end of the run without the offset [s] */
} strut_time_grid;

/** End of step n without the offset [s]: the time of methods and forces. */
static inline double strut_time_grid_at(const strut_time_grid *grid, int64_t n) {
  return n == grid->last ? grid->end : (double)n * grid->step;
}

/** End of step n [s], as reported. */
static inline double strut_time_grid_real(const strut_time_grid *grid, int64_t n) {
  return grid->offset + strut_time_grid_at(grid, n);
}

/** Length of the last step [s] where it is shorter than the others, otherwise 0. */
static inline double strut_time_grid_rest(const strut_time_grid *grid) {
  double rest = grid->last > 0 ? grid->end - (double)(grid->last - 1) * grid->step : grid->step;
  return rest < grid->step * (1.0 - 1e-6) ? rest : 0.0;
}

/*
 * Dense output: the state at any instant within a piece of the motion.
 *
 * Positions are the polynomials of fifth order through positions, velocities and accelerations at both
 * ends, velocities their derivatives, works and internal states the cubics through their values and rates. Contact forces follow by
 * their own law, in the modes that a method with events has frozen.
 */

typedef struct strut_dense {
  const strut_model *model;
  double *q, *v;             /* (length) at the instant */
  double *begin_q, *begin_v; /* (length) at the begin of a step of the grid */
  double *begin_memory;      /* (strut_history_count) there; forces within it follow from that */
  double *a[2];              /* (length) accelerations at its ends */
  double begin_work[STRUT_POWER_ROOM], power[2][STRUT_POWER_ROOM];
  /* what the state has at the end of the piece, while it is elsewhere */
  double *end_q, *end_v, *end_memory;
  double end_work[STRUT_POWER_ROOM];
  bool away;   /* the state has been elsewhere since strut_dense_return */
  bool coarse; /* positions and velocities by polynomials of one order less */
} strut_dense;

/** Allocates in the arena. False: out of memory. */
bool strut_dense_create(const strut_model *model, strut_arena *arena, strut_dense *dense);
/** Keeps the state as the begin of the next step of a method without events. */
void strut_dense_keep(strut_dense *dense, const strut_state *state);
/** The piece from the kept state to the present one, h apart; accelerations are computed when they
    are first needed. Its begin is at t [s]. */
strut_motion_piece strut_dense_step(strut_dense *dense, const strut_state *state, double t,
                                    double h);
/**
 * Moves the state to the fraction `s` of the piece. Returns the time there, without time_offset [s].
 * Just after the begin where s is 0.
 */
double strut_dense_place(strut_dense *dense, strut_state *state, strut_motion_piece *piece,
                         double s);
/** Moves the state back to the end of the piece, with all that follows from it as before. */
void strut_dense_return(strut_dense *dense, strut_state *state, const strut_motion_piece *piece);

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
  size_t *index;   /* (length) the columns of the program */
  size_t rate_of;  /* column whose change is the integral of a single velocity; or -1 */
  bool inner;      /* what happens between steps matters */
  bool exact;      /* a sum whose errors must not show in differences of runs */
  double accuracy; /* relative, to which extremes are resolved [1] */
  /* branches of the program: at the ends of the latest part and of that under way; evaluated last */
  uint64_t branch, ahead, seen;
  bool kinked;    /* it has a kink in the part under way that matters */
  double value;   /* at the end of the latest part */
  double before;  /* at its begin, `elapsed` earlier [s] */
  double elapsed; /* 0: none, or something has switched since */
  double largest; /* absolute value in the window */
  double
      doubt; /* uncertainty of the result, where the interpolation is too coarse; that of MEAN, RMS and
                   RISE over the whole window times its length [s] */
  double least, most; /* that extremes may be where samples do not resolve the value */
  double missed;      /* what its integral, or that of the square, may lack there */
  /* of ARRIVAL: begins above (1) or below (-1) the target, at it 0; how close it is now, how close the
     nearest turn before the arrival came; how far it then went beyond, until it returned */
  double side, close, nearest, beyond;
  bool returned;
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
  bool resolved;
  double doubt; /* difference that polynomials of one order less make in the middle */
  /** The quantity at the fraction `at` of the part. */
  double (*sample)(void *context, double at);
  void *context;
} strut_samples;

/** Starts the window; place: of the column rate_of. */
void strut_meter_open(strut_meter *meter, double time, double value, double place);
/** Could a kink within the next `length` [s], at whose end the value is `value`, change the result? */
bool strut_meter_may_turn(const strut_meter *meter, double value, double length);
/** Uncertainty of the result where samples do not resolve an extreme. */
double strut_meter_left(const strut_meter *meter, double window);
/** How far from the target the extreme is that decides whether and when it is reached; HUGE_VAL: at it already. */
double strut_meter_margin(const strut_meter *meter);
/** A mark of the window: ends one period and starts the next. */
void strut_meter_mark(strut_meter *meter, double time, double value, double place);
/** The value jumps, or the way it changes does, at a time [s]. */
void strut_meter_jump(strut_meter *meter, double time, double value);
/** Does the value change so evenly to `value`, within `length` [s], that this end tells enough? */
bool strut_meter_is_even(const strut_meter *meter, double value, double length);
/** Adds a part by its ends alone; `begin` and `length` in [s]. */
void strut_meter_add_even(strut_meter *meter, double value, double begin, double length);
/** Do the samples tell enough? Those at odd places are compared with what the others foretell. */
bool strut_meter_is_resolved(const strut_meter *meter, const strut_samples *samples);
/** Adds a part by its samples, searching for extremes and arrivals between them. */
void strut_meter_add(strut_meter *meter, const strut_samples *samples);
