/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Curves of special points over two parameters: folds, period doublings, grazings and lift-offs.
 *
 * On the surface of periodic motions a test function vanishes along such a curve: det(dP - 1) at folds,
 * det(dP + 1) at doublings, the extremum of a node's gap at grazings and lift-offs. The curve is followed by
 * arclength in state and parameters; across it the root is found by a secant, so that no derivative of the
 * test function is needed. Where a curve of folds has a cusp its points are regular; only its projection to
 * the parameters turns back.
 */
#ifndef STRUT_ENGINE_RUN_FOLLOW_CURVE_H
#define STRUT_ENGINE_RUN_FOLLOW_CURVE_H

#include "engine/run/follow/follow.h"
#include "engine/run/follow/follow_surface.h"

/** A point of a curve. The state belongs to the curve. */
typedef struct strut_follow_curve_point {
  double value[2], arc; /* of the parameters [SI]; along the curve, from its lower end [1] */
  double velocity, work, amplitude; /* as of a point of a branch */
  bool cusp;                        /* two folds meet; between two points, interpolated */
  bool stable;          /* all multipliers but the one that decides are within the unit circle */
  double multiplier[2]; /* the largest of these; NAN where there is none */
  double *y;            /* (both) */
} strut_follow_curve_point;

typedef struct strut_follow_curve {
  strut_follow_kind kind; /* FOLD, DOUBLING, TOUCH or LIFT */
  int32_t contact;        /* of TOUCH and LIFT */
  int32_t repeats;
  const char *node; /* of TOUCH and LIFT; or NULL */
  size_t count, start;
  strut_follow_curve_point *points; /* (count) by arc */
  const char *ends[2];              /* why it ends there: sentences without full stop */
  int64_t maps;
  bool travels;
  strut_arena arena;
} strut_follow_curve;

/** Where a curve starts: near a motion y (both) at two values. */
typedef struct strut_follow_curve_start {
  strut_follow_kind kind;
  const char *node; /* of TOUCH and LIFT */
  double value[2];  /* [SI] */
  const double *y;
} strut_follow_curve_start;

typedef struct strut_follow_curve_limits {
  int32_t steps;  /* most steps each way */
  double longest; /* step of a parameter, in its range */
} strut_follow_curve_limits;

/** Can curves of the kind be followed? */
STRUT_API bool strut_follow_curve_known(strut_follow_kind kind);
/**
 * Follows the curve both ways; the surface is open at values near the start, with its units. Where the
 * start is on no curve, count is 0 and ends[0] says why. The curve is to be freed in any case; with
 * STRUT_INTERRUPTED it holds what was followed so far.
 */
STRUT_API strut_status strut_follow_curve_make(strut_follow_surface *u,
                                               const strut_follow_curve_start *start,
                                               const strut_follow_curve_limits *limits,
                                               strut_follow_curve *curve, strut_error *error);
STRUT_API void strut_follow_curve_free(strut_follow_curve *curve);
/** Does the curve pass the start, which has as many repeats? */
STRUT_API bool strut_follow_curve_passes(const strut_follow_surface *u,
                                         const strut_follow_curve *curve,
                                         const strut_follow_curve_start *start);

#endif
