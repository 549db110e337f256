/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Watches, while a run goes on, whether the structure has become too stiff for the step.
 *
 * Every few steps two or three products with the tangent matrices of the present shape and the
 * contacts that touch improve an estimate of the stiffest motion (power iteration). Only where that
 * says that the step may be too large is the limit of the shape computed as at the start. The guard
 * reads the state and changes nothing. Rigid bars and methods without a limit are not watched.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_STEP_LIMIT_MONITOR_H
#define STRUT_ENGINE_RUN_MEASURE_STEP_LIMIT_MONITOR_H

#include "engine/integrate/integrator.h"

/** The largest eigenvalue of M^-1 (h^2 K stiff + h D damp): at 1 or more the step may be too large. */
typedef struct strut_monitored_set {
  double stiff, damp;
  double *motion;         /* (length) */
  double weight;          /* of the motion in the mass; 0: not known */
  double strength, known; /* as of the last look, and when the limit was computed last */
  double alarm;           /* the strength at which it must be computed again */
} strut_monitored_set;

typedef struct strut_step_limit_monitor {
  const strut_integrator *method;
  double step;         /* [s] */
  int64_t every, next; /* steps between looks; the step of the next one */
  int count;           /* of watches: 2 with RK4, which K and D bind apart */
  strut_monitored_set watch[2];
  double *image, *divided, *scratch; /* (length) */
  double *shape, *rest;              /* (length), (slots) at the look before */
  double known_limit;                /* as computed last [s] */
  uint64_t noise;
  bool below;                 /* now */
  double grown;               /* logarithm of what a motion has grown by since it is, at least */
  int64_t last;               /* step of the last look */
  double lowest, lowest_time; /* [s]; 0: never below the step */
  double first_time;          /* when it first was [s] */
  int64_t steps_below;
  bool hopeless; /* it was below for so long that the motion is not the structure's */
} strut_step_limit_monitor;

/** Room and a first estimate, in the state's arena. False: out of memory. */
bool strut_step_limit_monitor_create(const strut_model *model, strut_state *state,
                                     const strut_integrator *method, double step,
                                     strut_step_limit_monitor *guard);
/** To be called between steps, at or after `next`. */
void strut_step_limit_monitor_sample(const strut_model *model, const strut_state *state,
                                     strut_step_limit_monitor *guard);

/** After something went wrong: was the limit below the step now or at the last look? Notes it. */
void strut_step_limit_monitor_check(const strut_model *model, const strut_state *state,
                                    strut_step_limit_monitor *guard);
/** STRUT_DIVERGED, with what the guard knows of it; start_limit: the limit at the start [s]. */
strut_status strut_step_limit_monitor_fail(const strut_step_limit_monitor *guard,
                                           const strut_state *state, double start_limit,
                                           strut_error *error);
/** The limit of the shape at the last look [s]; HUGE_VAL where nothing is watched. */
double strut_step_limit_monitor_last_limit(const strut_model *model,
                                           const strut_step_limit_monitor *guard);

#endif
