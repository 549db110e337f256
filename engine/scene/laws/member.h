/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The law of a member, equations (1), (2) and (6): a spring, beside it a damper, and for a cable nothing where
 * it would push. One text for all kernels and statics; see laws/words.h.
 *
 * `damped`, `slack`, `driven`, constants where the text is inlined: some member has a damper, may go slack, has
 * a rest length that changes. What no member has is compiled out.
 */
#include "engine/scene/laws/words.h"

/**
 * What the law asks of members. A member carries a force where its stretch and its force are above these
 * thresholds: 0 for a cable, -INFINITY for others, and by its mode in a method with events.
 */
typedef struct LAW(member_values) {
  real length, rate;    /* of the whole member [m], [m/s] */
  real rest, rest_rate; /* its rest length [m], [m/s] */
  real stiffness, damping;
  real slack_length_threshold, slack_force_threshold; /* [m], [N] */
} LAW(member_values);

/** Where members are long enough to carry a force. */
LAW_INLINE mask LAW(member_is_taut)(real stretch, real threshold) {
  return less(threshold, stretch);
}

/** Rate of the stretch, against which dampers and actuators work [m/s]. */
LAW_INLINE real LAW(member_stretch_rate)(const LAW(member_values) * m, bool driven) {
  return driven ? m->rate - m->rest_rate : m->rate;
}

/**
 * Tensions [N], of cables never below 0. damper: what they have beyond their elastic part where members act
 * [N]; with `balance`, where cables go slack while they are stretched, what they lack of it.
 */
LAW_INLINE real LAW(member_tension)(const LAW(member_values) * m, bool damped, bool slack,
                                    bool driven, bool balance, real *damper) {
  real stretch = m->length - m->rest, elastic = m->stiffness * stretch, tension = elastic;
  *damper = m->damping * LAW(member_stretch_rate)(m, driven);
  if (damped) tension = elastic + *damper;
  if (!slack) return tension;
  mask taut = LAW(member_is_taut)(stretch, m->slack_length_threshold);
  mask pulls = both(taut, less(m->slack_force_threshold, tension));
  if (balance) *damper = choose(pulls, *damper, keep(taut, -elastic));
  return keep(pulls, tension);
}

/** What actuators and dampers do, and the sum of its sizes [W]. */
typedef struct LAW(member_powers) {
  real drive, exchanged, lost;
} LAW(member_powers);

/** Adds the powers of members with these tensions and dampers. */
LAW_INLINE void LAW(member_add_powers)(const LAW(member_values) * m, bool damped, bool driven,
                                       real tension, real damper, LAW(member_powers) * powers) {
  if (driven) {
    real power = -tension * m->rest_rate;
    powers->drive += power;
    powers->exchanged += magnitude(power);
  }
  if (damped) powers->lost += damper * LAW(member_stretch_rate)(m, driven);
}

/** Energy of the springs [J]. */
LAW_INLINE real LAW(member_energy)(real stiffness, real stretch, mask taut) {
  return keep(taut, 0.5 * stiffness * stretch * stretch);
}

/**
 * Positive while cables remain as they are, acting or slack [N]: a cable acts where stretch and force are
 * positive, so that the lesser of `elastic`, a positive factor times its stretch, and its tension decides. One
 * that acts ends with its tension, which passes 0 first, unless its force jumps with its stretch (abrupt).
 */
LAW_INLINE real LAW(cable_margin)(mask acts, real elastic, real tension, bool abrupt) {
  real lesser = choose(less(elastic, tension), elastic, tension);
  return choose(acts, abrupt ? lesser : tension, -lesser);
}

#include "engine/scene/laws/words_end.h"
