/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Events of large structures taken locally: see docs/numerics.md.
 *
 * A step of the whole structure is taken once, with modes frozen. Where its end contradicts a mode, a region
 * about that place is stepped again from event to event, while its halo moves as in the step of the whole.
 * The region is also stepped without events; what both differ by is added to the step of the whole.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_REGIONS_LOCAL_EVENTS_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_REGIONS_LOCAL_EVENTS_H

#include "engine/integrate/events/event_stepping.h"

/** Smaller structures are stepped as a whole, unless the settings say otherwise. */
enum { STRUT_LOCAL_FROM = 512 };

/** In the state's arena; l->local stays NULL where events are taken by the whole structure. */
strut_status strut_local_events_create(const strut_model *model, strut_state *state,
                                       const strut_integrator_settings *settings,
                                       strut_event_stepper *l);
/**
 * l->next is the end of the step of h [s] from l->now, at time t, with something that contradicts a mode.
 * True: all events of the step have been taken, and l->next, l->gained and the modes are those of its end.
 * False: nothing has changed but scratch; the whole structure must be stepped.
 */
bool strut_local_events_take(const strut_model *model, strut_state *state, strut_event_stepper *l,
                             double t, double h, double dt);

/* ---- what the stepper of a region does in its own way: l->within is not NULL ---- */

/** As evaluate_now of contact_modes.c. */
void strut_local_evaluate(const strut_model *model, strut_state *state, strut_event_stepper *l,
                          double t);
/** Ends of a region's steps are shifted by up to this part of them. */
static const double STRUT_LOCAL_SHIFT = 1e-3;
/**
 * l->next, the end of a step of `from` from l->now at time t, becomes that of a step of `to`: by the
 * polynomial that has speeds and accelerations of both ends, whose error there is far below that of the step.
 */
void strut_local_shift(const strut_model *model, strut_state *state, strut_event_stepper *l,
                       double t, double from, double to);
/** Factors T' M^-1 T of the stuck contacts of the region. */
void strut_local_factor(const strut_model *model, strut_event_stepper *l);
/** As strut_solve_stick_constraints. */
void strut_local_hold(const strut_model *model, strut_event_stepper *l, double *a,
                      strut_step_end *end);

#endif
