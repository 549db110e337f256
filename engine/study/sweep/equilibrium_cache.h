/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Equilibria of a study's scenes, found once for all points with the same statics.
 *
 * Where a structure stands does not depend on its drive, on friction or on how it is integrated. So
 * the points of most studies have their equilibria in common; those that have are known by the
 * numbers that do matter, compared bit by bit. A point gets the bits it would get on its own.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_EQUILIBRIUM_CACHE_H
#define STRUT_ENGINE_STUDY_SWEEP_EQUILIBRIUM_CACHE_H

#include "engine/scene/experiment.h"

/** Safe from several threads. */
typedef struct strut_equilibrium_cache strut_equilibrium_cache;

/** NULL: memory is out. */
strut_equilibrium_cache *strut_equilibrium_cache_create(void);
void strut_equilibrium_cache_free(strut_equilibrium_cache *standing); /* NULL is allowed */

/** As strut_resolve_start_equilibrium. */
strut_status strut_equilibrium_cache_resolve(strut_equilibrium_cache *standing, strut_setup *setup,
                                             strut_error *error);

/**
 * The configuration whose equilibrium is nearest to a shape (node_count, 2), turned and shifted at
 * will, or mirrored too where contacts alone tell the configuration: its index, -1 where none is
 * within a tenth of the structure's size. STRUT_OK, STRUT_NO_MEMORY.
 */
strut_status strut_equilibrium_cache_nearest(strut_equilibrium_cache *standing,
                                             const strut_setup *setup, const double *positions,
                                             int32_t *index, strut_error *error);

#endif
