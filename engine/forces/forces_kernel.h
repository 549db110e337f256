/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the sum of the terms in a fixed order, and the acceleration it gives, as one inlined piece.
 *
 * An integrator includes this to have one copy in its own loop. Only what the terms names is
 * evaluated.
 */
#pragma once

#include <math.h>

#include "engine/forces/drives/drives.h"
#include "engine/forces/drives/moving_masses.h"
#include "engine/forces/elements.h"
#include "engine/forces/forces.h"
#include "engine/forces/members_kernel.h"
#include "engine/forces/surfaces.h"
#include "engine/model/algebra/hot.h"
#include "engine/model/mass_kernel.h"
#include "engine/model/pose.h"
#include "engine/model/state.h"

/*
 * Hot: the ground's reaction (8) and friction (9), exactly as the paper prints them, or by the other
 * laws that a scene may name, in a loop of their own.
 *
 * The damper of (8) acts only while the node moves into the ground. Friction comes last of all forces,
 * since Karnopp's band needs the sum of the others on the node.
 */

/* Accumulates the powers of a contact in its place of the step's sums. */
STRUT_INLINE void ground_accumulate_lanes(strut_power_lanes *restrict to, int32_t lane, bool moves,
                                          strut_law_contact_powers p) {
  to->minus_damped[lane] += p.damper;
  to->minus_rubbed[lane] += p.friction;
  if (!moves) {
    to->turnover[lane] += fabs(p.friction);
    return;
  }
  to->belt[lane] += p.belt;
  to->turnover[lane] += fabs(p.friction) + fabs(p.belt);
}

STRUT_INLINE void ground_balance(const strut_state *state, strut_law_contact_powers p) {
  state->latest->power[STRUT_POWER_CONTACT] -= p.damper;
  state->latest->power[STRUT_POWER_FRICTION] -= p.friction;
  state->latest->power[STRUT_POWER_BELT] += p.belt;
  state->latest->power[STRUT_POWER_EXCHANGED] += -p.damper + fabs(p.friction) + fabs(p.belt);
}

/* Within Karnopp's band at the ends of rigid bars friction is found with their forces: 0 here. */
STRUT_INLINE double ground_friction(const strut_contact_entry *contact, double normal, double slip,
                                    double applied, bool bars_rigid) {
  const strut_friction *friction = &contact->friction;
  bool band = strut_friction_has_band(friction->law);
  if (bars_rigid && band && fabs(slip) < friction->stick_velocity) return 0.0;
  return strut_friction_force(friction, normal, slip, applied);
}

/* One node in contact; f, v: its force and velocity; gap < 0. */
STRUT_INLINE void ground_touch(const strut_contact_table *contacts, const strut_state *state,
                               int32_t i, double gap, double *restrict f, const double *restrict v,
                               bool sloped, bool rough, bool laws, strut_accumulation balance,
                               strut_power_lanes *lanes, bool moves) {
  const strut_contact_entry *contact = &contacts->entry[i];
  strut_pair sum = strut_pair_load(f), reaction;
  double into = sloped ? v[0] * contacts->normal[0] + v[1] * contacts->normal[1] : v[1];
  double along = sloped ? v[0] * contacts->tangent[0] + v[1] * contacts->tangent[1] : v[0];
  const strut_law_ground_numbers numbers = strut_contact_numbers(contact);
  double spring = strut_law_ground_spring(&numbers, gap), slip = along - contacts->belt_speed;
  double damper = strut_law_ground_damper(&numbers, spring, into, laws);
  double normal = spring + damper, friction = 0.0;
  if (rough) {
    double applied =
        sloped ? sum[0] * contacts->tangent[0] + sum[1] * contacts->tangent[1] : sum[0];
    const strut_law_friction_numbers rubs = strut_friction_numbers(&contact->friction);
    friction = laws ? ground_friction(contact, normal, slip, applied, state->rigid)
                    : strut_law_friction_karnopp(&rubs, normal, slip, applied);
  }
  if (sloped)
    reaction = (strut_pair){friction * contacts->tangent[0] + normal * contacts->normal[0],
                            friction * contacts->tangent[1] + normal * contacts->normal[1]};
  else
    reaction = (strut_pair){friction, normal};
  strut_pair_store(f, sum + reaction);
  state->latest->normal[i] = normal;
  state->latest->friction[i] = friction;
  strut_law_contact_powers powers =
      strut_law_contact_power(damper, into, friction, slip, contacts->belt_speed);
  if (balance == STRUT_ACCUMULATE_POWERS) ground_balance(state, powers);
  if (balance == STRUT_ACCUMULATE_LANES)
    ground_accumulate_lanes(lanes, contact->lane, moves, powers);
}

STRUT_INLINE void ground_all(const strut_model *model, const strut_state *state,
                             const double *restrict q, const double *restrict v,
                             double *restrict force, int32_t begin, int32_t end, bool sloped,
                             bool rough, bool laws, strut_accumulation balance) {
  const strut_contact_table *contacts = &model->contacts;
  const uint32_t *restrict at = contacts->at;
  const double height = contacts->height;
  strut_power_lanes *lanes = state->latest->accumulated;
  bool moves = contacts->belt_speed != 0.0;
  for (int32_t i = begin; i < end; i++) {
    double gap = q[at[i] + 1] - height;
    if (sloped) gap = q[at[i]] * contacts->normal[0] + gap * contacts->normal[1];
    if (gap < 0.0)
      ground_touch(contacts, state, i, gap, force + at[i], v + at[i], sloped, rough, laws, balance,
                   lanes, moves);
  }
}

/* Adds the ground's forces on contacts begin to end; slope and friction are compiled out where the scene has
   none. */
STRUT_LOOP void ground_kernel_range(const strut_model *model, const strut_state *state,
                                    const double *restrict q, const double *restrict v,
                                    double *restrict force, int32_t begin, int32_t end,
                                    strut_accumulation balance) {
  enum { F = STRUT_TERM_FRICTION, S = STRUT_TERM_SLOPE };
#define STRUT_CASE(sloped, rough, laws)                                                            \
  ground_all(model, state, q, v, force, begin, end, sloped, rough, laws, balance);                 \
  break
  switch (model->terms & (S | F | STRUT_TERM_LAWS)) {
    case 0: STRUT_CASE(false, false, false);
    case F: STRUT_CASE(false, true, false);
    case S: STRUT_CASE(true, false, false);
    case S | F: STRUT_CASE(true, true, false);
    default: STRUT_CASE(true, true, true);
  }
#undef STRUT_CASE
}

/* Those on all contacts. */
STRUT_INLINE void ground_kernel(const strut_model *model, const strut_state *state,
                                const double *restrict q, const double *restrict v,
                                double *restrict force, strut_accumulation balance) {
  ground_kernel_range(model, state, q, v, force, 0, model->contacts.count, balance);
}

/*
 * Hot: the energy balance of a Runge-Kutta step. The powers of its evaluations are added up lane by lane,
 * those with the same weight together; only at the end of the step are lanes added up, once for all
 * evaluations. Verlet and Euler integrate the powers of single evaluations.
 */

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

/**
 * Defines NAME with these parameters, of which `model` and `state` are two, which runs `function(..., terms, balance)`,
 * an inlined function: with the energy balance, without it, and for scenes with rare terms, each in a copy of its own,
 * compiled for several processors, so that a scene does not pay for what it does not need. NAME must be the method's
 * own: cloned functions of equal names do not link with clang (hot.h).
 */
#define STRUT_COPIES(name, function, parameters, ...)                                              \
  STRUT_CLONES                                                                                     \
  static void name##_with_balance parameters { function(__VA_ARGS__, STRUT_TERMS_COMMON, true); }  \
                                                                                                   \
  STRUT_CLONES                                                                                     \
  static void name##_without_balance parameters {                                                  \
    function(__VA_ARGS__, STRUT_TERMS_COMMON, false);                                              \
  }                                                                                                \
                                                                                                   \
  STRUT_CLONES                                                                                     \
  static void name##_with_rare_terms parameters {                                                  \
    function(__VA_ARGS__, STRUT_TERMS_ALL, state->balance);                                        \
  }                                                                                                \
                                                                                                   \
  static void name parameters {                                                                    \
    if (model->terms & STRUT_TERMS_RARE)                                                           \
      name##_with_rare_terms(__VA_ARGS__);                                                         \
    else if (state->balance)                                                                       \
      name##_with_balance(__VA_ARGS__);                                                            \
    else                                                                                           \
      name##_without_balance(__VA_ARGS__);                                                         \
  }
