/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Where a change of shape pushes the bodies of a collision through each other.
 *
 * Collisions are springs of finite stiffness, and two rods that cross touch nowhere, so that the potential alone
 * keeps no body out of another. Two rods pass through each other where an end of one meets the axis of the
 * other, a node and a rod where the node does, two nodes where they come closer than half of the thickness.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_PASSAGES_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_PASSAGES_H

#include "engine/statics/search/critical.h"

/** The first collision whose axes cross in the shape q (length), or come closer than half of the thickness;
    -1: none. */
int32_t strut_overlap_find(const strut_model *model, const double *q);

/** The first collision whose bodies pass through each other while all nodes move straight from a to b (length);
    -1: none. */
int32_t strut_passage_find(const strut_model *model, const double *a, const double *b);

/** The first collision of two rods that cross in one of the shapes a and b (length) only; -1: none. No motion
    leads from one to the other without pushing an end of one rod through the other. */
int32_t strut_crossing_find(const strut_model *model, const double *a, const double *b);

/**
 * through (set->count) gets for each saddle with one way down on either side a collision that is on one of them,
 * else -1. A floppy minimum is listed once for all shapes of its energy: a way to it leads through a
 * collision also where the straight way on to the shape that is listed does, or, where whole shapes are free to be
 * placed (`merged`), where crossing rods tell the two apart.
 * STRUT_OK or STRUT_NO_MEMORY. The flag ends it early; it may be NULL.
 */
strut_status strut_passages_find(const strut_potential *potential, const strut_critical_set *set,
                                 bool merged, const volatile sig_atomic_t *interrupt,
                                 int32_t *through, strut_error *error);

#endif
