/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What evaluating a point of a study needs: distances from its goals, equilibria of points nearby.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_EVALUATION_H
#define STRUT_ENGINE_STUDY_SWEEP_EVALUATION_H

#include "engine/scene/experiment.h"
#include "engine/scene/study.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/path/path.h"

/* How far a point is from what a study wants: a shape, a curve of force over displacement; and what a
 * small force at a node meets.
 */

/** Are what the study names there, a node or a configuration with positions? STRUT_BAD_SCENE. */
strut_status strut_goals_check(const strut_study *study, const strut_scene *scene,
                               strut_error *error);
/**
 * Root mean square distance [m] of nodes from the wanted shape after the best rigid motion, which turns
 * and moves the whole but does not mirror it. positions (node_count, 2). NAN: the study wants none, or a
 * node is not there.
 */
double strut_goals_shape_distance(const strut_study *study, const strut_scene *scene,
                                  const double *positions);
/**
 * The force that holds the displaced coordinate at a displacement [N]; NAN: that is not reached, or the path displaces
 * none.
 */
double strut_goals_force_at(const strut_path *path, double displacement);
/**
 * Root mean square difference [N] of the force that holds the displaced coordinate from the wanted
 * curve; where a path passes a displacement several times, its first passage counts. NAN: one of the
 * displacements is not reached.
 */
double strut_goals_curve_distance(const strut_study *study, const strut_path *path);
/** Stiffness at the study's node along its direction, at the equilibrium q [N/m]; NAN: none. */
strut_status strut_goals_stiffness(const strut_study *study, const strut_model *model,
                                   const double *positions, double *stiffness, strut_error *error);

/** Indices of those that stand, by energy, *count of them, in the arena; equal ones in the order of the list. NULL: memory is out. */
int32_t *strut_standing_states(const strut_equilibria *equilibria, strut_arena *arena,
                               size_t *count);
/** The i-th lowest elastic mode, or NULL; unknown ones count. */
const strut_mode *strut_elastic_mode(const strut_modes *modes, size_t i);

/* Equilibria of a study's scenes, found once for all points with the same statics.
 *
 * Where a structure stands does not depend on its drive, on friction or on how it is integrated. So
 * the points of most studies have their equilibria in common; those that have are identified by the
 * numbers that do matter, compared bit by bit. A point gets the bits it would get on its own.
 */

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
