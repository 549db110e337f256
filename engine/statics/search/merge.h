/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A set of stationary points without duplicates, with copies of one shape merged. */
#ifndef STRUT_ENGINE_STATICS_SEARCH_MERGE_H
#define STRUT_ENGINE_STATICS_SEARCH_MERGE_H

#include "engine/statics/search/critical.h"

typedef struct strut_congruent_copy strut_congruent_copy;

typedef struct strut_stationary_set {
  const strut_potential *potential;
  strut_arena *arena;    /* of the points; the caller's */
  bool congruent;        /* copies of one shape are one point */
  bool shifts[2], turns; /* rigid motions that no support, load or ground forbids */
  double near;           /* two shapes are one within this [m] */
  double flat;           /* two energies may differ by this anyway [J] */
  size_t count, room;
  strut_critical_point *points;     /* of strut_allocate */
  strut_congruent_copy **placement; /* (count) their different placements; of strut_allocate */
} strut_stationary_set;

void strut_stationary_set_start(strut_stationary_set *set, const strut_potential *potential,
                                strut_arena *arena);
void strut_stationary_set_free(strut_stationary_set *set);

/** Index of the point that q equals, or -1. */
int32_t strut_stationary_set_find(const strut_stationary_set *set, const double *q);
/** Finds or judges and adds q; *index is its point, whose `found` has grown by one. */
strut_status strut_stationary_set_add(strut_stationary_set *set, const double *q, int32_t *index,
                                      bool *fresh, strut_error *error);
/** The k-th different placement of a point (length), or NULL. */
const double *strut_stationary_set_placement(const strut_stationary_set *set, int32_t index,
                                             int32_t k);

/** Numbers the shapes: points of one number are mirror images of each other. */
void strut_number_shapes(const strut_stationary_set *like, strut_critical_point *points,
                         size_t count);

#endif
