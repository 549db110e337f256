/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Friction laws as functions of the normal force, the sliding speed and the other forces.
 */
#ifndef STRUT_ENGINE_FORCES_FRICTION_H
#define STRUT_ENGINE_FORCES_FRICTION_H

/** x with its sign only: -1, 0 or 1. */
static inline double strut_sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

/**
 * Coulomb's law with Karnopp's band, equation (9) as printed. normal [N] > 0, slip: speed along the
 * ground [m/s], applied: F_res, the sum of the other forces along the ground [N]. Returns [N].
 */
static inline double strut_friction_force(double normal, double slip, double applied,
                                          double mu_static, double mu_kinetic,
                                          double stick_velocity) {
  double speed = slip < 0.0 ? -slip : slip, push = applied < 0.0 ? -applied : applied;
  if (speed >= stick_velocity) return -mu_kinetic * normal * strut_sign(slip);
  if (push >= mu_static * normal) return -mu_kinetic * normal * strut_sign(applied);
  return -applied;
}

/**
 * A regularised law without jumps: -mu N u / sqrt(u^2 + w^2), within 1 % of mu N from |u| = 7 w on.
 * A node under load creeps. Algebraic, so that every machine gives the same bits. Returns [N].
 */
static inline double strut_friction_smooth(double normal, double slip, double mu, double width) {
  return -mu * normal * slip / __builtin_sqrt(slip * slip + width * width);
}

#endif
