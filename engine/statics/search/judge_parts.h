/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What judging a small and a large structure share.
 */
#ifndef STRUT_ENGINE_STATICS_SEARCH_JUDGE_PARTS_H
#define STRUT_ENGINE_STATICS_SEARCH_JUDGE_PARTS_H

#include "engine/statics/search/critical.h"

typedef struct strut_judgement {
  const strut_potential *potential;
  strut_sparse *hessian; /* at the shape, without cables and contacts that rounding alone closes */
  double least;          /* [N] what they must pull or push by */
  double *motion;        /* (3, n) rigid-body motions without stiffness, orthonormal */
  int32_t rigid;         /* how many of them there are */
  double *work;          /* (3 n) */
} strut_judgement;

/** Signs of D and the lowest eigenvalues; false: out of memory. */
bool strut_judge_sparse(const strut_judgement *judgement, strut_arena *arena,
                        strut_critical_point *point);

/** The first of `count` modes (count, n), softest first, that is no rigid motion, as the softest. */
void strut_judge_softest(const strut_judgement *judgement, const double *modes, int32_t count,
                         double *direction, strut_critical_point *point);

#endif
