/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Hot: friction in the modes of contacts, and the margins at whose zeros modes end: positive while a mode holds.
 *
 * `side` is the direction of a mode, 1 or -1. What friction holds and what it slides with may depend on the direction
 * in which the other forces push, or in which the node moves.
 */
#pragma once

#include <math.h>

#include "engine/forces/forces_kernel.h"
#include "engine/integrate/events/event_stepping.h"

/* Forces and speeds that agree to this part are taken to be equal at the edge of a band. */
#define STRUT_TIED 1e-8

/* Half the layer about the threshold mu_0 N in which a contact yields, relative. */
static const double STRUT_YIELD_LAYER = 1e-3;

/* Normal force of the spring and, where `damped`, the damper, of a contact that touches. */
STRUT_INLINE double contact_normal_force(const strut_contact_entry *contact, int8_t damper,
                                         double gap, double into, bool damped) {
  const strut_law_ground_numbers numbers = strut_contact_numbers(contact);
  bool acts = damper ? damper > 0 : into<0.0, crossley = contact->dissipation> 0.0;
  return damped ? strut_law_ground_normal_in_mode(&numbers, acts, gap, into, crossley)
                : strut_law_ground_spring(&numbers, gap);
}

/* The most that friction holds against a push, and with which it slides, in this direction [N]. */
STRUT_INLINE double holding_limit(const strut_contact_entry *contact, double normal,
                                  double towards) {
  return strut_friction_static(&contact->friction, towards) * normal;
}
STRUT_INLINE double sliding_limit(const strut_contact_entry *contact, double normal,
                                  double towards) {
  return strut_friction_kinetic(&contact->friction, towards) * normal;
}

/* Friction between holding and pushing, by how far the applied force is through the layer. */
STRUT_INLINE double yield_friction(const strut_contact_entry *contact, double normal,
                                   double applied) {
  double threshold = holding_limit(contact, normal, applied), half = STRUT_YIELD_LAYER * threshold;
  double size = applied < 0.0 ? -applied : applied;
  double pushed = half > 0.0 ? 0.5 + 0.5 * (size - threshold) / half : 1.0;
  pushed = pushed < 0.0 ? 0.0 : pushed > 1.0 ? 1.0 : pushed;
  double friction =
      (1.0 - pushed) * size + pushed * strut_friction_kinetic(&contact->friction, applied) * normal;
  return applied < 0.0 ? friction : -friction;
}

/* In STRUT_MODE_BAND it balances the other forces up to its limit. */
STRUT_INLINE double band_friction(double holding, double applied) {
  return holding < applied ? -holding : applied < -holding ? holding : -applied;
}

/* Friction by the mode; a multiplier, which comes later, is 0 here. */
STRUT_INLINE double friction_in_mode(const strut_contact_entry *contact,
                                     const strut_contact_modes *modes, int32_t i,
                                     const strut_touch *touch) {
  int8_t side = modes->side[i];
  switch ((strut_contact_mode)modes->of[i]) {
    case STRUT_MODE_SLIP:
    case STRUT_MODE_PUSH:
      return -side * strut_friction_kinetic(&contact->friction, side) * touch->normal;
    case STRUT_MODE_SLIDE:
      return strut_friction_is_continuous(contact->friction.law)
                 ? strut_friction_force(&contact->friction, touch->normal, touch->slip,
                                        touch->applied)
                 : 0.0;
    case STRUT_MODE_BAND:
      return band_friction(holding_limit(contact, touch->normal, touch->applied), touch->applied);
    case STRUT_MODE_YIELD: return yield_friction(contact, touch->normal, touch->applied);
    case STRUT_MODE_OPEN:
    case STRUT_MODE_STICK:
    case STRUT_MODE_CREEP: break;
  }
  return 0.0;
}

/* Edge of the band, or 0 where sticking is exact. */
STRUT_INLINE double stick_band_edge(const strut_contact_entry *contact) {
  bool band = strut_friction_has_band(contact->friction.law);
  return band ? contact->friction.stick_velocity : 0.0;
}

/*
 * Ties at the edge of a band, but for rounding. Where a creeping contact balances the other forces creep ends, and the
 * contact stays within the band, at its edge, which rounding does not leave.
 */
STRUT_INLINE void settle_band_tie(const strut_contact_entry *contact,
                                  const strut_contact_modes *modes, int32_t i, strut_touch *touch) {
  double edge = contact->friction.stick_velocity, faint = STRUT_TIED * touch->normal;
  if (modes->of[i] == STRUT_MODE_CREEP && faint >= fabs(touch->friction + touch->applied))
    touch->friction = -touch->applied + modes->side[i] * faint;
  if (modes->of[i] == STRUT_MODE_BAND && STRUT_TIED * edge >= fabs(fabs(touch->slip) - edge))
    touch->slip = (touch->slip < 0.0 ? -edge : edge) * (1.0 - STRUT_TIED);
}

/* Do the forces on a contact within its band balance, but for rounding? Then its speed does not change. */
STRUT_INLINE bool band_forces_balance(const strut_contact_compliance *compliance,
                                      const strut_touch *touch) {
  return fabs(touch->slip_rate) <= STRUT_TIED * touch->normal * compliance->tangent;
}

/* ---- margins, of speeds [m/s] and of forces [N] ---- */

STRUT_INLINE double margin_of_slip(const strut_contact_entry *contact, const strut_touch *touch,
                                   double side) {
  return side * touch->slip - stick_band_edge(contact);
}
/* By the speed towards the edge. */
STRUT_INLINE double margin_of_band(const strut_contact_entry *contact, double speed) {
  return stick_band_edge(contact) - speed;
}
STRUT_INLINE double margin_of_stick(const strut_contact_entry *contact, const strut_touch *touch) {
  return holding_limit(contact, touch->normal, -touch->friction) - fabs(touch->friction);
}
/* Outside of the band friction is all that sliding gives. */
STRUT_INLINE double margin_of_creep_out(const strut_contact_entry *contact,
                                        const strut_touch *touch, double side) {
  return side * touch->friction + sliding_limit(contact, touch->normal, side);
}
/* Inside of the band friction is what it is there. */
STRUT_INLINE double margin_of_creep_in(const strut_contact_entry *contact, const strut_touch *touch,
                                       double side) {
  bool held = fabs(touch->applied) < holding_limit(contact, touch->normal, touch->applied);
  double sliding = sliding_limit(contact, touch->normal, touch->applied);
  double at_edge = held ? -touch->applied : -sliding * strut_sign(touch->applied);
  return side * (at_edge - touch->friction);
}
/* In PUSH, which ends where this is 0, too, and else. */
STRUT_INLINE double margin_of_push(const strut_contact_entry *contact, const strut_touch *touch,
                                   uint8_t mode, double side) {
  double holding = holding_limit(contact, touch->normal, touch->applied);
  return mode == STRUT_MODE_PUSH ? side * touch->applied - holding : holding - fabs(touch->applied);
}
/* From either end of the range of the applied force in which a contact keeps yielding. */
STRUT_INLINE double margin_of_yield(const strut_contact_entry *contact, const strut_touch *touch) {
  double threshold = holding_limit(contact, touch->normal, touch->applied);
  return 2.0 * STRUT_YIELD_LAYER * threshold - fabs(fabs(touch->applied) - threshold);
}

/* What but its speed ends the mode of a contact within its band. */
STRUT_INLINE strut_event_kind event_within_band(const strut_contact_entry *contact,
                                                const strut_contact_modes *modes, int32_t i,
                                                const strut_touch *touch) {
  uint8_t mode = modes->of[i];
  if (mode == STRUT_MODE_YIELD)
    return margin_of_yield(contact, touch) < 0.0 ? STRUT_EVENT_YIELDED : STRUT_EVENT_NONE;
  if (!strut_friction_drops(&contact->friction)) return STRUT_EVENT_NONE;
  double margin = margin_of_push(contact, touch, mode, modes->side[i]);
  bool holds = mode == STRUT_MODE_PUSH ? margin > 0.0 : !(margin < 0.0);
  return holds ? STRUT_EVENT_NONE : STRUT_EVENT_PUSH;
}

/* The event that ends the mode of closed contact i, by its state at the end of a step. */
STRUT_INLINE strut_event_kind contradicting_event(const strut_contact_entry *contact,
                                                  const strut_contact_modes *modes, int32_t i,
                                                  const strut_touch *touch) {
  double side = modes->side[i];
#define STRUT_ENDS(margin, NAME) ((margin) < 0.0 ? STRUT_EVENT_##NAME : STRUT_EVENT_NONE)
  switch ((strut_contact_mode)modes->of[i]) {
    case STRUT_MODE_SLIP: return STRUT_ENDS(margin_of_slip(contact, touch, side), SLIP_ENDS);
    case STRUT_MODE_STICK:
      /* also where the gap is open by then: what holds a node lets go before that */
      return STRUT_ENDS(margin_of_stick(contact, touch), STICK_BREAKS);
    case STRUT_MODE_CREEP:
      if (margin_of_creep_out(contact, touch, side) < 0.0) return STRUT_EVENT_CREEP_OUT;
      return STRUT_ENDS(margin_of_creep_in(contact, touch, side), CREEP_IN);
    case STRUT_MODE_BAND:
    case STRUT_MODE_PUSH:
    case STRUT_MODE_YIELD:
      if (margin_of_band(contact, fabs(touch->slip)) < 0.0) return STRUT_EVENT_LEAVES_STICK_BAND;
      return event_within_band(contact, modes, i, touch);
    case STRUT_MODE_OPEN:
    case STRUT_MODE_SLIDE: break;
  }
  return STRUT_EVENT_NONE;
}
