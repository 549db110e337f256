/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How far a point is from what a study wants: a shape, a curve of force over displacement; and what a
 * small force at a node meets.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_GOALS_H
#define STRUT_ENGINE_STUDY_SWEEP_GOALS_H

#include "engine/scene/study.h"
#include "engine/statics/path/path.h"

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
 * Root mean square difference [N] of the force that holds the displaced coordinate from the wanted
 * curve; where a path passes a displacement several times, its first passage counts. NAN: one of the
 * displacements is not reached.
 */
double strut_goals_curve_distance(const strut_study *study, const strut_path *path);
/** Stiffness at the study's node along its direction, at the equilibrium q [N/m]; NAN: none. */
strut_status strut_goals_stiffness(const strut_study *study, const strut_model *model,
                                   const double *q, double *stiffness, strut_error *error);

#endif
