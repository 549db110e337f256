/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the functions of all laws take and return; see engine/scene/law.h. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/**
 * The numbers that laws may need: X(NAME, field, range, measure): field is the key, too; range: what is allowed where a law needs the
 * number, ANY_NUMBER or ABOVE_ZERO; measure: it is a STRAIN, a SLOPE, force per strain, or a FORCE.
 */
#define STRUT_LAW_PARAMETERS(X)                                                                    \
  X(KNEE, knee, ABOVE_ZERO, STRAIN) /* |x| at which a bilinear law changes its slope */            \
  X(SECOND_STIFFNESS, second_stiffness, ANY_NUMBER, SLOPE) /* slope beyond it */                   \
  X(GAP, gap, ABOVE_ZERO, STRAIN)     /* free play on either side of the natural strain */         \
  X(SCALE, scale, ABOVE_ZERO, STRAIN) /* x over which an exponential law grows by e */             \
  X(YIELD, yield, ABOVE_ZERO, FORCE)  /* force at which an elastic-plastic law gives way */

/** Lists that laws may need: X(NAME, key, LIST). */
#define STRUT_LAW_LISTS(X)                                                                         \
  X(COEFFICIENTS, coefficients, LIST)     /* of x, x^2, ... of a polynomial */                     \
  X(POINTS, points, LIST)                 /* of a table or a curve */                              \
  X(CONTROL_POINTS, control_points, LIST) /* of a curve */

/**
 * A piecewise cubic force: between x[i] and x[i+1] it is c0 + c1 d + c2 d^2 + c3 d^3 with d = x - x[i];
 * beyond the ends it is straight on with the slope at the end. Of a curve that folds x need not increase.
 */
typedef struct strut_law_curve {
  size_t count;             /* points */
  const double *x;          /* (count) increasing, or of a curve that folds not */
  const double (*piece)[4]; /* (count - 1) */
  const double *energy;     /* (count) integral of the force from x = 0 to x[i] */
  bool smooth; /* the slope is continuous: no kinks; of a curve: its kinks stand for a bend */
  int start;   /* of a curve that folds: the stable piece at x = 0 with the least force */
} strut_law_curve;

/** A law with its numbers, as functions of it take it. */
typedef struct strut_law_numbers {
  double stiffness; /* force per strain at x = 0, of laws that use it */
#define STRUT_LAW_ROW(NAME, field, ...) double field;
  STRUT_LAW_PARAMETERS(STRUT_LAW_ROW)
#undef STRUT_LAW_ROW
  const strut_law_curve *curve; /* of a table */
  size_t count;                 /* of a polynomial */
  const double *coefficient;    /* (count) of x, x^2, ... */
  double axial;                 /* EA of a member whose stiffness is EA over the natural strain */
  int material;                 /* the law of such a member, a strut_law_kind */
  double area;                  /* of a cell as drawn [m^2] */
  double exponent, outside;     /* of a gas: its isentropic exponent, the pressure outside [N/m] */
} strut_law_numbers;

/** What a law gives at a strain: force, energy from the natural strain on, and slope d force / d e. */
typedef struct strut_law_response {
  double force, energy, slope;
  double excess; /* d energy / d e0, + force but of cells: 0 of a law of e - e0 alone */
} strut_law_response;

/* Beyond this a difference of functions loses no more digits than its series has terms. */
#define STRUT_LAW_SERIES 0.05

/** exp(u) - 1 - u, to rounding. */
static inline double strut_law_exp_rest(double u) {
  if (fabs(u) > STRUT_LAW_SERIES) return expm1(u) - u;
  double sum = 1.0;
  for (int n = 10; n > 2; n--) sum = 1.0 + sum * u / (double)n;
  return 0.5 * u * u * sum;
}

/** (1 + u) log(1 + u) - u, to rounding. */
static inline double strut_law_log_rest(double u) {
  if (fabs(u) > STRUT_LAW_SERIES) return (1.0 + u) * log1p(u) - u;
  double sum = 0.0;
  for (int n = 13; n > 1; n--) sum = 1.0 / (double)(n * (n - 1)) - u * sum;
  return u * u * sum;
}

/** The functions of a law without kinks. */
#define STRUT_LAW_WITHOUT_KINKS(name)                                                              \
  static inline int strut_law_##name##_kinks(const strut_law_numbers *n) {                         \
    (void)n;                                                                                       \
    return 0;                                                                                      \
  }                                                                                                \
  static inline double strut_law_##name##_kink(const strut_law_numbers *n, int k) {                \
    (void)n, (void)k;                                                                              \
    return 0.0;                                                                                    \
  }
