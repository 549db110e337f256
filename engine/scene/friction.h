/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Friction of a contact as a scene describes it, and its force for single contacts.
 *
 * The laws are rows and texts of laws/friction.h, over which reader, writer, checks, step limit, contact
 * modes and forces loop.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/scene/laws/friction.h"

/** Contact states under a law. */
typedef enum strut_friction_class {
  STRUT_FRICTION_ABSENT,      /* no force */
  STRUT_FRICTION_STICK_BAND,  /* balances the other forces below the speed stick_velocity */
  STRUT_FRICTION_EXACT_STICK, /* sticks without moving; needs a method with events */
  STRUT_FRICTION_CONTINUOUS,  /* a force that depends on the speed without a jump: no states */
  STRUT_FRICTION_BRISTLES     /* continuous too, with an internal state; see model/model.h */
} strut_friction_class;

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
      directional; /* motion towards -x along the ground has coefficients of its own, the last two */
  bool driven;     /* all coefficients are those of a signal, 0 where that is negative */
  int32_t signal;  /* where driven */
  double mu_static_backward, mu_kinetic_backward; /* [1] */
} strut_friction;

/** The friction with this coefficient, the value of its signal. */
static inline void strut_friction_drive(strut_friction *f, double mu) {
  f->mu_static = f->mu_kinetic = mu > 0.0 ? mu : 0.0;
}

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
#define STRUT_FRICTION_WORD(NAME, name, word, ...) "|" word
#define STRUT_FRICTION_WORDS (&("" STRUT_FRICTION_LAWS(STRUT_FRICTION_WORD))[1])

/** The row of a valid law. */
static inline const strut_friction_law_row *strut_friction_law_at(strut_friction_law law) {
  enum {
#define STRUT_FRICTION_ROW(NAME, ...) NAME##_BIT = 1 << STRUT_FRICTION_PARAMETER_##NAME,
    STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  static const strut_friction_law_row rows[] = {
#define STRUT_FRICTION_ROW(NAME, name, word, states, needs) {word, STRUT_FRICTION_##states, needs},
      STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  return &rows[law];
}

static inline bool strut_friction_needs(strut_friction_law law, int parameter) {
  return strut_friction_law_at(law)->needs >> parameter & 1u;
}

/** A parameter of the laws. */
typedef struct strut_friction_parameter {
  const char *key;
  bool above_zero; /* where the law needs it; otherwise not negative */
  size_t offset;   /* in a strut_friction */
} strut_friction_parameter;

static inline const strut_friction_parameter *strut_friction_parameter_at(int parameter) {
  enum { NOT_NEGATIVE, ABOVE_ZERO };
  static const strut_friction_parameter rows[] = {
#define STRUT_FRICTION_ROW(NAME, field, range)                                                     \
  {#field, range == ABOVE_ZERO, offsetof(strut_friction, field)},
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  return &rows[parameter];
}

static inline const char *strut_friction_key(int parameter) {
  return strut_friction_parameter_at(parameter)->key;
}
static inline bool strut_friction_above_zero(int parameter) {
  return strut_friction_parameter_at(parameter)->above_zero;
}
static inline double strut_friction_value(const strut_friction *friction, int parameter) {
  const char *at = (const char *)friction + strut_friction_parameter_at(parameter)->offset;
  return *(const double *)(const void *)at;
}

/** Contact states of a law; see strut_friction_class. */
static inline strut_friction_class strut_friction_states(strut_friction_law law) {
  return strut_friction_law_at(law)->states;
}

/** Has it a band of speeds in which it balances the other forces? */
static inline bool strut_friction_has_band(strut_friction_law law) {
  return strut_friction_states(law) == STRUT_FRICTION_STICK_BAND;
}

/** Does it need a method with events? */
static inline bool strut_friction_is_exact(strut_friction_law law) {
  return strut_friction_states(law) == STRUT_FRICTION_EXACT_STICK;
}

/** Is it a force that follows from the speed alone? */
static inline bool strut_friction_is_continuous(strut_friction_law law) {
  return strut_friction_states(law) == STRUT_FRICTION_CONTINUOUS;
}

/**
 * The direction, 1 or -1, in which what sticks exactly is held by less than kinetic friction, so that it would be held
 * again as soon as it gives way; 0: neither. Signals give both coefficients.
 */
static inline int strut_friction_holds_too_little(const strut_friction *f) {
  if (f->driven || (!strut_friction_has_band(f->law) && !strut_friction_is_exact(f->law))) return 0;
  if (f->mu_static >= 0.0 && f->mu_static < f->mu_kinetic) return 1;
  bool back = f->mu_static_backward >= 0.0 && f->mu_static_backward < f->mu_kinetic_backward;
  return f->directional && back ? -1 : 0;
}

/** Has it an internal state? */
static inline bool strut_friction_has_bristles(strut_friction_law law) {
  return strut_friction_states(law) == STRUT_FRICTION_BRISTLES;
}

/** The numbers as the laws take them. */
static inline strut_law_friction_numbers strut_friction_numbers(const strut_friction *f) {
  return (strut_law_friction_numbers){
#define STRUT_FRICTION_ROW(NAME, field, range) .field = f->field,
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
          .mu_static_backward = strut_friction_static(f, -1.0),
      .mu_kinetic_backward = strut_friction_kinetic(f, -1.0)};
}

/** Force of the law under the normal force [N], with the sum of the other forces along the ground [N]. */
static inline double strut_friction_force(const strut_friction *f, double normal, double slip,
                                          double applied) {
  const strut_law_friction_numbers numbers = strut_friction_numbers(f);
  const strut_law_friction_choice has = {
#define STRUT_FRICTION_ROW(NAME, name, ...) .name = f->law == STRUT_FRICTION_##NAME,
      STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  return strut_law_friction(&numbers, &has, normal, slip, applied);
}

/** Stiffness along the ground of bristles at rest under the normal force [N/m]; 0 of laws without. */
static inline double strut_friction_stiffness(const strut_friction *f, double normal) {
  return strut_friction_has_bristles(f->law) ? normal * f->mu_static / f->presliding : 0.0;
}

/** Slope of the law at rest under the normal force [N s/m], of the direction in which it is steepest. */
static inline double strut_friction_slope(const strut_friction *f, double normal) {
  strut_law_friction_numbers numbers = strut_friction_numbers(f);
  numbers.mu_kinetic = strut_friction_largest(f);
  switch (f->law) {
#define STRUT_FRICTION_ROW(NAME, name, ...)                                                        \
  case STRUT_FRICTION_##NAME: return strut_law_friction_##name##_slope(&numbers, normal);
    STRUT_FRICTION_LAWS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
    case STRUT_FRICTION_LAW_COUNT: break;
  }
  return 0.0;
}
