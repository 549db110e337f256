/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The inverse of a mass matrix applied by several threads, with the bits of one (engine/model/mass_kernel.h).
 *
 * Columns of the factor form a tree, in which a column waits for those below it. Each thread has some of the
 * branches; the columns where branches meet, few of them, are solved by one thread between.
 */
#ifndef STRUT_ENGINE_INTEGRATE_MASS_SHARES_H
#define STRUT_ENGINE_INTEGRATE_MASS_SHARES_H

#include "engine/base/thread_pool.h"
#include "engine/model/model.h"

typedef struct strut_mass_shares strut_mass_shares;

/** For a pool of so many threads. NULL: out of memory. */
strut_mass_shares *strut_mass_shares_create(const strut_model *model, int threads);
/** NULL is allowed. */
void strut_mass_shares_free(strut_mass_shares *shares);
/**
 * acceleration = M^-1 force, both (length), by all threads of the pool; `acceleration` is 0 before the first
 * time. Forces must be there before anyone begins, and accelerations are when all have returned.
 */
void strut_mass_shares_solve(const strut_mass_shares *shares, strut_thread_pool *pool, int thread,
                             const double *force, double *acceleration);

#endif
