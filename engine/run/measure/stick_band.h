/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Monitors whether Karnopp's stick band is wide enough for the step. A step changes the slip
 * velocity of a node by |a| dt; a narrower band is stepped over, and the node never sticks. Methods
 * that locate events need no width.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_STICK_BAND_H
#define STRUT_ENGINE_RUN_MEASURE_STICK_BAND_H

#include <stdbool.h>

#include "engine/integrate/integrator.h"

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

/** The tie most strained by creeping, where that may release a node; otherwise NULL. */
const strut_band_tie *strut_stick_band_strained(const strut_stick_band *band);

#endif
