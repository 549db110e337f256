/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Derivative of the acceleration to positions and velocities with the contacts' modes frozen.
 *
 * It is dense, over the free coordinates. Members and contacts on one straight ground are differentiated
 * by hand; elements and other forces by central differences of the forces with their modes frozen.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_LOCATION_MODE_TANGENT_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_LOCATION_MODE_TANGENT_H

#include "engine/integrate/events/event_stepping.h"

typedef struct strut_mode_tangent {
  int32_t n, width;    /* free coordinates; 2 n, rounded up to whole vectors */
  int32_t *coordinate; /* (n) index into coordinate arrays */
  int32_t *row_of;     /* (length) index of a free coordinate, or -1 */
  double *inverse;     /* (n, n) M^-1 */
  double *force; /* (n, width) derivative of the forces: to n positions, then to n velocities */
  double *rate;  /* (n, width) of the accelerations */
  bool plain;    /* members alone give forces beside the ground */
  /* contacts that stick: accelerations and speeds along functional (held, n) are 0; response (held, n)
     removes them, and functional i of response k is 1 for i = k, else 0 */
  int32_t held;
  double *functional, *response;
  double *place, *speed, *pull; /* (length), (length), (width) scratch */
} strut_mode_tangent;

/** Are positions and velocities of the free coordinates the whole state of the model, with forces that a
    tangent of this kind has? */
bool strut_mode_tangent_possible(const strut_model *model);
/** In the state's arena. NULL: out of memory. */
strut_mode_tangent *strut_mode_tangent_create(const strut_model *model, strut_state *state);
/** Finds the contacts that stick, after modes have changed. */
void strut_mode_tangent_hold(const strut_model *model, const strut_event_stepper *stepper,
                             strut_mode_tangent *tangent);
/** Removes from the rows x (n, width) what sticking contacts do not allow. */
void strut_mode_tangent_project(const strut_mode_tangent *tangent, double *vector, int32_t width);
/** Fills `rate` at time t, q and v (length). */
void strut_mode_tangent_evaluate(const strut_model *model, strut_state *state,
                                 const strut_event_stepper *stepper, double t,
                                 const double *positions, const double *velocity,
                                 strut_mode_tangent *tangent);

#endif
