/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Whole scenes once more: all that elements, grounds, drives, sensors and internal states do, by their
 * definitions, dense and slow in long double, with a Runge-Kutta step of its own. It reads a scene's plain
 * numbers; expressions it reads from their texts.
 */
#pragma once

#include "engine/model/state.h"
#include "tests/physics/slow_elements.h"

enum {
  SLOW_NODES = 104,
  SLOW_PLACES = 2 * SLOW_NODES,
  SLOW_ITEMS = 256, /* of members, hinges, signals, contacts each */
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

/** Powers [W] of plain scenes, without elements, by STRUT_POWER_...; rates: those there. */
void slow_world_powers(const slow_world *w, const slow_instant *at, const slow_rates *rates,
                       long double *power);
/** Of all nodes along one axis, supports too. */
void slow_world_mass(const strut_scene *scene, long double m[SLOW_NODES][SLOW_NODES]);
/** Value of a signal, and its rate along the motion. */
long double slow_world_signal(const slow_world *w, const slow_instant *at, int32_t signal);
long double slow_world_signal_rate(const slow_world *w, const slow_instant *at, int32_t signal);
/** Force of a member, at its first node, and of a hinge: all that acts along its strain. */
long double slow_world_member(const slow_world *w, const slow_instant *at, size_t j);

/** Gap and outward normal of a node at p against the surface of a contact at rest. In slow_grounds.c. */
long double slow_ground_gap(const strut_scene *scene, const strut_contact *contact,
                            const long double *p, long double *normal);

/* In slow_parts.c. */

/** Value and rate of a signal of the time alone, by its definition; no sum. */
void slow_signal(const strut_signal *signal, long double t, long double *value, long double *rate);
/** lambda_0 and c of a member, over its guides, from the shape as drawn. */
void slow_member_rest(const strut_scene *scene, const strut_member *m, long double *rest,
                      long double *stiffness);
/** x[n] of a (n, n + 1) row by row, whose last column is the right-hand side; a is destroyed. */
void slow_solve(long double *a, size_t n, long double *x);
/** The largest size of n numbers. */
double slow_largest(const long double *x, size_t n);
