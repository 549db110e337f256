/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces for single evaluations; integrators have the kernel in their own loops. */
#include <assert.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/forces.h"
#include "engine/forces/forces_kernel.h"
#include "engine/forces/history.h"
#include "engine/forces/mass_damping.h"
#include "engine/forces/rigid.h"
#include "engine/forces/rubbing.h"

void strut_forces_add_rare(const strut_model *model, const strut_state *state, double t,
                           const double *q, const double *velocity) {
  unsigned terms = model->terms;
  if (terms & STRUT_TERM_FEEDBACK)
    strut_maxwell_apply(model, state, q, velocity, state->latest->force);
  if (terms & STRUT_TERM_ACTUATOR_FORCES) strut_actuator_forces_apply(model, state, t, q, velocity);
  if (terms & STRUT_TERM_UNBALANCE) strut_unbalance_apply(model, state, t, velocity);
  if (terms & STRUT_TERM_MASS_DAMPING) strut_mass_damping_apply(model, state, velocity);
  if (terms & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_apply(model, state, t, q, velocity);
  if (terms & STRUT_TERM_SUPPORT_MOTION) strut_support_motion_apply(model, state, t, velocity);
  if (terms & STRUT_TERM_RUBBING) strut_rubbing_add_forces(model, state, q, velocity);
}

STRUT_CLONES
static void sum_once(const strut_model *model, const strut_state *state, double t,
                     const double *restrict q, const double *restrict velocity) {
  if (state->balance)
    forces_sum(model, state, t, q, velocity, STRUT_TERMS_ALL, STRUT_ACCUMULATE_POWERS);
  else
    forces_sum(model, state, t, q, velocity, STRUT_TERMS_ALL, STRUT_ACCUMULATE_NOTHING);
}

void strut_forces_evaluate(const strut_model *model, const strut_state *state, double t,
                           const double *restrict q, const double *restrict velocity) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    state->latest->normal[i] = state->latest->friction[i] =
        0.0; /* the sum fills those that touch, and only them */
  sum_once(model, state, t, q, velocity);
  if (model->rubbing.count) strut_rubbing_show_feet(model, state, q, velocity);
  if (state->rigid) strut_rigid_constrain(model, state, q, velocity);
}

bool strut_forces_show_held(const strut_model *model, const strut_state *state) {
  if (!state->modes.held_normal) return false;
  for (int32_t i = 0; i < model->contacts.count; i++) {
    state->latest->normal[i] = state->modes.held_normal[i];
    state->latest->friction[i] = state->modes.held_friction[i];
  }
  if (model->rubbing.count) strut_rubbing_show_feet(model, state, state->q, state->v);
  return true;
}

void strut_forces_observe(const strut_model *model, const strut_state *state, double t) {
  int64_t evaluations = state->latest->evaluations;
  strut_forces_evaluate(model, state, t, state->q, state->v);
  state->latest->evaluations = evaluations; /* observing is not part of the run's cost */
  strut_forces_show_held(model, state);
}

void strut_forces_acceleration(const strut_model *model, const strut_state *state, double t,
                               const double *restrict q, const double *restrict velocity,
                               double *restrict acceleration) {
  assert(model->mass && "a model without mass is for statics only");
  strut_forces_evaluate(model, state, t, q, velocity);
  divide_by_mass(model, state, acceleration, STRUT_TERMS_ALL);
  if (state->balance && model->terms & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_add_power(model, state, q, velocity, acceleration);
}

/* Of the mass of a member at each of its ends, and between them. */
typedef struct mass_shares {
  double own, other;
} mass_shares;

static mass_shares shares_of(const strut_model *model) {
  bool consistent = model->scene->mass_model == STRUT_MASS_CONSISTENT;
  return consistent ? (mass_shares){1.0 / 3.0, 1.0 / 6.0} : (mass_shares){0.5, 0.0};
}

/* Of masses that rest on their members; returns what is lost. */
static double damp_sliding_masses(const strut_model *model, const double *velocity, double *force) {
  double lost = 0.0;
  for (int32_t i = 0; i < model->sliding.count; i++) {
    const strut_sliding_item *item = &model->sliding.item[i];
    double far = item->start, near = 1.0 - far;
    for (int c = 0; c < 2 && item->signal < 0; c++) {
      uint32_t a = item->at[0] + (uint32_t)c, b = item->at[1] + (uint32_t)c;
      double u = near * velocity[a] + far * velocity[b],
             drag = model->mass_damping * item->mass * u;
      force[a] -= near * drag;
      force[b] -= far * drag;
      lost += drag * u;
    }
  }
  return lost;
}

void strut_mass_damping_apply(const strut_model *model, const strut_state *state,
                              const double *velocity) {
  const strut_member_table *members = &model->members;
  const mass_shares share = shares_of(model);
  double alpha = model->mass_damping, lost = 0.0, *force = state->latest->force;
  for (int c = 0; c < 2; c++, velocity++, force++) {
    for (int32_t i = 0; i < model->node_count; i++) {
      double drag = alpha * model->point_mass[i] * velocity[2 * i];
      force[2 * i] -= drag;
      lost += drag * velocity[2 * i];
    }
    for (int32_t j = 0; j < members->count; j++) {
      double a = velocity[members->from[j]], b = velocity[members->to[j]],
             m = alpha * members->mass[j];
      double at_a = m * (share.own * a + share.other * b);
      double at_b = m * (share.other * a + share.own * b);
      force[members->from[j]] -= at_a;
      force[members->to[j]] -= at_b;
      lost += at_a * a + at_b * b;
    }
  }
  if (model->sliding.count) lost += damp_sliding_masses(model, velocity - 2, force - 2);
  if (!state->balance) return;
  strut_power_add(state->latest->power, STRUT_POWER_MEMBERS, lost);
}

void strut_mass_damping_add(const strut_model *model, const int32_t *row_of, strut_triplets *sum) {
  const strut_member_table *members = &model->members;
  const mass_shares share = shares_of(model);
  if (!(model->terms & STRUT_TERM_MASS_DAMPING)) return;
  for (int c = 0; c < 2; c++, row_of++) {
    for (int32_t i = 0; i < model->node_count; i++)
      if (row_of[2 * i] >= 0)
        strut_triplets_add(sum, row_of[2 * i], row_of[2 * i],
                           model->mass_damping * model->point_mass[i]);
    for (int32_t j = 0; j < members->count; j++) {
      double m = model->mass_damping * members->mass[j];
      int32_t a = row_of[members->from[j]], b = row_of[members->to[j]];
      if (a >= 0) strut_triplets_add(sum, a, a, share.own * m);
      if (b >= 0) strut_triplets_add(sum, b, b, share.own * m);
      if (a >= 0 && b >= 0) strut_triplets_add(sum, a, b, share.other * m);
    }
    for (int32_t i = 0; i < model->sliding.count; i++) {
      const strut_sliding_item *item = &model->sliding.item[i];
      int32_t a = row_of[item->at[0]], b = row_of[item->at[1]];
      double m = model->mass_damping * item->mass, far = item->start, near = 1.0 - far;
      if (a >= 0) strut_triplets_add(sum, a, a, near * near * m);
      if (b >= 0) strut_triplets_add(sum, b, b, far * far * m);
      if (a >= 0 && b >= 0) strut_triplets_add(sum, a, b, near * far * m);
    }
  }
}
