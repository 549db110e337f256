/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Friction laws: one row and two functions for each.
 *
 * Reader, writer, checks, step limit, contact modes and forces loop over these tables, so that a
 * law is added only here; see docs/recipes.md.
 */
#ifndef STRUT_ENGINE_SCENE_FRICTION_H
#define STRUT_ENGINE_SCENE_FRICTION_H

#include <math.h>
#include <stdbool.h>

/** Contact states under a law. */
typedef enum strut_friction_class {
  STRUT_FRICTION_ABSENT,      /* no force */
  STRUT_FRICTION_STICK_BAND,  /* balances the other forces below the speed stick_velocity */
  STRUT_FRICTION_EXACT_STICK, /* sticks without moving; needs a method with events */
  STRUT_FRICTION_CONTINUOUS   /* a force that depends on the speed without a jump: no states */
} strut_friction_class;

/**
 * X(NAME, field, range): numbers of the laws, in the order of strut_friction; the field is the key too.
 * range: what is allowed where the law needs the number, NOT_NEGATIVE or ABOVE_ZERO.
 */
#define STRUT_FRICTION_PARAMETERS(X)                                                               \
  X(MU_STATIC, mu_static, NOT_NEGATIVE)         /* mu_0 [1] */                                     \
  X(MU_KINETIC, mu_kinetic, NOT_NEGATIVE)       /* mu [1] */                                       \
  X(STICK_VELOCITY, stick_velocity, ABOVE_ZERO) /* delta [m/s] */                                  \
  X(WIDTH, width, ABOVE_ZERO)                   /* of a continuous law [m/s] */

/**
 * X(NAME, word, class, needs): the laws, in the order of the key's words. needs: bits of the numbers it
 * needs.
 */
#define STRUT_FRICTION_LAWS(X)                                                                     \
  X(NONE, "none", ABSENT, 0)                                                                       \
  /* equation (9) of the paper as printed: with a stick band */                                    \
  X(KARNOPP, "karnopp", STICK_BAND, MU_STATIC_BIT | MU_KINETIC_BIT | STICK_VELOCITY_BIT)           \
  X(COULOMB, "coulomb", EXACT_STICK, MU_STATIC_BIT | MU_KINETIC_BIT)                               \
  X(SMOOTH, "smooth", CONTINUOUS, MU_KINETIC_BIT | WIDTH_BIT)

typedef enum strut_friction_law {
#define STRUT_FRICTION_ROW(NAME, ...) STRUT_FRICTION_##NAME,
  STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
      STRUT_FRICTION_LAW_COUNT
} strut_friction_law;

enum {
#define STRUT_FRICTION_ROW(NAME, ...) STRUT_FRICTION_PARAMETER_##NAME,
  STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
      STRUT_FRICTION_PARAMETER_COUNT
};

/** Friction between a node and the ground. Numbers that the law does not need are ignored. */
typedef struct strut_friction {
  strut_friction_law law;
#define STRUT_FRICTION_ROW(NAME, field, range) double field;
  STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  bool
      directional; /* motion towards -x along the ground has coefficients of its own, the next two: */
  double mu_static_backward, mu_kinetic_backward; /* [1] */
} strut_friction;

/** Coefficient of static friction against a push along the ground in this direction. */
static inline double strut_friction_static(const strut_friction *f, double direction) {
  return f->directional && direction < 0.0 ? f->mu_static_backward : f->mu_static;
}

/** Coefficient of kinetic friction against sliding in this direction. */
static inline double strut_friction_kinetic(const strut_friction *f, double direction) {
  return f->directional && direction < 0.0 ? f->mu_kinetic_backward : f->mu_kinetic;
}

/** Do static and kinetic coefficients differ in some direction? */
static inline bool strut_friction_drops(const strut_friction *f) {
  return f->mu_static != f->mu_kinetic ||
         (f->directional && f->mu_static_backward != f->mu_kinetic_backward);
}

/** The largest kinetic coefficient, of either direction. */
static inline double strut_friction_largest(const strut_friction *f) {
  bool back = f->directional && f->mu_kinetic_backward > f->mu_kinetic;
  return back ? f->mu_kinetic_backward : f->mu_kinetic;
}

/** A row of the laws' table. */
typedef struct strut_friction_law_row {
  const char *word;
  strut_friction_class states;
  unsigned needs; /* bit p: parameter p */
} strut_friction_law_row;

/** The words of the laws as the key table lists them: "none|karnopp|...". */
#define STRUT_FRICTION_WORD(NAME, word, ...) "|" word
#define STRUT_FRICTION_WORDS (&("" STRUT_FRICTION_LAWS(STRUT_FRICTION_WORD))[1])

/** The row of a valid law. */
static inline const strut_friction_law_row *strut_friction_law_at(strut_friction_law law) {
  enum {
#define STRUT_FRICTION_ROW(NAME, ...) NAME##_BIT = 1 << STRUT_FRICTION_PARAMETER_##NAME,
    STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  static const strut_friction_law_row rows[] = {
#define STRUT_FRICTION_ROW(NAME, word, states, needs) {word, STRUT_FRICTION_##states, needs},
      STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  return &rows[law];
}

static inline bool strut_friction_needs(strut_friction_law law, int parameter) {
  return strut_friction_law_at(law)->needs >> parameter & 1u;
}

/** Key of a parameter. */
static inline const char *strut_friction_key(int parameter) {
  static const char *const keys[] = {
#define STRUT_FRICTION_ROW(NAME, field, range) #field,
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  return keys[parameter];
}

/** Must the parameter be above zero where the law needs it? Otherwise it must not be negative. */
static inline bool strut_friction_above_zero(int parameter) {
  enum { NOT_NEGATIVE, ABOVE_ZERO };
  static const bool above[] = {
#define STRUT_FRICTION_ROW(NAME, field, range) range == ABOVE_ZERO,
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  return above[parameter];
}

/** The friction's number for a parameter. */
static inline double *strut_friction_parameter(strut_friction *friction, int parameter) {
  double *const numbers[] = {
#define STRUT_FRICTION_ROW(NAME, field, range) &friction->field,
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  return numbers[parameter];
}

static inline double strut_friction_value(const strut_friction *friction, int parameter) {
  strut_friction copy = *friction;
  return *strut_friction_parameter(&copy, parameter);
}

/** Sign of x: -1, 0 or 1. */
static inline double strut_sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

/*
 * Each law's force along the ground [N] under the normal force [N] > 0 at the speed `slip` along it
 * [m/s]; applied: F_res, the sum of the other forces along the ground [N], for laws that stick. And
 * its slope: -d force / d slip at rest [N s/m], 0 of laws that are not continuous.
 */

static inline double strut_friction_force_NONE(const strut_friction *f, double normal, double slip,
                                               double applied) {
  (void)f, (void)normal, (void)slip, (void)applied;
  return 0.0;
}
static inline double strut_friction_slope_NONE(const strut_friction *f, double normal) {
  (void)f, (void)normal;
  return 0.0;
}

/** Coulomb's law with Karnopp's band, equation (9) as printed. */
static inline double strut_friction_force_KARNOPP(const strut_friction *f, double normal,
                                                  double slip, double applied) {
  double speed = slip < 0.0 ? -slip : slip, push = applied < 0.0 ? -applied : applied;
  if (speed >= f->stick_velocity) return -f->mu_kinetic * normal * strut_sign(slip);
  if (push >= f->mu_static * normal) return -f->mu_kinetic * normal * strut_sign(applied);
  return -applied;
}
static inline double strut_friction_slope_KARNOPP(const strut_friction *f, double normal) {
  return strut_friction_slope_NONE(f, normal);
}

/** At a speed of exactly zero; methods with events hold the node there instead. */
static inline double strut_friction_force_COULOMB(const strut_friction *f, double normal,
                                                  double slip, double applied) {
  return strut_friction_force_KARNOPP(f, normal, slip, applied);
}
static inline double strut_friction_slope_COULOMB(const strut_friction *f, double normal) {
  return strut_friction_slope_NONE(f, normal);
}

/**
 * -mu N u / sqrt(u^2 + w^2), within 1 % of mu N from |u| = 7 w on. A node under load creeps. Algebraic,
 * so that every machine gives the same bits.
 */
static inline double strut_friction_force_SMOOTH(const strut_friction *f, double normal,
                                                 double slip, double applied) {
  (void)applied;
  return -f->mu_kinetic * normal * slip / sqrt(slip * slip + f->width * f->width);
}
static inline double strut_friction_slope_SMOOTH(const strut_friction *f, double normal) {
  return normal * strut_friction_largest(f) / f->width;
}

/** Contact states of a law; see strut_friction_class. */
static inline strut_friction_class strut_friction_states(strut_friction_law law) {
  switch (law) {
#define STRUT_FRICTION_ROW(NAME, word, states, needs)                                              \
  case STRUT_FRICTION_##NAME: return STRUT_FRICTION_##states;
    STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
    case STRUT_FRICTION_LAW_COUNT: break;
  }
  return STRUT_FRICTION_ABSENT;
}

/** Has it a band of speeds in which it balances the other forces? */
static inline bool strut_friction_has_band(strut_friction_law law) {
  switch (strut_friction_states(law)) {
    case STRUT_FRICTION_STICK_BAND: return true;
    case STRUT_FRICTION_ABSENT:
    case STRUT_FRICTION_EXACT_STICK:
    case STRUT_FRICTION_CONTINUOUS: break;
  }
  return false;
}

/** Does it need a method with events? */
static inline bool strut_friction_is_exact(strut_friction_law law) {
  switch (strut_friction_states(law)) {
    case STRUT_FRICTION_EXACT_STICK: return true;
    case STRUT_FRICTION_ABSENT:
    case STRUT_FRICTION_STICK_BAND:
    case STRUT_FRICTION_CONTINUOUS: break;
  }
  return false;
}

/** Is it a force that follows from the speed alone? */
static inline bool strut_friction_is_continuous(strut_friction_law law) {
  switch (strut_friction_states(law)) {
    case STRUT_FRICTION_CONTINUOUS: return true;
    case STRUT_FRICTION_ABSENT:
    case STRUT_FRICTION_STICK_BAND:
    case STRUT_FRICTION_EXACT_STICK: break;
  }
  return false;
}

/** Force of the law [N]; see the laws' own. A directional one is that of the direction it resists. */
static inline double strut_friction_force(const strut_friction *f, double normal, double slip,
                                          double applied) {
  strut_friction towards = *f;
  bool slides = slip != 0.0 && (slip < 0.0 ? -slip : slip) >= f->stick_velocity;
  double direction = slides ? slip : applied;
  towards.mu_static = strut_friction_static(f, direction);
  towards.mu_kinetic = strut_friction_kinetic(f, direction);
  f = &towards;
  switch (f->law) {
#define STRUT_FRICTION_ROW(NAME, ...)                                                              \
  case STRUT_FRICTION_##NAME: return strut_friction_force_##NAME(f, normal, slip, applied);
    STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
    case STRUT_FRICTION_LAW_COUNT: break;
  }
  return 0.0;
}

/** Slope of the law at rest under the normal force [N s/m]; see the laws' own. */
static inline double strut_friction_slope(const strut_friction *f, double normal) {
  switch (f->law) {
#define STRUT_FRICTION_ROW(NAME, ...)                                                              \
  case STRUT_FRICTION_##NAME: return strut_friction_slope_##NAME(f, normal);
    STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
    case STRUT_FRICTION_LAW_COUNT: break;
  }
  return 0.0;
}

#endif
