/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Shapes to start a search from: folds of a known shape, and random ones, each by its number alone.
 */
#ifndef STRUT_ENGINE_STATICS_SEARCH_STARTS_H
#define STRUT_ENGINE_STATICS_SEARCH_STARTS_H

#include "engine/statics/potential.h"

/** Number of folds of a shape: mirror images of the whole, of either side of a member, and
    of single nodes across the line through two of their neighbours. */
int64_t strut_fold_count(const strut_potential *potential);
/** q (length) becomes fold number `fold` of itself; held coordinates stay. */
void strut_fold(const strut_potential *potential, int64_t fold, double *q);

/** Random shape number `index` of `seed`: positions at random, or a shaken or folded start. */
void strut_random_shape(const strut_potential *potential, uint64_t seed, uint64_t index, double *q);

/**
 * Replaces nodes of q by those of `other`, chosen by the bits of random number `index` of `seed`.
 */
void strut_cross(const strut_potential *potential, uint64_t seed, uint64_t index,
                 const double *other, double *q);

/** q shaken by a random part of the structure's size, from a hundredth to a half. */
void strut_shake(const strut_potential *potential, uint64_t seed, uint64_t index, double *q);

/** Bits of a generator that is a counter: the same for the same (seed, index, counter). */
uint64_t strut_counted_bits(uint64_t seed, uint64_t index, uint64_t *counter);

#endif
