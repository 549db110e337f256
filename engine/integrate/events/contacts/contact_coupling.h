/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Many contacts of one structure: how they answer to each other, without the nodes between.
 *
 * With coupled masses a force on one contact accelerates hundreds of nodes, of which the contacts are few. What
 * couples contacts is therefore solved for among them alone, and the structure then accelerates once, by one
 * solution with the factor of the mass matrix.
 */
#pragma once

#include "engine/integrate/events/event_stepping.h"

/** Models with fewer contacts are served as well by the compliances themselves. */
enum { STRUT_MANY_CONTACTS = 64 };

struct strut_contact_coupling {
  /* row i: contacts whose nodes answer to a force on contact i, itself included */
  size_t *start;          /* (contacts + 1) */
  int32_t *other;         /* (start[contacts]) */
  double *xy;             /* (start[contacts], 2) x per unit force in x, y per unit in y [1/kg] */
  double *into, *along;   /* (contacts) accelerations of nodes along the ground's axes [m/s^2] */
  double *normal, *shear; /* (contacts) forces that `a` does not contain yet [N] */
  double *force, *answer, *work;     /* (length) of one solution with the mass matrix */
  int32_t *place;                    /* (contacts) 1 + index of a stuck contact; else 0 */
  int32_t *first;                    /* (stuck_room) columns where the rows of the factor begin */
  int32_t *factored, factored_count; /* (stuck_room) the stuck contacts it belongs to */
};

/** In the state's arena, after the compliances. stepper->contacts.coupling stays NULL where it does not pay. */
strut_status strut_contact_coupling_create(const strut_model *model, strut_state *state,
                                           strut_event_stepper *stepper);
/** Factors T' M^-1 T of the stuck contacts, unless it is that of the latest ones. */
void strut_contact_coupling_factor(const strut_model *model, strut_event_stepper *stepper);
/** x becomes (T' M^-1 T)^-1 x. */
void strut_contact_coupling_solve(const strut_event_stepper *stepper, double *vector);
/** a += M^-1 of forces x (stuck_count) along the ground on the stuck contacts. */
void strut_contact_coupling_push(const strut_model *model, const strut_event_stepper *stepper,
                                 const double *vector, double *acceleration);
/** As implicit_ground_together; a1 contains the springs, and friction without the dampers' part. */
void strut_contact_coupling_ground(const strut_model *model, strut_event_stepper *stepper, double h,
                                   double *a1);
