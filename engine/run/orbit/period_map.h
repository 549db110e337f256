/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The period map of a driven motion: from the start of a drive period to its end, by one method.
 *
 * A state here is 2 length + 1 doubles: positions, velocities, and the remaining time of refined
 * steps after a touchdown. Travel along the ground is removed after each period, so that a gait is
 * a fixed point.
 */
#ifndef STRUT_ENGINE_RUN_ORBIT_PERIOD_MAP_H
#define STRUT_ENGINE_RUN_ORBIT_PERIOD_MAP_H

#include <signal.h>

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
  const volatile sig_atomic_t
      *interrupt;           /* an application ends soon after it is set; may be NULL */
  int64_t most_evaluations; /* likewise after this many in all applications; 0: no limit */
  int64_t evaluations, events, applied; /* so far; applied: drive periods */
  /** Sees the state after each step of the grid; NULL: nobody looks. */
  void (*watch)(void *context, const strut_state *state);
  void *watch_context;
} strut_period_map;

/**
 * Creates the map with method and step of `experiment`; the step is adjusted to divide the period.
 */
strut_status strut_period_map_create(const strut_model *model, const strut_experiment *experiment,
                                     int32_t repeats, strut_period_map *map, strut_error *error);
/**
 * Moves y by `repeats` drive periods and removes its travel along the ground. Returns the travel of
 * the measured point [m]; NAN where the motion was lost or the application interrupted.
 */
double strut_period_map_apply(strut_period_map *map, double *y);
/** d = shape of `to` minus that of `from`: the mean shift along the ground is removed. */
void strut_period_map_subtract(const strut_period_map *map, const double *from, const double *to,
                               double *d);
/** Is the interrupt flag set? */
bool strut_period_map_interrupted(const strut_period_map *map);
/** Is the limit of evaluations exceeded? */
bool strut_period_map_spent(const strut_period_map *map);
/** Size of a difference: the largest of positions over the structure's size, and velocities over
    size times 2 pi f. */
double strut_period_map_size(const strut_period_map *map, const double *d);
/** NULL-safe on a zeroed map. */
void strut_period_map_free(strut_period_map *map);

#endif
