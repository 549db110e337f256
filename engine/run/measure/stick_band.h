/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Is Karnopp's band wide enough to be met? A step changes a node's slip by |a| dt; a band narrower
 * than that is stepped over, and the node never sticks. Methods that locate events need no width.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_STICK_BAND_H
#define STRUT_ENGINE_RUN_MEASURE_STICK_BAND_H

#include <stdbool.h>

#include "engine/integrate/integrator.h"

/** What is known of one contact. */
typedef struct strut_stick_band_monitor {
  int32_t sliding; /* looks at which it touched and slid */
  double change;   /* |a| dt along the ground, summed over them [m/s] */
} strut_stick_band_monitor;

/**
 * A member between two nodes that stick: in its band each creeps at a speed of its own, which strains
 * the member though nothing moves. Where static friction is the stronger, that may let go of one.
 */
typedef struct strut_band_tie {
  int32_t member, contact[2];
  bool held;     /* both stuck at the latest look */
  double length; /* then [m] */
  double force;  /* from creeping since they stick [N] */
  double worst;  /* the largest so far, as a part of what holds the weaker node [1] */
} strut_band_tie;

typedef struct strut_stick_band {
  double step; /* [s] */
  int looks;
  strut_stick_band_monitor *watch; /* (contacts); NULL: nothing to watch */
  double *a, *scratch;             /* (length) */
  strut_band_tie *ties;            /* (tie_count) */
  int32_t tie_count;
  int64_t last; /* step of the latest look */
} strut_stick_band;

/**
 * The width that a contact of the model needs with a step as far as can be told before a run: the
 * deceleration mu_kinetic |g_n| of what slides alone, times the step [m/s]. 0 where its law or the
 * method needs none.
 */
STRUT_API double strut_stick_band_needed(const strut_model *model, const strut_integrator *method,
                                         int32_t contact, double step);

/** Room in the state's arena. False: out of memory. */
bool strut_stick_band_create(const strut_model *model, strut_state *state,
                             const strut_integrator *method, double step, strut_stick_band *band);
/** Between steps, now and then: reads slip, and from the last forces the acceleration. */
void strut_stick_band_sample(const strut_model *model, const strut_state *state,
                             strut_stick_band *band);
/**
 * The mean |a| dt of a contact while it slid [m/s], where its band is so much narrower that this
 * changes the answer: half of that where static friction is the stronger, else a hundredth; else 0.
 */
double strut_stick_band_missed(const strut_model *model, const strut_stick_band *band,
                               int32_t contact);

/** The tie that creeping strains most, where that is enough to let go of a node; else NULL. */
const strut_band_tie *strut_stick_band_strained(const strut_stick_band *band);

#endif
