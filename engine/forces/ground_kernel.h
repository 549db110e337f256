/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: the ground's reaction (8) and friction (9), exactly as the paper prints them, or by the other
 * laws that a scene may name, in a loop of their own.
 *
 * The damper of (8) acts only while the node moves into the ground. Friction comes last of all forces,
 * since Karnopp's band needs the sum of the others on the node.
 */
#ifndef STRUT_ENGINE_FORCES_GROUND_KERNEL_H
#define STRUT_ENGINE_FORCES_GROUND_KERNEL_H

#include <math.h>

#include "engine/model/algebra/hot.h"
#include "engine/model/pose.h"
#include "engine/model/state.h"

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

#endif
