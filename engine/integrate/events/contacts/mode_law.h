/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Friction in the modes of contacts, and the margins at whose zeros modes end (event_stepping.h names both).
 *
 * `normal`, `friction` and `applied`, the sum of the other forces along the ground, are forces on the node [N];
 * `side` is the direction of a mode, 1 or -1; `holding` and `sliding` are limits of friction in a direction
 * (strut_friction_static, strut_friction_kinetic). A margin is positive while the mode holds; all are forces [N]
 * but those of speeds.
 */
#ifndef STRUT_ENGINE_INTEGRATE_EVENTS_CONTACTS_MODE_LAW_H
#define STRUT_ENGINE_INTEGRATE_EVENTS_CONTACTS_MODE_LAW_H

#include "engine/model/hot.h"
#include "engine/scene/laws/scalar.h"

/** Friction in STRUT_MODE_BAND: it balances the other forces up to its limit. */
STRUT_INLINE double strut_law_friction_in_band(double holding, double applied) {
  return holding < applied ? -holding : applied < -holding ? holding : -applied;
}

/** Friction inside the band of a contact that creeps along its edge. */
STRUT_INLINE double strut_law_friction_at_edge(double holding, double sliding, double applied) {
  return fabs(applied) < holding ? -applied : -sliding * strut_sign(applied);
}

/** STRUT_EVENT_SLIP_ENDS: from the speed at the edge of the band, or 0 [m/s]. */
STRUT_INLINE double strut_law_margin_of_slip(double side, double slip, double edge) {
  return side * slip - edge;
}

/** STRUT_EVENT_LEAVES_STICK_BAND, by the speed towards the edge [m/s]. */
STRUT_INLINE double strut_law_margin_of_band(double speed, double edge) { return edge - speed; }

/** STRUT_EVENT_STICK_BREAKS; and STRUT_EVENT_PUSH of a contact within its band, by the applied force. */
STRUT_INLINE double strut_law_margin_of_holding(double holding, double force) {
  return holding - fabs(force);
}

/** STRUT_EVENT_PUSH of a contact that is pushed; it is pushed no more where this is 0, too. */
STRUT_INLINE double strut_law_margin_of_push(double side, double holding, double applied) {
  return side * applied - holding;
}

/** STRUT_EVENT_CREEP_OUT: outside of the band friction is all that sliding gives. */
STRUT_INLINE double strut_law_margin_of_creep_out(double side, double sliding, double friction) {
  return side * friction + sliding;
}

/** STRUT_EVENT_CREEP_IN: inside of the band friction is what it is there. */
STRUT_INLINE double strut_law_margin_of_creep_in(double side, double at_edge, double friction) {
  return side * (at_edge - friction);
}

/**
 * Is less of a margin left, where it is `least` within a step, than it has lost from what it is at its ends, `kept`
 * at least? Its true least value may then be below 0.
 */
STRUT_INLINE bool strut_law_margin_is_spent(double least, double kept) {
  return 2.0 * least < kept;
}

/* Forces and speeds that agree to this part are taken to be equal at the edge of a band. */
#define STRUT_TIED 1e-8

/**
 * Friction of a creeping contact: where it balances the other forces but for rounding, creep ends, and the
 * contact stays within the band, at its edge, which rounding does not leave.
 */
STRUT_INLINE double strut_law_friction_in_creep(double side, double normal, double friction,
                                                double applied) {
  double faint = STRUT_TIED * normal;
  return faint >= fabs(friction + applied) ? -applied + side * faint : friction;
}

/** Sliding speed of a contact in its band: at the edge but for rounding, it is within it. */
STRUT_INLINE double strut_law_slip_in_band(double slip, double edge) {
  bool tied = STRUT_TIED * edge >= fabs(fabs(slip) - edge);
  return tied ? (slip < 0.0 ? -edge : edge) * (1.0 - STRUT_TIED) : slip;
}

#endif
