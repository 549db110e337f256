/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Searching a scene made of rows of numbers, and asking what was found.
 */
#ifndef STRUT_TESTS_UNIT_CRITICAL_SUPPORT_H
#define STRUT_TESTS_UNIT_CRITICAL_SUPPORT_H

#include "engine/statics/search/critical.h"

/** A scene (fill it first), and what a search of it gives. */
typedef struct fixture {
  strut_scene scene;
  strut_model *model;
  strut_potential *potential;
  strut_critical_set set;
} fixture;

/** Compiles and searches with seed 1; checks what every point must be. */
void critical_find(fixture *f, const uint8_t *held, bool ground, bool saddles);
void critical_tear_down(fixture *f);

size_t count_of(const fixture *f, strut_stability label);
/** The point of that label whose potential is nearest. */
const strut_critical_point *nearest(const fixture *f, strut_stability label, double value);
/** Exactly these energies, in this order, are the minima's, all of them stable. */
void assert_minima(const fixture *f, const double *energy, size_t count, double tolerance);
void assert_saddle(const fixture *f, double energy, double tolerance, int32_t negative);

/** A structure by its numbers alone. */
typedef struct node_row {
  double x, y;
  int fixed; /* 1: in x, 2: in y */
} node_row;
typedef struct member_row {
  strut_member_kind kind;
  int a, b; /* from 1 */
  double stiffness, rest;
} member_row;

void critical_build(strut_scene *scene, const node_row *node, int nodes, const member_row *member,
                    int members);
#define BUILD(scene, node, member)                                                                 \
  critical_build(scene, node, (int)(sizeof(node) / sizeof(node)[0]), member,                       \
                 (int)(sizeof(member) / sizeof(member)[0]))

#endif
