/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the sum of the terms in a fixed order, and the acceleration it gives, as one inlined piece.
 *
 * An integrator includes this to have one copy in its own loop. Only what the terms names is
 * evaluated.
 */
#ifndef STRUT_ENGINE_FORCES_FORCES_KERNEL_H
#define STRUT_ENGINE_FORCES_FORCES_KERNEL_H

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/feedback.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/drives/support_motion.h"
#include "engine/forces/elements.h"
#include "engine/forces/forces.h"
#include "engine/forces/ground_kernel.h"
#include "engine/forces/members_kernel.h"
#include "engine/forces/step_balance.h"
#include "engine/forces/surfaces.h"
#include "engine/model/mass_kernel.h"

STRUT_LOOP void forces_start(const strut_model *model, double *restrict force) {
  const double *restrict constant = model->constant_force;
  if (model->terms & STRUT_TERM_CONSTANT)
    for (int32_t i = 0; i < model->length; i += STRUT_LANES)
      strut_lanes_store(force + i, strut_lanes_load(constant + i));
  else
    for (int32_t i = 0; i < model->length; i += STRUT_LANES)
      strut_lanes_store(force + i, (strut_lanes){0});
}

STRUT_LOOP void forces_of_members(const strut_model *model, const strut_state *state,
                                  const double *restrict q, const double *restrict v,
                                  double *restrict force, strut_accumulation balance) {
  four_member_powers powers;
  powers.drive = powers.exchanged = powers.lost = (strut_lanes){0};
  members_kernel(model, state, q, v, force, balance != STRUT_ACCUMULATE_NOTHING, &powers);
  if (!balance) return;
  if (balance == STRUT_ACCUMULATE_LANES) {
    strut_accumulate_members(state->latest->accumulated, &powers);
    return;
  }
  double *power = state->latest->power, drive = 0.0, lost = 0.0,
         exchanged = power[STRUT_POWER_EXCHANGED];
  for (int l = 0; l < STRUT_LANES; l++) {
    drive += powers.drive[l];
    lost += powers.lost[l];
    exchanged += powers.exchanged[l] + powers.lost[l];
  }
  /* whole vectors, since whole vectors are read next: one gathered from parts would have to wait */
  strut_lanes_store(power + STRUT_POWER_DRIVE,
                    (strut_lanes){drive, power[STRUT_POWER_LOAD], 0.0, lost});
  strut_lanes_store(power + STRUT_POWER_CONTACT, (strut_lanes){0.0, 0.0, exchanged, 0.0});
}

/* In forces.c, not inlined: what the terms of STRUT_TERMS_RARE add to the state's force, but the ground's. */
void strut_forces_add_rare(const strut_model *model, const strut_state *state, double t,
                           const double *q, const double *v);

/* All forces but the ground's. allowed: which ones the model may have, see STRUT_TERMS_RARE. */
STRUT_LOOP void forces_of_structure(const strut_model *model, const strut_state *state, double t,
                                    const double *restrict q, const double *restrict v,
                                    unsigned allowed, strut_accumulation balance) {
  unsigned terms = model->terms & allowed;
  double *restrict force = state->latest->force;
  state->latest->evaluations++;
  bool powers = balance == STRUT_ACCUMULATE_POWERS || (balance && terms & ~STRUT_TERMS_IN_LANES);
  for (int p = 0; p < STRUT_POWER_COUNT && powers; p++) state->latest->power[p] = 0.0;
  forces_start(model, force);
  if (terms & STRUT_TERM_FEEDBACK) {
    strut_feedback_apply(model, state, t, q, v);
    strut_feedback_add_rates(model, state, t, v, force);
  }
  if (terms & STRUT_TERM_LOADS) strut_loads_apply(model, state, t, v);
  if ((terms & STRUT_TERM_DRIVE) && t != state->latest->drive_time)
    strut_drive_apply(model, state, t);
  if (terms & STRUT_TERM_MEMBERS) forces_of_members(model, state, q, v, force, balance);
  if (terms & STRUT_TERM_ELEMENTS) strut_elements_add_forces(model, state, q, v, force);
  if (terms & STRUT_TERMS_RARE) strut_forces_add_rare(model, state, t, q, v);
}

STRUT_LOOP void forces_sum(const strut_model *model, const strut_state *state, double t,
                           const double *restrict q, const double *restrict v, unsigned allowed,
                           strut_accumulation balance) {
  forces_of_structure(model, state, t, q, v, allowed, balance);
  if (model->terms & STRUT_TERM_CONTACT)
    ground_kernel(model, state, q, v, state->latest->force, balance);
  else if (model->terms & allowed & STRUT_TERM_SURFACES)
    strut_surfaces_add_forces(model, state, q, v);
}

/* a = M^-1 force, M with the masses that slide. */
STRUT_LOOP void divide_by_mass(const strut_model *model, const strut_state *state,
                               double *restrict a, unsigned allowed) {
  mass_kernel(model, state->latest->force, a, state->buffers->mass_solve);
  if (model->terms & allowed & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_correct(model, state, a);
}

/* See strut_forces_acceleration. */
STRUT_LOOP void forces_kernel(const strut_model *model, const strut_state *state, double t,
                              const double *restrict q, const double *restrict v,
                              double *restrict a, unsigned allowed, strut_accumulation balance) {
  forces_sum(model, state, t, q, v, allowed, balance);
  divide_by_mass(model, state, a, allowed);
  if (balance && model->terms & allowed & STRUT_TERM_SLIDING_MASS)
    strut_sliding_masses_add_power(model, state, q, v, a);
}

#endif
