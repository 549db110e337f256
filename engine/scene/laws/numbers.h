/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the functions of all laws take and return; see engine/scene/law.h. */
#ifndef STRUT_ENGINE_SCENE_LAWS_NUMBERS_H
#define STRUT_ENGINE_SCENE_LAWS_NUMBERS_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/**
 * A piecewise cubic force: between x[i] and x[i+1] it is c0 + c1 d + c2 d^2 + c3 d^3 with d = x - x[i];
 * beyond the ends it is straight on with the slope at the end.
 */
typedef struct strut_law_curve {
  size_t count;             /* points */
  const double *x;          /* (count) increasing */
  const double (*piece)[4]; /* (count - 1) */
  const double *energy;     /* (count) integral of the force from x = 0 to x[i] */
  bool smooth;              /* the slope is continuous: no kinks */
} strut_law_curve;

/** A law with its numbers, as functions of it take it. */
typedef struct strut_law_numbers {
  double stiffness;             /* force per strain at x = 0, of laws that use it */
  double first, second;         /* the law's own, as its header says */
  const strut_law_curve *curve; /* of a table */
  size_t count;                 /* of a polynomial */
  const double *coefficient;    /* (count) of x, x^2, ... */
} strut_law_numbers;

/** What a law gives at a strain: force, energy from the natural strain on, and slope d force / d e. */
typedef struct strut_law_response {
  double force, energy, slope;
  double excess; /* d energy / d e0 + force: 0 of a law of e - e0 alone */
} strut_law_response;

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

#endif
