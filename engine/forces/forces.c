/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces for whoever asks once; integrators have the kernel in their own loops. */
#include "engine/forces/forces_kernel.h"

#include <assert.h>

#include "engine/forces/drives.h"
#include "engine/forces/history.h"
#include "engine/forces/mass_damping.h"
#include "engine/forces/rigid.h"
#include "engine/forces/unbalance.h"

void strut_forces_add_rare(const strut_model *model, strut_state *state, double t, const double *q,
                           const double *v) {
  unsigned terms = model->terms;
  if (terms & STRUT_TERM_FEEDBACK) strut_maxwell_apply(model, state, q, v, state->latest.force);
  if (terms & STRUT_TERM_ACTUATOR_FORCES) strut_actuator_forces_apply(model, state, t, q, v);
  if (terms & STRUT_TERM_UNBALANCE) strut_unbalance_apply(model, state, t, v);
  if (terms & STRUT_TERM_MASS_DAMPING) strut_mass_damping_apply(model, state, v);
  if (terms & STRUT_TERM_SLIDING_MASS) strut_sliding_masses_apply(model, state, t, q, v);
  if (terms & STRUT_TERM_SUPPORT_MOTION) strut_support_motion_apply(model, state, t, v);
}

STRUT_CLONES
static void sum_once(const strut_model *model, strut_state *state, double t,
                     const double *restrict q, const double *restrict v) {
  if (state->balance)
    forces_sum(model, state, t, q, v, STRUT_TERMS_ALL, STRUT_ACCUMULATE_POWERS);
  else
    forces_sum(model, state, t, q, v, STRUT_TERMS_ALL, STRUT_ACCUMULATE_NOTHING);
}

void strut_forces_evaluate(const strut_model *model, strut_state *state, double t,
                           const double *restrict q, const double *restrict v) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    state->latest.normal[i] = state->latest.friction[i] =
        0.0; /* the sum fills those that touch, and only them */
  sum_once(model, state, t, q, v);
  if (state->rigid) strut_rigid_constrain(model, state, q, v);
}

bool strut_forces_show_held(const strut_model *model, strut_state *state) {
  if (!state->modes.held_normal) return false;
  for (int32_t i = 0; i < model->contacts.count; i++) {
    state->latest.normal[i] = state->modes.held_normal[i];
    state->latest.friction[i] = state->modes.held_friction[i];
  }
  return true;
}

void strut_forces_observe(const strut_model *model, strut_state *state, double t) {
  int64_t evaluations = state->evaluations;
  strut_forces_evaluate(model, state, t, state->q, state->v);
  state->evaluations = evaluations; /* observing is not part of the run's cost */
  strut_forces_show_held(model, state);
}

void strut_forces_acceleration(const strut_model *model, strut_state *state, double t,
                               const double *restrict q, const double *restrict v,
                               double *restrict a) {
  assert(model->mass && "a model without mass is for statics only");
  strut_forces_evaluate(model, state, t, q, v);
  divide_by_mass(model, state, a, STRUT_TERMS_ALL);
  if (state->balance && model->terms & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_add_power(model, state, q, v, a);
}
