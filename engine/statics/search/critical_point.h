/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A stationary point of a potential, its kind, and what is known of those not found. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "engine/base/status.h"

typedef enum strut_stability {
  STRUT_STABLE, /* all eigenvalues positive, those of free rigid-body motions apart */
  STRUT_FLOPPY, /* none negative, but a motion that is not a rigid one meets no stiffness */
  STRUT_SADDLE, /* some negative */
  STRUT_MAXIMUM /* all negative */
} strut_stability;

/** "stable", "floppy", "saddle", "maximum". */
STRUT_API const char *strut_stability_name(strut_stability stability);

typedef struct strut_critical_point {
  double *q;        /* (length) of the first placement found */
  double potential; /* [J] */
  double residual;  /* largest entry of g [N] */
  strut_stability label;
  int32_t negative; /* eigenvalues of the Hessian below zero */
  int32_t zero;     /* motions without stiffness, rigid ones included */
  int32_t rigid;    /* rigid-body motions that the supports leave free */
  int32_t eigenvalue_count;
  double *eigenvalues; /* ascending [N/m]; all of them where dense, else the lowest */
  double *softest;     /* (length) unit vector of the lowest that is no rigid-body motion */
  int64_t found;       /* starts that ended here */
  int32_t placements;  /* congruent copies merged into it: mirror images, turned, shifted */
  int32_t shape;       /* points of one number are mirror images of each other, not merged */
  int32_t down[2];     /* of a saddle with one negative: minima downhill either way, or -1 */
} strut_critical_point;

static inline bool strut_is_minimum(const strut_critical_point *point) {
  return point->label == STRUT_STABLE || point->label == STRUT_FLOPPY;
}

/** What independent random starts tell about minima that none of them has met. */
typedef struct strut_missed {
  double probability; /* of a new minimum by one more start: Good and Turing's estimate, with one
                         more counted than was met once, for few starts never tell 0 */
  double below;       /* its upper 95 % limit */
  double one;         /* upper 95 % limit of the share of starts of any one minimum not met */
  double count;       /* lower 95 % limit of the number of all minima, met or not: Chao's bound */
} strut_missed;
