/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forces for whoever asks once; integrators have the kernel in their own loops. */
#include "engine/forces/forces_kernel.h"

#include <assert.h>

#include "engine/forces/rigid.h"

void strut_forces_evaluate(const strut_model *model, strut_state *state, double t,
                           const double *restrict q, const double *restrict v) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    state->normal[i] = state->friction[i] = 0.0; /* the sum fills those that touch, and only them */
  if (state->ledger)
    forces_sum(model, state, t, q, v, true);
  else
    forces_sum(model, state, t, q, v, false);
  if (state->rigid) strut_rigid_constrain(model, state, q, v);
}

void strut_forces_observe(const strut_model *model, strut_state *state, double t) {
  int64_t evaluations = state->evaluations;
  strut_forces_evaluate(model, state, t, state->q, state->v);
  state->evaluations = evaluations; /* looking on is not part of the run's cost */
  for (int32_t i = 0; i < model->contacts.count && state->held_normal; i++) {
    state->normal[i] = state->held_normal[i];
    state->friction[i] = state->held_friction[i];
  }
}

void strut_forces_acceleration(const strut_model *model, strut_state *state, double t,
                               const double *restrict q, const double *restrict v,
                               double *restrict a) {
  assert(model->mass && "a model without mass is for statics only");
  strut_forces_evaluate(model, state, t, q, v);
  mass_kernel(model, state->force, a, state->scratch);
}
