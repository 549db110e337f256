/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: forces and accelerations with the contacts' modes frozen. See located.h.
 */
#ifndef STRUT_ENGINE_INTEGRATE_LOCATED_KERNEL_H
#define STRUT_ENGINE_INTEGRATE_LOCATED_KERNEL_H

#include <math.h>

#include "engine/forces/forces_kernel.h"
#include "engine/integrate/located.h"

/* Normal force of the spring and, where `damped`, the damper, of a contact that touches. */
STRUT_INLINE double located_normal(const strut_contact_entry *e, int8_t damper, double gap,
                                   double into, bool damped) {
  double normal = -e->stiffness * gap;
  if (e->dissipation > 0.0 && damped) {
    normal -= normal * e->dissipation * into;
    return normal > 0.0 || gap >= 0.0 ? normal : 0.0;
  }
  bool acts = damper ? damper > 0 : into < 0.0;
  return damped && acts ? normal - e->damping * into : normal;
}

/* Friction by the mode; a multiplier, which comes later, is 0 here. */
STRUT_INLINE double located_friction(const strut_contact_entry *e, uint8_t mode, int8_t side,
                                     double normal, double slip, double applied) {
  switch (mode) {
    case STRUT_MODE_SLIP:
    case STRUT_MODE_PUSH: return -side * e->mu_kinetic * normal;
    case STRUT_MODE_SLIDE:
      return e->law == STRUT_FRICTION_SMOOTH
                 ? strut_friction_smooth(normal, slip, e->mu_kinetic, e->width)
                 : 0.0;
    case STRUT_MODE_BAND: {
      double most = e->mu_static * normal;
      return applied > most ? -most : applied < -most ? most : -applied;
    }
    default: return 0.0;
  }
}

/* Kinematics of contact i at q, v. */
STRUT_INLINE void located_place(const strut_contact_table *c, int32_t i, const double *restrict q,
                                const double *restrict v, strut_touch *touch) {
  uint32_t at = c->at[i];
  double up = q[at + 1] - c->height;
  touch->gap = q[at] * c->normal[0] + up * c->normal[1];
  touch->into = v[at] * c->normal[0] + v[at + 1] * c->normal[1];
  touch->slip = v[at] * c->tangent[0] + v[at + 1] * c->tangent[1] - c->belt_speed;
}

/* Adds the forces of the closed contacts to `force` and notes them. */
STRUT_INLINE void located_ground(const strut_model *model, const strut_located *l,
                                 const double *restrict q, const double *restrict v,
                                 double *restrict force, bool damped, strut_touch *restrict touch) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    uint32_t at = c->at[i];
    strut_touch *o = &touch[i];
    located_place(c, i, q, v, o);
    o->applied = force[at] * c->tangent[0] + force[at + 1] * c->tangent[1];
    o->normal = located_normal(&c->entry[i], l->damper[i], o->gap, o->into, damped);
    o->friction = located_friction(&c->entry[i], l->mode[i], l->side[i], o->normal, o->slip,
                                   o->applied);
    force[at] += o->friction * c->tangent[0] + o->normal * c->normal[0];
    force[at + 1] += o->friction * c->tangent[1] + o->normal * c->normal[1];
  }
}

/* Rates of speed of the closed contacts from the acceleration. */
STRUT_INLINE void located_rates(const strut_model *model, const strut_located *l,
                                const double *restrict a, strut_touch *restrict touch) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t k = 0; k < l->closed_count; k++) {
    int32_t i = l->closed[k];
    uint32_t at = c->at[i];
    touch[i].into_rate = a[at] * c->normal[0] + a[at + 1] * c->normal[1];
    touch[i].slip_rate = a[at] * c->tangent[0] + a[at + 1] * c->tangent[1];
  }
}

/* The ground's powers, from forces and speeds noted in `touch`; the others are in state->power. */
STRUT_INLINE void located_powers(const strut_model *model, strut_state *state,
                                 const strut_located *l, const strut_touch *restrict touch) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t k = 0; k < l->closed_count; k++) {
    const strut_touch *o = &touch[l->closed[k]];
    double damper = o->normal + c->entry[l->closed[k]].stiffness * o->gap;
    double damped = -damper * o->into, rubbed = -o->friction * o->slip;
    double belt = o->friction * c->belt_speed;
    state->power[STRUT_POWER_CONTACT] += damped;
    state->power[STRUT_POWER_FRICTION] += rubbed;
    state->power[STRUT_POWER_BELT] += belt;
    state->power[STRUT_POWER_MOVED] += fabs(damped) + fabs(rubbed) + fabs(belt);
  }
}

/* Notes the forces of the structure at an end of a step. */
STRUT_INLINE void located_keep(const strut_model *model, const strut_state *state,
                               strut_step_end *end, bool ledger) {
  for (int32_t i = 0; i < model->length; i += STRUT_LANES)
    strut_lanes_store(end->structure + i, strut_lanes_load_pairs(state->force + i));
  for (int p = 0; p < STRUT_POWER_COUNT && ledger; p++)
    end->structure_power[p] = state->power[p];
}

/* From the forces of the structure in state->force to the acceleration. */
STRUT_INLINE void located_close(const strut_model *model, strut_state *state, strut_located *l,
                                const double *restrict q, const double *restrict v,
                                double *restrict a, strut_step_end *end, bool ledger) {
  if (l->closed_count) located_ground(model, l, q, v, state->force, true, end->touch);
  mass_kernel(model, state->force, a, state->scratch);
  if (l->stuck_count) strut_located_hold(model, l, a, end);
  if (ledger && l->closed_count) located_powers(model, state, l, end->touch);
}

/* Acceleration with explicit contact dampers inside a step; contact forces into end->touch. */
STRUT_INLINE void located_acceleration(const strut_model *model, strut_state *state,
                                       strut_located *l, double t, const double *restrict q,
                                       const double *restrict v, double *restrict a,
                                       strut_step_end *end, bool ledger) {
  forces_of_structure(model, state, t, q, v, ledger);
  located_close(model, state, l, q, v, a, end, ledger);
}

/* The same at the end of a step, with all that belongs to that end. */
STRUT_INLINE void located_finish(const strut_model *model, strut_state *state, strut_located *l,
                                 double t, strut_step_end *end, bool ledger) {
  forces_of_structure(model, state, t, end->q, end->v, ledger);
  located_keep(model, state, end, ledger);
  located_close(model, state, l, end->q, end->v, end->a, end, ledger);
  located_rates(model, l, end->a, end->touch);
  for (int p = 0; p < STRUT_POWER_COUNT && ledger; p++) end->power[p] = state->power[p];
}

#endif
