/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Structures from the literature written as lists: nodes, and members such as "1-2 2-3".
 */
#ifndef STRUT_TESTS_PHYSICS_TRUSS_H
#define STRUT_TESTS_PHYSICS_TRUSS_H

#include "engine/statics/rigidity/rigidity.h"

/** Nodes at the positions, all free. */
void truss_nodes(strut_scene *scene, const double (*position)[2], size_t count);
/** Nodes on a circle of radius 1 at angles 0, 360/count, ... degrees. */
void truss_ring(strut_scene *scene, int count);
/** Members between nodes numbered from 1, of stiffness 1 and at rest as drawn. */
void truss_members(strut_scene *scene, strut_member_kind kind, const char *pairs);
/** Holds node `number` (from 1) in x, in y. */
void truss_hold(strut_scene *scene, int number, bool x, bool y);

/** A scene compiled and looked at where it is drawn. */
typedef struct truss {
  strut_scene *scene;
  strut_model *model;
  strut_rigidity found;
} truss;

void truss_look(truss *t, strut_scene *scene);
void truss_free(truss *t);

/** Expects rank, s and f. */
void truss_expect(const truss *t, int32_t rank, int32_t s, int32_t f);
/** Expects mechanisms of each kind. */
void truss_expect_kinds(const truss *t, int32_t rigid, int32_t infinitesimal, int32_t finite);
/** Expects force densities of the only state, up to a factor that is that of the first. */
void truss_expect_densities(const truss *t, const double *density, double tolerance);

#endif
