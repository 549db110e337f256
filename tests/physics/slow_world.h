/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Whole scenes once more: all that elements, grounds, drives, sensors and internal states do, by their
 * definitions, dense and slow in long double, with a Runge-Kutta step of its own. It reads a scene's plain
 * numbers; expressions it reads from their texts.
 */
#pragma once

#include "tests/physics/slow_elements.h"

enum {
  SLOW_PLACES = 2 * SLOW_MOST,
  SLOW_ITEMS = 128, /* of members, hinges, signals, contacts each */
  SLOW_STATES = 16
};

/** The expression of a signal, or of the rate of a state, by its name. */
typedef struct slow_text {
  char name[16], text[240];
} slow_text;

typedef struct slow_world {
  const strut_scene *scene;
  const slow_text *texts;
  size_t text_count;
  size_t n, states; /* coordinates; internal states: the scene's, of lags, of Maxwell branches */
  size_t lag_of[SLOW_ITEMS], maxwell_of[SLOW_ITEMS]; /* of signals, of members: which of these */
  long double held[SLOW_ITEMS];                      /* (signals) latest samples */
  /* memory, of members and hinges */
  long double plastic[2][SLOW_ITEMS];
  bool gone[2][SLOW_ITEMS];
  long double rest_angle[SLOW_ITEMS],
      turn[SLOW_ITEMS]; /* of hinges; near `turn` the angle is taken */
  long double material[SLOW_ITEMS]
                      [SLOW_MOST]; /* of a cable's segments; the first one's 0: none yet */
} slow_world;

typedef struct slow_instant {
  long double t, q[SLOW_PLACES], v[SLOW_PLACES], z[SLOW_STATES];
} slow_instant;

typedef struct slow_rates {
  long double force[SLOW_PLACES];                       /* of all terms, on supports too */
  long double normal[SLOW_ITEMS], friction[SLOW_ITEMS]; /* of contacts */
  long double a[SLOW_PLACES], z[SLOW_STATES];
  /* bodies whose axes meet, or contacts of a node that cannot agree whether they stick */
  bool undecided;
} slow_rates;

/** The scene must outlive it. *at: the start of a run. */
void slow_world_begin(slow_world *w, const strut_scene *scene, const slow_text *texts,
                      size_t text_count, slow_instant *at);
/** Puts supports that move where they are at its time. */
void slow_world_place(const slow_world *w, slow_instant *at);
void slow_world_rates(const slow_world *w, const slow_instant *at, slow_rates *rates);
/** One step of the classical Runge-Kutta method, and what a step's end brings: samples, memory. False where
    something was undecided: the instant then stays. */
bool slow_world_step(slow_world *w, slow_instant *at, long double h);

/** Value of a signal, and its rate along the motion. */
long double slow_world_signal(const slow_world *w, const slow_instant *at, int32_t signal);
long double slow_world_signal_rate(const slow_world *w, const slow_instant *at, int32_t signal);
/** Force of a member, at its first node, and of a hinge: all that acts along its strain. */
long double slow_world_member(const slow_world *w, const slow_instant *at, size_t j);

/** Gap and outward normal of a node at p against the surface of a contact at rest. In slow_grounds.c. */
long double slow_ground_gap(const strut_scene *scene, const strut_contact *contact,
                            const long double *p, long double *normal);
