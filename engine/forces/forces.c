/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hot: the sum of the terms in a fixed order. Only what the plan names is evaluated. */
#include "engine/forces/forces.h"

#include <assert.h>

#include "engine/forces/ground_kernel.h"
#include "engine/forces/members_kernel.h"
#include "engine/model/mass_kernel.h"

STRUT_INLINE void start_sum(const strut_model *model, double *restrict force) {
  const double *restrict constant = model->constant_force;
  if (model->plan & STRUT_TERM_CONSTANT)
    for (int32_t i = 0; i < model->length; i += STRUT_LANES)
      strut_lanes_store(force + i, strut_lanes_load(constant + i));
  else
    for (int32_t i = 0; i < model->length; i += STRUT_LANES)
      strut_lanes_store(force + i, (strut_lanes){0});
}

STRUT_INLINE void sum_members(const strut_model *model, strut_state *state,
                              const double *restrict q, const double *restrict v,
                              double *restrict force, bool ledger) {
  member_powers powers = {0};
  members_kernel(model, state, q, v, force, ledger, &powers);
  for (int l = 0; l < STRUT_LANES && ledger; l++) {
    state->power[STRUT_POWER_DRIVE] += powers.drive[l];
    state->power[STRUT_POWER_MEMBERS] += powers.lost[l];
    state->power[STRUT_POWER_MOVED] += powers.moved[l] + powers.lost[l];
  }
}

STRUT_INLINE void sum_all(const strut_model *model, strut_state *state, double t,
                          const double *restrict q, const double *restrict v, bool ledger) {
  unsigned plan = model->plan;
  double *restrict force = state->force;
  state->evaluations++;
  for (int p = 0; p < STRUT_POWER_COUNT && ledger; p++) state->power[p] = 0.0;
  start_sum(model, force);
  if (plan & STRUT_TERM_LOADS) strut_loads_apply(model, state, t, v);
  if (plan & STRUT_TERM_DRIVE) strut_drive_apply(model, state, t);
  if (plan & STRUT_TERM_MEMBERS) sum_members(model, state, q, v, force, ledger);
  if (plan & STRUT_TERM_CONTACT) ground_kernel(model, state, q, v, force, ledger);
}

STRUT_CLONES
static void accelerate(const strut_model *model, strut_state *state, double t,
                       const double *restrict q, const double *restrict v, double *restrict a) {
  sum_all(model, state, t, q, v, false);
  mass_kernel(model, state->force, a, state->scratch);
}

STRUT_CLONES
static void accelerate_with_ledger(const strut_model *model, strut_state *state, double t,
                                   const double *restrict q, const double *restrict v,
                                   double *restrict a) {
  sum_all(model, state, t, q, v, true);
  mass_kernel(model, state->force, a, state->scratch);
}

void strut_forces_acceleration(const strut_model *model, strut_state *state, double t,
                               const double *restrict q, const double *restrict v,
                               double *restrict a) {
  assert(model->mass && "a model without mass is for statics only");
  if (state->ledger)
    accelerate_with_ledger(model, state, t, q, v, a);
  else
    accelerate(model, state, t, q, v, a);
}

void strut_forces_evaluate(const strut_model *model, strut_state *state, double t,
                           const double *restrict q, const double *restrict v) {
  for (int32_t i = 0; i < model->contacts.count; i++)
    state->normal[i] = state->friction[i] = 0.0; /* the step fills those that touch, and only them */
  sum_all(model, state, t, q, v, false);
}
