/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Monitors during a run whether the structure has become too stiff for the step.
 *
 * Every few steps two or three products with the tangent matrices of the present shape and the
 * touching contacts improve an estimate of the stiffest motion (power iteration). Only where it
 * indicates that the step may be too large is the limit of the shape computed as at the start. The
 * monitor reads the state and changes nothing. Rigid bars and methods without a limit are not
 * monitored.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_STEP_LIMIT_MONITOR_H
#define STRUT_ENGINE_RUN_MEASURE_STEP_LIMIT_MONITOR_H

#include "engine/integrate/integrator.h"

/** The largest eigenvalue of M^-1 (h^2 K stiff + h D damp): at 1 or more the step may be too large. */
typedef struct strut_monitored_set {
  double stiff, damp;
  double *motion;         /* (length) */
  double weight;          /* squared norm of the motion in the mass; 0: unknown */
  double strength, known; /* eigenvalue at the last sample, and when the limit was last computed */
  double alarm;           /* strength at which the limit must be recomputed */
} strut_monitored_set;

typedef struct strut_step_limit_monitor {
  const strut_integrator *method;
  double step;         /* [s] */
  int64_t every, next; /* steps between samples; step of the next one */
  int count;           /* sets: 2 with RK4, which K and D limit separately */
  strut_monitored_set set[2];
  double *image, *divided, *scratch; /* (length) */
  double *shape, *rest;              /* (length), (slots) at the last sample */
  double known_limit;                /* last computed limit [s] */
  uint64_t noise;
  bool below;                 /* the limit is below the step */
  double grown;               /* logarithm of the least growth of a motion since then */
  int64_t last;               /* step of the last sample */
  double lowest, lowest_time; /* lowest limit and its time [s]; 0: never below the step */
  double first_time;          /* time of the first violation [s] */
  int64_t steps_below;
  bool motion_lost; /* below for so long that the motion is numerical */
} strut_step_limit_monitor;

/** Allocates in the arena of the state and makes a first estimate. False: out of memory. */
bool strut_step_limit_monitor_create(const strut_model *model, strut_state *state,
                                     const strut_integrator *method, double step,
                                     strut_step_limit_monitor *monitor);
/** Samples between steps, at or after `next`. */
void strut_step_limit_monitor_sample(const strut_model *model, const strut_state *state,
                                     strut_step_limit_monitor *monitor);

/**
 * After a failure: records a violation if the limit is below the step now or was at the last
 * sample.
 */
void strut_step_limit_monitor_check(const strut_model *model, const strut_state *state,
                                    strut_step_limit_monitor *monitor);
/** Reports STRUT_DIVERGED with the recorded violation; start_limit: limit at the start [s]. */
strut_status strut_step_limit_monitor_fail(const strut_step_limit_monitor *monitor,
                                           const strut_state *state, double start_limit,
                                           strut_error *error);
/** Limit of the shape at the last sample [s]; HUGE_VAL where nothing is monitored. */
double strut_step_limit_monitor_last_limit(const strut_model *model,
                                           const strut_step_limit_monitor *monitor);

#endif
