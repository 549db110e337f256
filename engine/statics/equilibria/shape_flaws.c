/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdlib.h>

#include "engine/base/memory.h"
#include "engine/statics/equilibria/equilibria_parts.h"

/*
 * Which nodes coincide and which members cross. Only those are compared whose extents along x overlap: they
 * are sorted by where these begin.
 */

/* Twice the area of a, b, c: positive where they turn left. */
static double turn(const double *first, const double *second, const double *c) {
  return (second[0] - first[0]) * (c[1] - first[1]) - (second[1] - first[1]) * (c[0] - first[0]);
}

static bool members_cross(const strut_model *model, const double *positions, int32_t i, int32_t j) {
  const strut_member_table *members = &model->members;
  if (members->from[i] == members->from[j] || members->from[i] == members->to[j] ||
      members->to[i] == members->from[j] || members->to[i] == members->to[j])
    return false;
  const double *a = positions + members->from[i], *b = positions + members->to[i],
               *c = positions + members->from[j], *d = positions + members->to[j];
  double least = 1e-8 * model->size * model->size;
  double c_side = turn(a, b, c), d_side = turn(a, b, d);
  double a_side = turn(c, d, a), b_side = turn(c, d, b);
  bool apart = fmin(fabs(c_side), fabs(d_side)) > least && fmin(fabs(a_side), fabs(b_side)) > least;
  return apart && (c_side > 0) != (d_side > 0) && (a_side > 0) != (b_side > 0);
}

/* What is compared: nodes, or members. */
typedef struct things {
  const strut_model *model;
  const double *q;
  int32_t count;
  bool members;
  strut_equilibrium *flaws;
} things;

static double margin(const things *self) { return 1e-4 * self->model->size; }

static void compare(const things *self, int32_t i, int32_t j) {
  const double *q = self->q;
  if (self->members)
    self->flaws->crossings += members_cross(self->model, q, i, j);
  else if (hypot(q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]) < margin(self))
    self->flaws->collapsed = true;
}

static bool is_done(const things *self) { return !self->members && self->flaws->collapsed; }

/* The rectangle of a thing; two things whose rectangles do not touch have no flaw. */
typedef struct extent {
  double least[2], most[2];
  int32_t thing;
} extent;

static extent extent_of(const things *self, int32_t i) {
  const strut_member_table *members = &self->model->members;
  extent e = {.thing = i};
  for (int c = 0; c < 2; c++) {
    double a = self->q[self->members ? (int32_t)members->from[i] + c : 2 * i + c];
    double b = self->members ? self->q[(int32_t)members->to[i] + c] : a + margin(self);
    e.least[c] = fmin(a, b);
    e.most[c] = fmax(a, b);
  }
  return e;
}

static int by_left_edge(const void *first, const void *second) {
  double x = ((const extent *)first)->least[0], y = ((const extent *)second)->least[0];
  return (x > y) - (x < y);
}

static void find_flaws(const things *self) {
  extent *e = strut_allocate((size_t)self->count + 1, sizeof *e);
  if (!e) { /* memory is out */
    for (int32_t i = 0; i < self->count; i++)
      for (int32_t j = 0; j < i && !is_done(self); j++) compare(self, i, j);
    return;
  }
  for (int32_t i = 0; i < self->count; i++) e[i] = extent_of(self, i);
  qsort(e, (size_t)self->count, sizeof *e, by_left_edge);
  for (int32_t i = 0; i < self->count && !is_done(self); i++)
    for (int32_t j = i + 1; j < self->count && e[j].least[0] <= e[i].most[0]; j++)
      if (e[j].least[1] <= e[i].most[1] && e[j].most[1] >= e[i].least[1])
        compare(self, e[i].thing, e[j].thing);
  strut_release(e);
}

void strut_find_shape_flaws(const strut_model *model, strut_equilibrium *equilibrium) {
  equilibrium->collapsed = false, equilibrium->crossings = 0;
  find_flaws(&(things){model, equilibrium->point.q, model->node_count, false, equilibrium});
  find_flaws(&(things){model, equilibrium->point.q, model->members.count, true, equilibrium});
}
