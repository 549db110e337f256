/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the energy balance of a Runge-Kutta step. The powers of its evaluations are added up lane by lane,
 * those with the same weight together; only at the end of the step are lanes added up, once for all
 * evaluations. Verlet and Euler integrate the powers of single evaluations.
 */
#ifndef STRUT_ENGINE_FORCES_STEP_BALANCE_H
#define STRUT_ENGINE_FORCES_STEP_BALANCE_H

#include "engine/forces/members_kernel.h"

/* Terms whose powers are in lanes, or that have none. */
#define STRUT_TERMS_IN_LANES                                                                       \
  ((unsigned)(STRUT_TERM_MEMBERS | STRUT_TERM_DAMPING | STRUT_TERM_SLACK | STRUT_TERM_DRIVE |      \
              STRUT_TERM_CONSTANT | STRUT_TERM_CONTACT | STRUT_TERM_FRICTION | STRUT_TERM_SLOPE |  \
              STRUT_TERM_SOLVE | STRUT_TERM_LAWS | STRUT_TERM_DIRECTION))

STRUT_INLINE void strut_accumulate_members(strut_power_lanes *to,
                                           const four_member_powers *powers) {
  strut_lanes_store(to->drive, strut_lanes_load(to->drive) + powers->drive);
  strut_lanes_store(to->lost, strut_lanes_load(to->lost) + powers->lost);
  strut_lanes_store(to->driven, strut_lanes_load(to->driven) + powers->exchanged);
}

/* The weighted sum of lanes that both sides have at these places. */
STRUT_INLINE strut_lanes step_balance_lanes(const double *once, const double *twice) {
  return strut_lanes_load(once) + 2.0 * strut_lanes_load(twice);
}
STRUT_INLINE strut_lanes step_balance_contacts(const double *once, const double *twice) {
  return step_balance_lanes(once, twice) +
         step_balance_lanes(once + STRUT_LANES, twice + STRUT_LANES);
}
STRUT_INLINE void step_balance_add(double *work, double sixth, strut_lanes x) {
  strut_pair pair = __builtin_shufflevector(x, x, 0, 1) + __builtin_shufflevector(x, x, 2, 3);
  *work += sixth * (pair[0] + pair[1]);
}

/* Written out: of loops the compiler would make a call. */
STRUT_INLINE void step_balance_clear(double *lanes) { strut_lanes_store(lanes, (strut_lanes){0}); }
STRUT_INLINE void step_balance_clear_contacts(double *lanes) {
  step_balance_clear(lanes);
  step_balance_clear(lanes + STRUT_LANES);
}
STRUT_INLINE void step_balance_clear_side(const strut_model *model, strut_power_lanes *to) {
  step_balance_clear(to->drive);
  step_balance_clear(to->lost);
  step_balance_clear(to->driven);
  if (!(model->terms & STRUT_TERM_CONTACT)) return;
  step_balance_clear_contacts(to->minus_damped);
  step_balance_clear_contacts(to->minus_rubbed);
  step_balance_clear_contacts(to->turnover);
  if (model->contacts.belt_speed != 0.0) step_balance_clear_contacts(to->belt);
}
STRUT_INLINE void strut_step_balance_begin(const strut_model *model, const strut_state *state) {
  step_balance_clear_side(model, &state->latest->lanes[0]);
  step_balance_clear_side(model, &state->latest->lanes[1]);
}

/* Adds the works of a step; sixth: of its size [s]. */
STRUT_INLINE void strut_step_balance_end(const strut_model *model, strut_state *state,
                                         double sixth) {
  const strut_power_lanes *once = &state->latest->lanes[0], *twice = &state->latest->lanes[1];
  double *work = state->work;
  strut_lanes exchanged = {0};
  if (model->terms & STRUT_TERM_MEMBERS) {
    strut_lanes lost = step_balance_lanes(once->lost, twice->lost);
    step_balance_add(&work[STRUT_POWER_DRIVE], sixth,
                     step_balance_lanes(once->drive, twice->drive));
    step_balance_add(&work[STRUT_POWER_MEMBERS], sixth, lost);
    exchanged = step_balance_lanes(once->driven, twice->driven) + lost;
  }
  if (model->terms & STRUT_TERM_CONTACT) {
    strut_lanes damped = step_balance_contacts(once->minus_damped, twice->minus_damped);
    step_balance_add(&work[STRUT_POWER_CONTACT], -sixth, damped);
    step_balance_add(&work[STRUT_POWER_FRICTION], -sixth,
                     step_balance_contacts(once->minus_rubbed, twice->minus_rubbed));
    if (model->contacts.belt_speed != 0.0)
      step_balance_add(&work[STRUT_POWER_BELT], sixth,
                       step_balance_contacts(once->belt, twice->belt));
    exchanged += step_balance_contacts(once->turnover, twice->turnover) - damped;
  }
  step_balance_add(&work[STRUT_POWER_EXCHANGED], sixth, exchanged);
}

#endif
