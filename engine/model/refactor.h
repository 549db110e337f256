/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * L D L' of a positive definite matrix whose numbers change and whose pattern stays: ordered and
 * analysed once, then factorised again and again without asking for memory.
 */
#ifndef STRUT_ENGINE_MODEL_REFACTOR_H
#define STRUT_ENGINE_MODEL_REFACTOR_H

#include "engine/base/memory.h"
#include "engine/model/linear_solver.h"

typedef struct strut_refactor strut_refactor;

/** For matrices with the pattern of this one, whose numbers do not matter. NULL: out of memory. */
strut_refactor *strut_refactor_create(const strut_sparse *pattern, strut_arena *arena);
/** -1, or the row at which the matrix shows not to be positive definite: there is no factor then. */
int32_t strut_refactor_apply(strut_refactor *refactor, const strut_sparse *matrix);
/** b (n) becomes A^-1 b, in the matrix's own order. */
void strut_refactor_solve(strut_refactor *refactor, double *b);

#endif
