/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Friction in the modes of contacts, and the margins at whose zeros modes end (event_stepping.h names both).
 *
 * One text for the general kernel and the vectors of small models; see engine/scene/laws/words.h. `normal`,
 * `friction` and `applied`, the sum of the other forces along the ground, are forces on the node [N]; `side` is
 * the direction of a mode, 1 or -1; `holding` and `sliding` are limits of friction in a direction
 * (LAW(friction_holding), LAW(friction_sliding)). A margin is positive while the mode holds; all are forces [N]
 * but those of speeds.
 */
#include "engine/scene/laws/words.h"

/** Friction in STRUT_MODE_BAND: it balances the other forces up to its limit. */
LAW_INLINE real LAW(friction_in_band)(real holding, real applied) {
  real held = choose(less(applied, -holding), holding, -applied);
  return choose(less(holding, applied), -holding, held);
}

/** Friction inside the band of a contact that creeps along its edge. */
LAW_INLINE real LAW(friction_at_edge)(real holding, real sliding, real applied) {
  mask held = less(magnitude(applied), holding);
  return choose(held, -applied, against(sliding, applied));
}

/** STRUT_EVENT_SLIP_ENDS: from the speed at the edge of the band, or 0 [m/s]. */
LAW_INLINE real LAW(margin_of_slip)(real side, real slip, real edge) { return side * slip - edge; }

/** STRUT_EVENT_LEAVES_STICK_BAND, by the speed towards the edge [m/s]. */
LAW_INLINE real LAW(margin_of_band)(real speed, real edge) { return edge - speed; }

/** STRUT_EVENT_STICK_BREAKS; and STRUT_EVENT_PUSH of a contact within its band, by the applied force. */
LAW_INLINE real LAW(margin_of_holding)(real holding, real force) {
  return holding - magnitude(force);
}

/** STRUT_EVENT_PUSH of a contact that is pushed; it is pushed no more where this is 0, too. */
LAW_INLINE real LAW(margin_of_push)(real side, real holding, real applied) {
  return side * applied - holding;
}

/** STRUT_EVENT_CREEP_OUT: outside of the band friction is all that sliding gives. */
LAW_INLINE real LAW(margin_of_creep_out)(real side, real sliding, real friction) {
  return side * friction + sliding;
}

/** STRUT_EVENT_CREEP_IN: inside of the band friction is what it is there. */
LAW_INLINE real LAW(margin_of_creep_in)(real side, real at_edge, real friction) {
  return side * (at_edge - friction);
}

/**
 * Is less of a margin left, where it is `least` within a step, than it has lost from what it is at its ends, `kept`
 * at least? Its true least value may then be below 0.
 */
LAW_INLINE mask LAW(margin_is_spent)(real least, real kept) { return less(2.0 * least, kept); }

/* Forces and speeds that agree to this part are taken to be equal at the edge of a band. */
#define STRUT_TIED 1e-8

/**
 * Friction of a creeping contact: where it balances the other forces but for rounding, creep ends, and the
 * contact stays within the band, at its edge, which rounding does not leave.
 */
LAW_INLINE real LAW(friction_in_creep)(real side, real normal, real friction, real applied) {
  real faint = STRUT_TIED * normal;
  mask tied = at_least(faint, magnitude(friction + applied));
  return choose(tied, -applied + side * faint, friction);
}

/** Sliding speed of a contact in its band: at the edge but for rounding, it is within it. */
LAW_INLINE real LAW(slip_in_band)(real slip, real edge) {
  mask tied = at_least(STRUT_TIED * edge, magnitude(magnitude(slip) - edge));
  real inside = choose(less(slip, all(0.0)), -edge, edge) * (1.0 - STRUT_TIED);
  return choose(tied, inside, slip);
}

#include "engine/scene/laws/words_end.h"
