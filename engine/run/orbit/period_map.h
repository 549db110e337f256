/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The map of a driven motion from the start of a drive period to its end, by one method.
 *
 * A state here is 2 length + 1 doubles: positions, velocities, and how much longer steps are refined
 * after a touchdown. What travels along the ground is
 * brought back after each period, so that a gait is a fixed point.
 */
#ifndef STRUT_ENGINE_RUN_ORBIT_PERIOD_MAP_H
#define STRUT_ENGINE_RUN_ORBIT_PERIOD_MAP_H

#include <signal.h>

#include "engine/integrate/integrator.h"
#include "engine/run/measure/measure.h"

typedef struct strut_period_map {
  const strut_model *model; /* not its own */
  strut_state *state;
  const strut_integrator *method;
  void *workspace;
  strut_measurement measure;
  double dt, period; /* [s] */
  double time;       /* where an application begins, for drives and loads [s]; set it freely */
  int64_t steps;     /* of one drive period */
  int32_t repeats;   /* drive periods of one application */
  bool travels;
  const volatile sig_atomic_t
      *interrupt;           /* an application ends soon after it is set; may be NULL */
  int64_t most_evaluations; /* and soon after so many, all applications together; 0: any number */
  int64_t evaluations, events, applied; /* so far; applied: drive periods */
} strut_period_map;

/** With the method and step of `experiment`; the step is made to divide the period. */
strut_status strut_period_map_create(const strut_model *model, const strut_experiment *experiment,
                                     int32_t repeats, strut_period_map *map, strut_error *error);
/**
 * y becomes the state `repeats` drive periods later, brought back along the ground. Returns how far
 * the measured point went [m]; NAN where the motion was lost or the application interrupted.
 */
double strut_period_map_apply(strut_period_map *map, double *y);
/** d = shape of `to` less that of `from`: the mean shift along the ground taken out. */
void strut_period_map_subtract(const strut_period_map *map, const double *from, const double *to,
                               double *d);
/** Was it told to stop? */
bool strut_period_map_interrupted(const strut_period_map *map);
/** Has it made all the evaluations it may? */
bool strut_period_map_spent(const strut_period_map *map);
/** Size of a difference: the largest of positions over the structure's size, and velocities over
    size times 2 pi f. */
double strut_period_map_size(const strut_period_map *map, const double *d);
/** NULL-safe on a zeroed map. */
void strut_period_map_free(strut_period_map *map);

#endif
