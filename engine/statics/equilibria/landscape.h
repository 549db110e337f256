/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The stationary points of one potential as a landscape: basins, and the passes between them.
 */
#ifndef STRUT_ENGINE_STATICS_EQUILIBRIA_LANDSCAPE_H
#define STRUT_ENGINE_STATICS_EQUILIBRIA_LANDSCAPE_H

#include "engine/statics/search/critical.h"

typedef struct strut_landscape {
  const strut_potential *potential;
  bool merged; /* congruent shapes are one point, mirror images too */
  strut_critical_set set;
  int32_t minima; /* stable and floppy points: the first ones of the set */
  int32_t
      *through; /* (set.count) a collision that a saddle's ways down lead through, or -1; NULL: the
                        scene has no collision */
  double *lowest;    /* (minima) potential of the lowest pass out of it [J]; HUGE_VAL: none known */
  int32_t *parent;   /* (minima) scratch of the path searches below */
  strut_arena arena; /* of the above */
} strut_landscape;

/** strut_landscape_free releases it, after a failure too. */
strut_status strut_landscape_create(const strut_potential *potential,
                                    const strut_critical_effort *effort, strut_landscape *landscape,
                                    strut_error *error);
void strut_landscape_free(strut_landscape *landscape);

/** The minimum that the shape q (length) is, or -1. */
int32_t strut_landscape_find(const strut_landscape *landscape, const double *q);

/** A strut_pass_of for a landscape as the context. */
double strut_landscape_pass(const void *landscape, const double *q);

/**
 * Index of the highest saddle on the lowest path from minimum a to minimum b; -1 if the known
 * saddles do not connect them. Saddles that lead through a collision are none.
 */
int32_t strut_landscape_path(const strut_landscape *landscape, int32_t a, int32_t b);

/** The lowest saddle that leads from minimum a down to minimum b the other way, or -1. */
int32_t strut_landscape_direct(const strut_landscape *landscape, int32_t a, int32_t b);

/**
 * Writes the minima between a and b on the shortest path over saddles up to `highest` to via
 * (minima), in order; returns their count.
 */
int32_t strut_landscape_between(const strut_landscape *landscape, int32_t a, int32_t b,
                                int32_t highest, int32_t *via);

/* Where a change of shape pushes the bodies of a collision through each other.
 *
 * Collisions are springs of finite stiffness, and two rods that cross touch nowhere, so that the potential alone
 * keeps no body out of another. Two rods pass through each other where an end of one meets the axis of the
 * other, a node and a rod where the node does, two nodes where they come closer than half of the thickness.
 */

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
