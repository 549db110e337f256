/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Test functions that vanish along curves of special points. Internal to engine/run/follow. */
#ifndef STRUT_ENGINE_RUN_FOLLOW_CRITERION_H
#define STRUT_ENGINE_RUN_FOLLOW_CRITERION_H

#include "engine/run/follow/follow_curve.h"

/** Which test function, and what it needs. Zero-initialise. */
typedef struct strut_follow_criterion {
  strut_follow_kind kind;
  int32_t contact; /* of TOUCH and LIFT */
  double phase;    /* of the extremum, in repetitions; that of the last point, and of the next */
  double next_phase;
  bool phased;     /* phase is known */
  double *scratch; /* (n, n) */
} strut_follow_criterion;

/** Value of the test function at a motion, which is completed where that is needed. False: none, or status. */
bool strut_follow_criterion_at(strut_follow_surface *u, strut_follow_criterion *criterion,
                               strut_follow_surface_point *p, double *value);
/** Chooses the contact and the phase by the gaps of the node's contacts. False: none is near zero. */
bool strut_follow_criterion_choose(strut_follow_surface *u, strut_follow_criterion *criterion,
                                   const strut_follow_surface_point *p, const char *node);

#endif
