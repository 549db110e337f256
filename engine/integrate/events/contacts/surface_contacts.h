/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Contacts of surfaces (engine/model/surfaces.h) in methods with events.
 *
 * Within a step a closed contact keeps to one facet, as if its line had no ends; where another facet comes
 * nearer is an event. A contact's axes turn with its node, so they are measured with its gap and speeds.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_CONTACTS_SURFACE_CONTACTS_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_CONTACTS_SURFACE_CONTACTS_H

#include <assert.h>

#include "engine/integrate/events/event_stepping.h"

/** Fills *touch and *frame with the kinematics of contact i at q, v and the motion of the grounds then. */
void strut_surface_measure(const strut_contact_table *contacts, const strut_contact_modes *modes,
                           const strut_ground_motion *motion, int32_t i, const double *positions,
                           const double *velocity, strut_touch *touch, strut_contact_frame *frame);
/** As add_contact_forces, for surfaces. */
void strut_surface_add_forces(const strut_model *model, const strut_event_stepper *stepper,
                              const double *positions, const double *velocity, double *force,
                              bool damped, const strut_step_end *end);
/** Force along the surface of closed contact closed[k] by all else on its node, other contacts included. */
double strut_surface_applied(const strut_contact_table *contacts, const strut_active_set *active,
                             int32_t k, const strut_step_end *end);
/** As the same of event_kernel.h, for one closed contact. */
void strut_surface_measure_rates(const strut_contact_table *contacts, int32_t i,
                                 const double *acceleration, strut_touch *touch,
                                 const strut_contact_frame *frame);
/** Power that the ground's own motion gives to the structure through contact i [W]. */
double strut_surface_moving_power(const strut_touch *touch, const strut_contact_frame *frame);
/** By how much the facet of closed contact i is nearer than every other one at an end [m]. */
double strut_surface_facet_margin(const strut_contact_table *contacts,
                                  const strut_contact_modes *modes, const strut_step_end *end,
                                  int32_t i, int32_t *nearest);
/** The motion of the grounds at time t into an end. */
void strut_surface_move(const strut_model *model, const strut_state *state, strut_step_end *end,
                        double t);

/** 1 / (mass of the node of a contact) along a unit vector [1/kg]. */
static inline double strut_compliance_along(const strut_contact_compliance *compliance,
                                            const double unit[2]) {
  return compliance->own[0] * unit[0] * unit[0] + compliance->own[1] * unit[1] * unit[1];
}

/** Axes of contact i: those of the ground, or, with frames, of its surface where it was measured. */
static inline const strut_contact_axes *strut_axes_of_contact(const strut_contact_table *contacts,
                                                              const strut_contact_frame *frame,
                                                              int32_t i) {
  assert(i >= 0 && i < contacts->count);
  return frame ? &frame[i].axes : &contacts->axes;
}
/**
 * Closed contacts, and open ones that may touch at stepper->next or, with h > 0, within the step of h that ends there.
 * Ascending, into list (contacts); returns their number.
 */
int32_t strut_surface_candidates(const strut_model *model, const strut_event_stepper *stepper,
                                 double h, int32_t *list);

#endif
