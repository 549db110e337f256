/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/events/event_stepping.h"

#include <assert.h>
#include <string.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/surfaces.h"
#include "engine/integrate/events/event_kernel.h"

void strut_surface_measure(const strut_contact_table *contacts, const strut_contact_modes *modes,
                           const strut_ground_motion *motion, int32_t i, const double *positions,
                           const double *velocity, strut_touch *touch, strut_contact_frame *frame) {
  assert(i >= 0 && i < contacts->count);
  int32_t facet = modes->of[i] == STRUT_MODE_OPEN ? -1 : modes->facet[i];
  const strut_contact_pose pose = strut_contact_pose_at(contacts, i, positions, motion, facet);
  const strut_ground_motion *own = strut_contact_motion(contacts, i, motion);
  const double *n = pose.axes.normal, *t = pose.axes.tangent;
  strut_vec2 u = strut_contact_velocity(contacts, i, velocity, motion);
  double into = strut_component(n, u.x, u.y), along = strut_component(t, u.x, u.y);
  frame->axes = pose.axes;
  touch->gap = pose.gap;
  touch->into = into;
  touch->slip = along - strut_contact_belt(contacts, i);
  frame->into_drift = pose.curvature * along * along;
  frame->slip_drift = -pose.curvature * along * into;
  frame->ground_into = frame->ground_along = frame->alone = 0.0;
  if (!own) return;
  frame->ground_into = strut_component(n, own->rate[0], own->rate[1]);
  frame->ground_along = strut_component(t, own->rate[0], own->rate[1]);
  frame->into_drift -= strut_component(n, own->bend[0], own->bend[1]);
  frame->slip_drift -= strut_component(t, own->bend[0], own->bend[1]);
}

double strut_surface_applied(const strut_contact_table *contacts, const strut_active_set *active,
                             int32_t k, const strut_step_end *end) {
  const strut_touch *touch = end->touch;
  int32_t i = active->closed[k];
  const double *t = end->frame[i].axes.tangent;
  double sum = end->frame[i].alone;
  for (int32_t step = -1; step <= 1; step += 2)
    for (int32_t m = k + step; m >= 0 && m < active->closed_count; m += step) {
      int32_t j = active->closed[m];
      if (contacts->at[j] != contacts->at[i]) break;
      const strut_contact_axes *axes = &end->frame[j].axes;
      sum += touch[j].normal * strut_component(t, axes->normal[0], axes->normal[1]) +
             touch[j].friction * strut_component(t, axes->tangent[0], axes->tangent[1]);
    }
  return sum;
}

static bool shares_node(const strut_contact_table *contacts, const strut_active_set *active,
                        int32_t k) {
  uint32_t at = contacts->at[active->closed[k]];
  return (k > 0 && contacts->at[active->closed[k - 1]] == at) ||
         (k + 1 < active->closed_count && contacts->at[active->closed[k + 1]] == at);
}

/* Friction of all closed contacts, until those of one node agree. */
static void find_friction(const strut_model *model, const strut_event_stepper *stepper,
                          const strut_step_end *end) {
  enum { MOST_SWEEPS = 60 };
  const strut_contact_table *contacts = &model->contacts;
  for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
    double changed = 0.0, largest = 0.0;
    for (int32_t k = 0; k < stepper->active.closed_count; k++) {
      int32_t i = stepper->active.closed[k];
      strut_touch *touch = &end->touch[i];
      double before = touch->friction;
      touch->applied = strut_surface_applied(contacts, &stepper->active, k, end);
      touch->friction = friction_in_mode(&stepper->contacts.entry[i], &stepper->modes, i, touch);
      if (!shares_node(contacts, &stepper->active, k)) continue;
      changed = fmax(changed, fabs(touch->friction - before));
      largest = fmax(largest, fabs(touch->friction));
    }
    if (changed <= 1e-15 * largest) return;
  }
}

void strut_surface_add_forces(const strut_model *model, const strut_event_stepper *stepper,
                              const double *positions, const double *velocity, double *force,
                              bool damped, const strut_step_end *end) {
  const strut_contact_table *contacts = &model->contacts;
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    int32_t i = stepper->active.closed[k];
    strut_touch *touch = &end->touch[i];
    strut_contact_frame *frame = &end->frame[i];
    strut_surface_measure(contacts, &stepper->modes, end->motion, i, positions, velocity, touch,
                          frame);
    frame->alone =
        strut_component(frame->axes.tangent, force[contacts->at[i]], force[contacts->at[i] + 1]);
    touch->normal = contact_normal_force(&stepper->contacts.entry[i], stepper->modes.damper[i],
                                         touch->gap, touch->into, damped);
    touch->friction = 0.0;
  }
  find_friction(model, stepper, end);
  for (int32_t k = 0; k < stepper->active.closed_count; k++) {
    const strut_touch *o = &end->touch[stepper->active.closed[k]];
    const strut_contact_axes *axes = &end->frame[stepper->active.closed[k]].axes;
    double *f = force + contacts->at[stepper->active.closed[k]];
    f[0] += o->friction * axes->tangent[0] + o->normal * axes->normal[0];
    f[1] += o->friction * axes->tangent[1] + o->normal * axes->normal[1];
  }
}

void strut_surface_measure_rates(const strut_contact_table *contacts, int32_t i,
                                 const double *acceleration, strut_touch *touch,
                                 const strut_contact_frame *frame) {
  assert(i >= 0 && i < contacts->count);
  const double *at = acceleration + contacts->at[i];
  touch->into_rate = strut_component(frame->axes.normal, at[0], at[1]) + frame->into_drift;
  touch->slip_rate = strut_component(frame->axes.tangent, at[0], at[1]) + frame->slip_drift;
}

double strut_surface_moving_power(const strut_touch *touch, const strut_contact_frame *frame) {
  return touch->normal * frame->ground_into + touch->friction * frame->ground_along;
}

double strut_surface_facet_margin(const strut_contact_table *contacts,
                                  const strut_contact_modes *modes, const strut_step_end *end,
                                  int32_t i, int32_t *nearest) {
  assert(i >= 0 && i < contacts->count);
  const strut_surface *surface = &contacts->surface[contacts->surface_of[i]];
  const double *at = end->q + contacts->at[i];
  const strut_ground_motion *own = strut_contact_motion(contacts, i, end->motion);
  double point[2] = {at[0], at[1]};
  if (own) point[0] -= own->place[0], point[1] -= own->place[1];
  *nearest = modes->facet[i];
  return surface->facets > 1 ? strut_surface_margin(surface, point, modes->facet[i], nearest)
                             : HUGE_VAL;
}

void strut_surface_move(const strut_model *model, const strut_state *state, strut_step_end *end,
                        double t) {
  if (end->motion) strut_grounds_move(model, t + state->time_offset, end->motion);
}

/* A gap that is wider than this at the end of a step is positive at both ends, and so is the cubic between them. */
static double dip_margin(const strut_contact_table *contacts, const strut_event_stepper *stepper,
                         int32_t i, double h) {
  assert(i >= 0 && i < contacts->count);
  const strut_step_end *end[2] = {stepper->now, stepper->next};
  double place[2][2], margin = 0.0;
  for (int e = 0; e < 2; e++) {
    const strut_ground_motion *own = strut_contact_motion(contacts, i, end[e]->motion);
    strut_vec2 u = strut_contact_velocity(contacts, i, end[e]->v, end[e]->motion);
    for (int k = 0; k < 2; k++)
      place[e][k] = end[e]->q[contacts->at[i] + (uint32_t)k] - (own ? own->place[k] : 0.0);
    margin += h * strut_vec2_length(u);
  }
  return margin + strut_distance(place[0], place[1]);
}

int32_t strut_surface_candidates(const strut_model *model, const strut_event_stepper *stepper,
                                 double h, int32_t *list) {
  const strut_active_set *active = &stepper->active;
  const strut_contact_table *contacts = &model->contacts;
  int32_t count = 0, closed = 0;
  for (int32_t first = 0, end; first < contacts->count; first = end) {
    end = strut_contacts_end_of_node(contacts, first);
    int32_t from = count;
    double margin = h > 0.0 ? dip_margin(contacts, stepper, first, h) : 0.0;
    count += strut_contacts_near(contacts, first, end, stepper->next->q, stepper->next->motion,
                                 margin, list + count);
    for (; closed < active->closed_count && active->closed[closed] < end; closed++) {
      int32_t i = active->closed[closed], at = count;
      while (at > from && list[at - 1] > i) at--;
      if (at > from && list[at - 1] == i) continue;
      memmove(list + at + 1, list + at, (size_t)(count++ - at) * sizeof *list);
      list[at] = i;
    }
  }
  return count;
}
