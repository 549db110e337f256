/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The laws of friction: for each a row of STRUT_FRICTION_LAWS and two functions, and nothing else.
 *
 * All kernels, methods, statics and the step limit compile this text with a meaning of their own for its
 * words (laws/words.h); see docs/dev/recipes.md.
 */
#ifndef STRUT_FRICTION_LAWS

/**
 * X(NAME, field, range): numbers of the laws; the field is the key too. range: what is allowed where a law
 * needs the number, NOT_NEGATIVE or ABOVE_ZERO.
 */
#define STRUT_FRICTION_PARAMETERS(X)                                                               \
  X(MU_STATIC, mu_static, NOT_NEGATIVE)         /* mu_0 [1] */                                     \
  X(MU_KINETIC, mu_kinetic, NOT_NEGATIVE)       /* mu [1] */                                       \
  X(STICK_VELOCITY, stick_velocity, ABOVE_ZERO) /* delta [m/s] */                                  \
  X(WIDTH, width, ABOVE_ZERO)                   /* of a continuous law [m/s] */                    \
  X(DECAY_VELOCITY, decay_velocity, ABOVE_ZERO) /* half way from mu_0 to mu [m/s] */               \
  X(PRESLIDING, presliding, ABOVE_ZERO)         /* slip that bends bristles up to mu_0 [m] */      \
  X(RELAXATION, relaxation, ABOVE_ZERO)         /* time in which free bristles straighten [s] */

/**
 * X(NAME, name, word, class, needs): the laws, in the order of the key's words. class: its contact states, see
 * strut_friction_class; needs: bits of the numbers it needs.
 */
#define STRUT_FRICTION_LAWS(X)                                                                     \
  X(NONE, none, "none", ABSENT, 0)                                                                 \
  /* equation (9) of the paper as printed: with a stick band */                                    \
  X(KARNOPP, karnopp, "karnopp", STICK_BAND, MU_STATIC_BIT | MU_KINETIC_BIT | STICK_VELOCITY_BIT)  \
  X(COULOMB, coulomb, "coulomb", EXACT_STICK, MU_STATIC_BIT | MU_KINETIC_BIT)                      \
  X(SMOOTH, smooth, "smooth", CONTINUOUS, MU_KINETIC_BIT | WIDTH_BIT)                              \
  X(STRIBECK, stribeck, "stribeck", CONTINUOUS,                                                    \
    MU_STATIC_BIT | MU_KINETIC_BIT | WIDTH_BIT | DECAY_VELOCITY_BIT)                               \
  X(LUGRE, lugre, "lugre", BRISTLES,                                                               \
    MU_STATIC_BIT | MU_KINETIC_BIT | DECAY_VELOCITY_BIT | PRESLIDING_BIT | RELAXATION_BIT)

#endif

#include "engine/scene/laws/words.h"

/** Numbers of contacts' friction, those of motion towards -x along the ground apart. */
typedef struct LAW(friction_numbers) {
#define STRUT_FRICTION_ROW(NAME, field, range) real field;
  STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  real mu_static_backward, mu_kinetic_backward;
} LAW(friction_numbers);

/** Which contacts have which law. */
typedef struct LAW(friction_choice) {
#define STRUT_FRICTION_ROW(NAME, name, ...) mask name;
  STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
} LAW(friction_choice);

/*
 * Each law's force along the ground [N] under the normal force [N] > 0 at the speed `slip` along it [m/s];
 * applied: the sum of the other forces along the ground [N], F_res, for laws that stick. And its slope:
 * -d force / d slip at rest [N s/m], 0 of laws that are not continuous.
 */

LAW_INLINE real LAW(friction_none)(const LAW(friction_numbers) * f, real normal, real slip,
                                   real applied) {
  (void)f, (void)normal, (void)slip, (void)applied;
  return all(0.0);
}
LAW_INLINE real LAW(friction_none_slope)(const LAW(friction_numbers) * f, real normal) {
  (void)f, (void)normal;
  return all(0.0);
}

/* Coulomb's law with Karnopp's band, equation (9) as printed. */
LAW_INLINE real LAW(friction_karnopp)(const LAW(friction_numbers) * f, real normal, real slip,
                                      real applied) {
  mask slides = at_least(magnitude(slip), f->stick_velocity);
  mask pushed = at_least(magnitude(applied), f->mu_static * normal);
  real opposed = choose(slides, slip, applied);
  return choose(either(slides, pushed), against(f->mu_kinetic * normal, opposed), -applied);
}
LAW_INLINE real LAW(friction_karnopp_slope)(const LAW(friction_numbers) * f, real normal) {
  (void)f, (void)normal;
  return all(0.0);
}

/* At a speed of exactly zero; methods with events hold the node there instead. */
LAW_INLINE real LAW(friction_coulomb)(const LAW(friction_numbers) * f, real normal, real slip,
                                      real applied) {
  return LAW(friction_karnopp)(f, normal, slip, applied);
}
LAW_INLINE real LAW(friction_coulomb_slope)(const LAW(friction_numbers) * f, real normal) {
  (void)f, (void)normal;
  return all(0.0);
}

/*
 * -mu N u / sqrt(u^2 + w^2), within 1 % of mu N from |u| = 7 w on. A node under load creeps. Algebraic, so
 * that every machine gives the same bits.
 */
LAW_INLINE real LAW(friction_smooth)(const LAW(friction_numbers) * f, real normal, real slip,
                                     real applied) {
  (void)applied;
  return -f->mu_kinetic * normal * slip / root(slip * slip + f->width * f->width);
}
LAW_INLINE real LAW(friction_smooth_slope)(const LAW(friction_numbers) * f, real normal) {
  return normal * f->mu_kinetic / f->width;
}

/* Coefficient of steady sliding by Stribeck's curve, mu + (mu_0 - mu) / (1 + (u/v)^2). */
LAW_INLINE real LAW(friction_curve)(const LAW(friction_numbers) * f, real slip) {
  real u = slip / f->decay_velocity;
  return f->mu_kinetic + (f->mu_static - f->mu_kinetic) / (1.0 + u * u);
}

/*
 * As smooth, with the coefficient mu + (mu_0 - mu) / (1 + (u/v)^2) of Stribeck's curve, which falls from static
 * to kinetic friction; in this form, of Hess and Soom (1990), it is algebraic.
 */
LAW_INLINE real LAW(friction_stribeck)(const LAW(friction_numbers) * f, real normal, real slip,
                                       real applied) {
  real mu = LAW(friction_curve)(f, slip);
  (void)applied;
  return -mu * normal * slip / root(slip * slip + f->width * f->width);
}
LAW_INLINE real LAW(friction_stribeck_slope)(const LAW(friction_numbers) * f, real normal) {
  return normal * f->mu_static / f->width;
}

/*
 * LuGre: bristles between the surfaces bend with the slip, up to the coefficient of steady sliding. Their bend y is an
 * internal state, as the part of the normal force that they carry: y' = mu_0/d (u - |u| y / mu(u)), force
 * -N (y + tau y'), with the presliding d and the relaxation tau (C. Canudas de Wit, H. Olsson, K. J. Astrom,
 * P. Lischinsky, IEEE Trans. Automatic Control 40 (1995) 419). These two are those of steady sliding and of bristles
 * at rest; forces with the state are in engine/forces/surfaces.c.
 */
LAW_INLINE real LAW(friction_lugre)(const LAW(friction_numbers) * f, real normal, real slip,
                                    real applied) {
  (void)applied;
  return against(LAW(friction_curve)(f, slip) * normal, slip);
}
LAW_INLINE real LAW(friction_lugre_slope)(const LAW(friction_numbers) * f, real normal) {
  return normal * f->mu_static * f->relaxation / f->presliding;
}
/* How fast sliding straightens them [1/s], and y'. */
LAW_INLINE real LAW(friction_bristle_decay)(const LAW(friction_numbers) * f, real slip) {
  return f->mu_static / f->presliding * magnitude(slip) / LAW(friction_curve)(f, slip);
}
LAW_INLINE real LAW(friction_bristle_rate)(const LAW(friction_numbers) * f, real slip, real bend) {
  return f->mu_static / f->presliding * slip - LAW(friction_bristle_decay)(f, slip) * bend;
}

/** The numbers for contacts that move, or are pushed, towards -x along the ground where `back` holds. */
LAW_INLINE LAW(friction_numbers) LAW(friction_towards)(const LAW(friction_numbers) * f, mask back) {
  LAW(friction_numbers) towards = *f;
  towards.mu_static = choose(back, f->mu_static_backward, f->mu_static);
  towards.mu_kinetic = choose(back, f->mu_kinetic_backward, f->mu_kinetic);
  return towards;
}

/**
 * The most that friction holds against a push, and with which it slides, in these directions [N];
 * directional: some contact's coefficients differ by direction.
 */
LAW_INLINE real LAW(friction_holding)(const LAW(friction_numbers) * f, real normal, real towards,
                                      bool directional) {
  mask back = less(towards, all(0.0));
  return (directional ? choose(back, f->mu_static_backward, f->mu_static) : f->mu_static) * normal;
}
LAW_INLINE real LAW(friction_sliding)(const LAW(friction_numbers) * f, real normal, real towards,
                                      bool directional) {
  mask back = less(towards, all(0.0));
  return (directional ? choose(back, f->mu_kinetic_backward, f->mu_kinetic) : f->mu_kinetic) *
         normal;
}

/** Force along the ground of the contacts' laws, with the coefficients of the direction it resists [N]. */
LAW_INLINE real LAW(friction)(const LAW(friction_numbers) * f, const LAW(friction_choice) * has,
                              real normal, real slip, real applied) {
  real zero = all(0.0), speed = magnitude(slip), force = zero;
  mask moves = both(at_least(speed, f->stick_velocity), less(zero, speed));
  LAW(friction_numbers)
  towards = LAW(friction_towards)(f, less(choose(moves, slip, applied), zero));
#define STRUT_FRICTION_FORCE(name)                                                                 \
  if (some(has->name))                                                                             \
    force = choose(has->name, LAW(friction_##name)(&towards, normal, slip, applied), force);
#define STRUT_FRICTION_FORCE_OF_ABSENT(name) STRUT_FRICTION_FORCE(name)
#define STRUT_FRICTION_FORCE_OF_STICK_BAND(name) STRUT_FRICTION_FORCE(name)
#define STRUT_FRICTION_FORCE_OF_EXACT_STICK(name) STRUT_FRICTION_FORCE(name)
#define STRUT_FRICTION_FORCE_OF_CONTINUOUS(name) STRUT_FRICTION_FORCE(name)
#define STRUT_FRICTION_FORCE_OF_BRISTLES(name) /* no contact of a kernel has it: model/model.h */
#define STRUT_FRICTION_ROW(NAME, name, word, states, needs) STRUT_FRICTION_FORCE_OF_##states(name)
  STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
#undef STRUT_FRICTION_FORCE_OF_BRISTLES
#undef STRUT_FRICTION_FORCE_OF_CONTINUOUS
#undef STRUT_FRICTION_FORCE_OF_EXACT_STICK
#undef STRUT_FRICTION_FORCE_OF_STICK_BAND
#undef STRUT_FRICTION_FORCE_OF_ABSENT
#undef STRUT_FRICTION_FORCE
  return force;
}

#include "engine/scene/laws/words_end.h"
