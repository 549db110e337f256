/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The period map of a driven motion: from the start of a drive period to its end, by one method.
 *
 * A state here is 2 length + 1 doubles: positions, velocities, and the remaining time of refined
 * steps after a touchdown. Travel along the ground is removed after each period, so that a gait is
 * a fixed point.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/integrate/integrator.h"
#include "engine/run/measure/measure.h"

typedef struct strut_period_map {
  const strut_model *model; /* borrowed */
  strut_state *state;
  const strut_integrator *method;
  void *workspace;
  strut_measurement measure;
  double dt, period; /* [s] */
  double time;       /* start of an application, for drives and loads [s]; may be set freely */
  int64_t steps;     /* steps per drive period */
  int32_t repeats;   /* drive periods per application */
  bool travels;
  const strut_flag *interrupt; /* an application ends soon after it is set; may be NULL */
  int64_t most_evaluations;    /* likewise after this many in all applications; 0: no limit */
  int64_t evaluations, events, applied; /* so far; applied: drive periods */
  int64_t forced;                       /* see strut_forced_steps */
  /** Sees the state after each step of the grid; NULL: nobody looks. */
  void (*watch)(void *context, const strut_state *state);
  void *watch_context;
} strut_period_map;

/** Creates the map with method and step of `experiment`; the step is adjusted to divide the period. */
strut_status strut_period_map_create(const strut_model *model, const strut_experiment *experiment,
                                     int32_t repeats, strut_period_map *map, strut_error *error);
/**
 * Moves y by `repeats` drive periods and removes its travel along the ground. Returns the travel of
 * the measured point [m]; NAN where the motion was lost or the application interrupted.
 */
double strut_period_map_apply(strut_period_map *map, double *y);
/** d = shape of `to` minus that of `from`: the mean shift along the ground is removed. */
void strut_period_map_subtract(const strut_period_map *map, const double *from, const double *to,
                               double *change);
/** Is the interrupt flag set? */
bool strut_period_map_interrupted(const strut_period_map *map);
/** Is the limit of evaluations exceeded? */
bool strut_period_map_spent(const strut_period_map *map);
/** Size of a difference: the largest of positions over the structure's size, and velocities over
    size times 2 pi f. */
double strut_period_map_size(const strut_period_map *map, const double *change);
/** Mean position of the nodes along the ground [m]. */
double strut_mean_along_ground(const strut_model *model, const double *positions);
/** NULL-safe on a zeroed map. */
void strut_period_map_free(strut_period_map *map);

/* An accurate periodic motion from a coarse one, by defect correction on the period map.
 *
 * Let C and F be the period maps of a coarse and of an accurate method, and y a fixed point of C. F
 * leaves the defect r = F(y) - y. To first order the fixed point of F is y + sum_k J^k r, with J
 * the common derivative of the maps; and J^k r is the disturbance r after k periods of C. So one
 * accurate period and some coarse ones give the accurate orbit and its velocity. A repetition with
 * the defect at the new point reduces the error quadratically, and measures it.
 */

typedef struct strut_orbit {
  double *y;         /* (2 length + 1) coarse fixed point in, accurate one out */
  double velocity;   /* [m/s] */
  double correction; /* change of the velocity by the latest correction [m/s] */
  double
      defect; /* defect of y before it: the largest of positions over the size, velocities over size times 2 pi f */
  bool converged; /* the disturbance decayed */
} strut_orbit;

/**
 * Corrects the orbit once. `base` (2 length + 1): the fixed point of `coarse`; travel: of one
 * application there [m]; enough: negligible travel per period [m]. STRUT_OK or STRUT_NO_MEMORY;
 * `converged` is false where the disturbance did not decay or the motion was lost, and then y and
 * velocity are unchanged.
 */
strut_status strut_orbit_correct(strut_period_map *coarse, strut_period_map *reference,
                                 const double *base, double travel, double enough,
                                 strut_orbit *orbit);

/** How far an extrapolation goes, and how it ended. */
typedef struct strut_extrapolation {
  double enough; /* acceptable error of the travel per application [m] */
  double fall;   /* part of a cycle's first difference that its last must be to continue [1] */
  int cycles;    /* most extrapolations */
  bool found;    /* the fixed point */
  bool unsteady; /* applications, or their extrapolation, lead away */
} strut_extrapolation;

/**
 * Extrapolates the sequence of applications of the map from y (2 length + 1) to its fixed point. Where it is
 * found, y is the fixed point and *travel its travel [m]. STRUT_OK or STRUT_NO_MEMORY.
 */
strut_status strut_orbit_limit(strut_period_map *map, strut_extrapolation *to, double *y,
                               double *travel);
