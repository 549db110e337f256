/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Monitors of a run: does its step stay stable, and do contacts that should stick pass over the stick band? */
#pragma once

#include <stdbool.h>

#include "engine/integrate/integrator.h"

/*
 * Monitors during a run whether the structure has become too stiff for the step.
 *
 * Every few steps two or three products with the tangent matrices of the present shape and the
 * touching contacts improve an estimate of the stiffest motion (power iteration). Only where it
 * indicates that the step may be too large is the limit of the shape computed as at the start. The
 * monitor reads the state and changes nothing. Rigid bars and methods without a limit are not
 * monitored.
 */

/** The largest eigenvalue of M^-1 (h^2 K stiff + h D damp): at 1 or more the step may be too large. */
typedef struct strut_monitored_set {
  double stiff, damp;
  double *motion, *image; /* (length) */
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
  double *divided, *scratch; /* (length) */
  double *shape, *rest;      /* (length), (slots) at the last sample */
  double known_limit;        /* last computed limit [s] */
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

/*
 * At which frequency a structure vibrates, and how fast its dampers end that, from its motion: Rayleigh
 * quotients v'Kv / v'Mv and v'Dv / v'Mv of its velocities with the tangent matrices, in the mean over
 * samples. Of several modes they are means weighted with kinetic energy, of squares of the frequencies.
 */
typedef struct strut_motion_frequency {
  double *image[2]; /* (length) */
  double curvature; /* sum of v'Kv [J/s^2] */
  double damping;   /* sum of v'Dv [J/s] */
  double movement;  /* sum of v'Mv [J] */
  int64_t samples;
} strut_motion_frequency;

/** Allocates in the arena of the state. False: out of memory. */
bool strut_motion_frequency_create(const strut_model *model, strut_state *state,
                                   strut_motion_frequency *frequency);
/** Samples between steps a motion of that kinetic energy [J], with the latest rest lengths. */
void strut_motion_frequency_sample(const strut_model *model, const strut_state *state,
                                   double kinetic, strut_motion_frequency *frequency);

/*
 * Monitors whether Karnopp's stick band is wide enough for the step. A step changes the slip
 * velocity of a node by |a| dt; a narrower band is stepped over, and the node never sticks. Methods
 * that locate events need no width.
 */

/** Statistics of one contact. */
typedef struct strut_stick_band_monitor {
  int32_t sliding; /* samples at which it touched and slid */
  double change;   /* sum of |a| dt along the ground over them [m/s] */
} strut_stick_band_monitor;

/**
 * A member between two nodes that stick: within their bands each creeps at its own speed, which
 * strains the member. Where static friction is the stronger, one node may then slip too early.
 */
typedef struct strut_band_tie {
  int32_t member, contact[2];
  bool held;     /* both stuck at the latest sample */
  double length; /* length at that time [m] */
  double force;  /* force from creeping since both stick [N] */
  double worst;  /* largest so far over the friction that holds the weaker node [1] */
} strut_band_tie;

typedef struct strut_stick_band {
  double step; /* [s] */
  int samples;
  strut_stick_band_monitor *contacts; /* (contacts); NULL: nothing to monitor */
  double *a, *scratch;                /* (length) */
  strut_band_tie *ties;               /* (tie_count) */
  int32_t tie_count;
  int64_t last; /* step of the latest sample */
} strut_stick_band;

/**
 * Width that a contact of the model needs with a step, as estimated before a run: the deceleration
 * mu_kinetic |g_n| of a node sliding alone, times the step [m/s]. 0 where its law or the method
 * needs none.
 */
STRUT_API double strut_stick_band_needed(const strut_model *model, const strut_integrator *method,
                                         int32_t contact, double step);

/** Allocates in the arena of the state. False: out of memory. */
bool strut_stick_band_create(const strut_model *model, strut_state *state,
                             const strut_integrator *method, double step, strut_stick_band *band);
/** Samples between steps: slip velocities, and accelerations from the latest forces. */
void strut_stick_band_sample(const strut_model *model, const strut_state *state,
                             strut_stick_band *band);
/**
 * Mean |a| dt of a contact while it slid [m/s], where its band is so much narrower that the answer
 * changes: below half of it where static friction is the stronger, else below a hundredth;
 * otherwise 0.
 */
double strut_stick_band_missed(const strut_model *model, const strut_stick_band *band,
                               int32_t contact);

/**
 * How fast internal states and lags settle by themselves while the structure stands, at most [1/s]; 0: there is
 * none. *fastest: the one that does, lags counted on. `work`: (3 length) of the model.
 */
double strut_states_rate(const strut_model *model, strut_state *state, double t, double *work,
                         int32_t *fastest);

/** The tie most strained by creeping, where that may release a node; otherwise NULL. */
const strut_band_tie *strut_stick_band_strained(const strut_stick_band *band);
