/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The law of the ground normal to it, equation (8), and what a contact exchanges with the structure.
 *
 * One text for all kernels and methods; see laws/words.h. `gap` is a node's distance from the
 * ground [m], negative inside; `into` its velocity along the normal out of the ground [m/s], negative on its
 * way in. `crossley`, a constant where it is inlined: some contact has the Hunt-Crossley law, which differs
 * from (8) by its dissipation.
 */
#include "engine/scene/laws/words.h"

/** Numbers of contacts: -c_g [N/m], -k_g [N s/m], and chi of the Hunt-Crossley law [s/m] or 0. */
typedef struct LAW(ground_numbers) {
  real minus_stiffness, minus_damping, dissipation;
} LAW(ground_numbers);

/** Force of the ground's springs [N]. */
LAW_INLINE real LAW(ground_spring)(const LAW(ground_numbers) * g, real gap) {
  return g->minus_stiffness * gap;
}

/**
 * Force of the dampers beside the force `spring` of the springs [N]: k_g d' on the way in, or c_g d chi d' of
 * the Hunt-Crossley law, together with its spring never pulling.
 */
LAW_INLINE real LAW(ground_damper)(const LAW(ground_numbers) * g, real spring, real into,
                                   bool crossley) {
  real zero = all(0.0), damper = keep(less(into, zero), g->minus_damping * into);
  if (!crossley) return damper;
  real other = -spring * g->dissipation * into;
  other = choose(less(-spring, other), other, -spring);
  return choose(less(zero, g->dissipation), other, damper);
}

/**
 * Normal force [N] of contacts in a mode of a method with events: the damper of (8) acts where `acts` holds.
 * A method may try steps that leave the ground again; the Hunt-Crossley law has no kink there.
 */
LAW_INLINE real LAW(ground_normal_in_mode)(const LAW(ground_numbers) * g, mask acts, real gap,
                                           real into, bool crossley) {
  real zero = all(0.0), spring = LAW(ground_spring)(g, gap);
  real normal = add_where(acts, spring, g->minus_damping * into);
  if (!crossley) return normal;
  real other = spring - spring * g->dissipation * into;
  other = keep(either(less(zero, other), at_least(gap, zero)), other);
  return choose(less(zero, g->dissipation), other, normal);
}

/**
 * The damper's force at the end of a step by the trapezoidal rule [N], where a node would go into the ground at
 * the speed `free` without it, and a force F changes its speed by `half` F [m/s].
 */
LAW_INLINE real LAW(ground_implicit_damper)(const LAW(ground_numbers) * g, real spring, real free,
                                            real half, bool crossley) {
  real zero = all(0.0), damping = -g->minus_damping;
  mask other = less(zero, g->dissipation);
  if (crossley) damping = choose(other, keep(less(zero, spring), g->dissipation * spring), damping);
  real into = free / (1.0 + half * damping), force = -damping * into;
  real damper = choose(less(zero, into), zero, force);
  if (crossley) {
    real least = keep(less(zero, spring), -spring);
    damper = choose(other, choose(at_least(force, -spring), force, least), damper);
  }
  return keep(less(zero, damping), damper);
}

/** What contacts do to the structure: powers [W] of the damper, of friction against the sliding speed, and of
    a moving ground. */
typedef struct LAW(contact_powers) {
  real damper, friction, belt;
} LAW(contact_powers);

LAW_INLINE LAW(contact_powers)
    LAW(contact_power)(real damper, real into, real friction, real slip, real belt_speed) {
  return (LAW(contact_powers)){damper * into, friction * slip, friction * belt_speed};
}

#include "engine/scene/laws/words_end.h"
