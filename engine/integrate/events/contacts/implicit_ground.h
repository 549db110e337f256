/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the ground with implicit dampers, at the end of a step by the trapezoidal rule.
 *
 * v1 = v0 + h/2 (a0 + a1), where a1 contains the damper's force at v1. Contacts of bodies of their
 * own are solved one by one, exactly; contacts of one body are coupled through its mass, and sweeps
 * over them converge fast, since the scaled consistent mass has its eigenvalues in [1/2, 3/2].
 */
#pragma once

#include "engine/integrate/events/event_kernel.h"

/* The damper's force where the node would go into the ground at speed `free` without it. */
STRUT_INLINE double implicit_damper(const strut_contact_entry *contact, double spring, double free,
                                    double half) {
  const strut_law_ground_numbers numbers = strut_contact_numbers(contact);
  return strut_law_ground_implicit_damper(&numbers, spring, free, half, contact->dissipation > 0.0);
}

/* Speed into the ground at the end of the step, given the accelerations so far. */
STRUT_INLINE double final_speed(const strut_contact_table *contacts,
                                const strut_event_stepper *stepper, int32_t i, double h,
                                const double *a1, const strut_contact_frame *frame) {
  uint32_t at = contacts->at[i];
  const double *v = stepper->now->v + at, *a0 = stepper->now->a + at, *a = a1 + at;
  const double *normal = strut_axes_of_contact(contacts, frame, i)->normal;
  double into =
      (v[0] + 0.5 * h * (a0[0] + a[0])) * normal[0] + (v[1] + 0.5 * h * (a0[1] + a[1])) * normal[1];
  return frame ? into - frame[i].ground_into : into;
}

/* The damper of contact i among others of its body; returns the change of its force. */
STRUT_INLINE double solve_damper(const strut_model *model, strut_event_stepper *stepper, int32_t i,
                                 double h, const double *a1, double gap,
                                 const strut_contact_frame *frame) {
  strut_contact_bodies *contacts = &stepper->contacts;
  const strut_contact_table *c = &model->contacts;
  const strut_contact_entry *contact = &contacts->entry[i];
  double answer = frame ? strut_compliance_along(&contacts->compliance[i], frame[i].axes.normal)
                        : contacts->compliance[i].normal;
  double half = 0.5 * h * answer, now = contacts->damped[i];
  double free = final_speed(c, stepper, i, h, a1, frame) - half * now;
  contacts->damped[i] = implicit_damper(contact, -contact->stiffness * gap, free, half);
  return contacts->damped[i] - now;
}

STRUT_INLINE void solve_dampers(const strut_model *model, strut_event_stepper *stepper, double h,
                                double *a1, const strut_touch *restrict touch,
                                const strut_contact_frame *frame) {
  for (int sweep = 0; sweep < 40; sweep++) {
    double changed = 0.0, largest = 0.0;
    for (int32_t k = 0; k < stepper->active.closed_count; k++) {
      int32_t i = stepper->active.closed[k];
      double more = solve_damper(model, stepper, i, h, a1, touch[i].gap, frame);
      const strut_contact_axes *axes = strut_axes_of_contact(&model->contacts, frame, i);
      if (more != 0.0)
        strut_apply_contact_impulse(&stepper->contacts.compliance[i], axes, more, 0.0, a1);
      if (fabs(more) > changed) changed = fabs(more);
      if (fabs(touch[i].normal) > largest) largest = fabs(touch[i].normal);
    }
    if (changed <= 1e-15 * largest || stepper->active.closed_count == 1) break;
  }
}

/* Friction again with the whole normal force, then what holds stuck nodes. */
STRUT_INLINE void solve_friction(const strut_model *model, strut_event_stepper *stepper, double *a1,
                                 strut_touch *restrict touch, const strut_contact_frame *frame) {
  const strut_active_set *active = &stepper->active;
  for (int32_t k = 0; k < active->closed_count; k++) {
    int32_t i = active->closed[k];
    strut_touch *o = &touch[i];
    o->normal = -model->contacts.entry[i].stiffness * o->gap + stepper->contacts.damped[i];
    if (frame) o->applied = strut_surface_applied(&model->contacts, active, k, stepper->next);
    double friction = friction_in_mode(&stepper->contacts.entry[i], &stepper->modes, i, o);
    bool held =
        stepper->modes.of[i] == STRUT_MODE_STICK || stepper->modes.of[i] == STRUT_MODE_CREEP;
    if (held || friction == o->friction) continue;
    strut_apply_contact_impulse(&stepper->contacts.compliance[i],
                                strut_axes_of_contact(&model->contacts, frame, i), 0.0,
                                friction - o->friction, a1);
    o->friction = friction;
  }
  if (active->stuck_count) strut_solve_stick_constraints(model, stepper, a1, stepper->next);
}

/* Coupled contacts: their dampers, then friction with the whole normal force; `a1`: in and out. */
STRUT_INLINE void implicit_ground_together(const strut_model *model, strut_event_stepper *stepper,
                                           double h, double *restrict a1, unsigned terms) {
  strut_touch *restrict touch = stepper->next->touch;
  const strut_contact_frame *frame = frames_of(stepper->next, terms);
  for (int32_t k = 0; k < stepper->active.closed_count; k++)
    stepper->contacts.damped[stepper->active.closed[k]] = 0.0;
  for (int pass = 0; pass < stepper->contacts.passes; pass++) {
    solve_dampers(model, stepper, h, a1, touch, frame);
    solve_friction(model, stepper, a1, touch, frame);
  }
}

/* Gaps, speeds and their rates at the end of the step; with the energy balance the ground's powers. */
STRUT_INLINE void implicit_ground_finish(const strut_model *model, const strut_state *state,
                                         strut_event_stepper *stepper, unsigned terms,
                                         bool balance) {
  const strut_contact_table *contacts = &model->contacts;
  strut_step_end *next = stepper->next;
  strut_contact_frame *frame = frames_of(next, terms);
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    if (frame)
      strut_surface_measure(contacts, &stepper->modes, next->motion, i, next->q, next->v,
                            &next->touch[i], &frame[i]);
    else
      measure_on_line(contacts, i, next->q, next->v, &next->touch[i]);
  }
  measure_contact_rates(model, &stepper->active, next, terms);
  if (balance) add_contact_powers(model, state, &stepper->active, next, terms);
}

/* The force of one level contact, bodies apart; x, y: its node's acceleration without the ground. */
STRUT_INLINE void implicit_ground_touch(const strut_contact_entry *contact,
                                        const strut_contact_compliance *compliance,
                                        const strut_touch *before, strut_touch *touch,
                                        const strut_contact_modes *modes, int32_t i, double h,
                                        double x, double y) {
  uint8_t mode = modes->of[i];
  double spring = -contact->stiffness * touch->gap, half = 0.5 * h * compliance->normal;
  double free = before->into + 0.5 * h * (before->into_rate + y) + half * spring;
  touch->normal = spring + implicit_damper(contact, spring, free, half);
  if (mode == STRUT_MODE_STICK || mode == STRUT_MODE_CREEP)
    touch->friction = -x / compliance->tangent;
  else
    touch->friction = friction_in_mode(contact, modes, i, touch);
}

/*
 * Level ground, and contacts that do not answer to each other: one pass. force, a: of the structure
 * alone; v: predicted velocity, which only the smooth law of friction asks.
 */
STRUT_INLINE void implicit_ground_decoupled(const strut_model *model,
                                            const strut_event_stepper *stepper, double h,
                                            const double *restrict velocity,
                                            const double *restrict force,
                                            double *restrict acceleration) {
  const strut_contact_table *contacts = &model->contacts;
  const strut_touch *restrict before = stepper->now->touch;
  const double *restrict q = stepper->next->q;
  strut_touch *restrict touch = stepper->next->touch;
  for (int32_t k = 0, count = stepper->active.closed_count; k < count; k++) {
    int32_t i = stepper->active.closed[k];
    uint32_t at = contacts->at[i];
    uint8_t mode = stepper->modes.of[i];
    const strut_contact_compliance *compliance = &stepper->contacts.compliance[i];
    strut_touch *o = &touch[i];
    o->gap = q[at + 1] - contacts->height;
    o->slip = velocity[at] - contacts->belt_speed;
    o->applied = force[at];
    implicit_ground_touch(&stepper->contacts.entry[i], compliance, &before[i], o, &stepper->modes,
                          i, h, acceleration[at], acceleration[at + 1]);
    const strut_pair reaction = {o->friction, o->normal};
    const double *restrict xy = compliance->xy;
    for (int32_t j = 0, nodes = compliance->count; j < nodes; j++) {
      double *node = acceleration + compliance->at[j];
      strut_pair_store(node, strut_pair_load(node) + strut_pair_load(xy + 2 * j) * reaction);
    }
    if (mode == STRUT_MODE_STICK || mode == STRUT_MODE_CREEP)
      acceleration[at] = 0.0; /* but for rounding */
  }
}

/* The same where all of them slip, or have no friction. */
STRUT_INLINE void implicit_ground_slides(const strut_model *model,
                                         const strut_event_stepper *stepper, double h,
                                         double *restrict acceleration) {
  const strut_touch *restrict before = stepper->now->touch;
  const double *restrict q = stepper->next->q, height = model->contacts.height;
  strut_touch *restrict touch = stepper->next->touch;
  const strut_sliding_contact *contact = stepper->active.sliding;
  for (const strut_sliding_contact *end = contact + stepper->active.closed_count; contact < end;
       contact++) {
    const strut_touch *b = &before[contact->index];
    strut_touch *o = &touch[contact->index];
    double gap = q[contact->at + 1] - height, spring = -contact->stiffness * gap,
           half = 0.5 * h * contact->answer;
    double free =
        b->into + 0.5 * h * (b->into_rate + acceleration[contact->at + 1]) + half * spring;
    double into = free / (1.0 + half * contact->damping);
    double normal = spring + (into > 0.0 ? 0.0 : -contact->damping * into);
    const strut_pair reaction = {contact->friction * normal, normal};
    o->gap = gap;
    o->normal = normal;
    o->friction = reaction[0];
    for (int32_t j = 0; j < contact->nodes; j++) {
      double *node = acceleration + contact->place[j];
      strut_pair_store(node,
                       strut_pair_load(node) + strut_pair_load(contact->xy + 2 * j) * reaction);
    }
  }
}

/* As implicit_ground_finish, on level ground. */
STRUT_INLINE void implicit_ground_leave(const strut_model *model, const strut_state *state,
                                        const strut_event_stepper *stepper, bool balance) {
  const strut_contact_table *contacts = &model->contacts;
  const double *restrict v = stepper->next->v, *restrict a = stepper->next->a;
  double contact = 0.0, friction = 0.0, belt = 0.0, exchanged = 0.0;
  for (int32_t k = 0, count = stepper->active.closed_count; k < count; k++) {
    int32_t i = stepper->active.closed[k];
    uint32_t at = contacts->at[i];
    strut_touch *touch = &stepper->next->touch[i];
    touch->into = v[at + 1];
    touch->slip = v[at] - contacts->belt_speed;
    touch->into_rate = a[at + 1];
    touch->slip_rate = a[at];
    if (!balance) continue;
    double damped =
        -(touch->normal + stepper->contacts.entry[i].stiffness * touch->gap) * touch->into;
    double rubbed = -touch->friction * touch->slip,
           carried = touch->friction * contacts->belt_speed;
    contact += damped, friction += rubbed, belt += carried;
    exchanged += fabs(damped) + fabs(rubbed) + fabs(carried);
  }
  if (!balance) return;
  double *low = state->latest->power + STRUT_POWER_DRIVE,
         *high = state->latest->power + STRUT_POWER_CONTACT;
  strut_lanes_store(low, strut_lanes_load(low) + (strut_lanes){0.0, 0.0, belt, 0.0});
  strut_lanes_store(high,
                    strut_lanes_load(high) + (strut_lanes){contact, friction, exchanged, 0.0});
}
