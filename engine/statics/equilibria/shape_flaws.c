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
static double turn(const double *a, const double *b, const double *c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool members_cross(const strut_model *model, const double *q, int32_t i, int32_t j) {
  const strut_member_table *t = &model->members;
  if (t->from[i] == t->from[j] || t->from[i] == t->to[j] || t->to[i] == t->from[j] ||
      t->to[i] == t->to[j])
    return false;
  const double *a = q + t->from[i], *b = q + t->to[i], *c = q + t->from[j], *d = q + t->to[j];
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

static double margin(const things *t) { return 1e-4 * t->model->size; }

static void compare(const things *t, int32_t i, int32_t j) {
  const double *q = t->q;
  if (t->members)
    t->flaws->crossings += members_cross(t->model, q, i, j);
  else if (hypot(q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]) < margin(t))
    t->flaws->collapsed = true;
}

static bool is_done(const things *t) { return !t->members && t->flaws->collapsed; }

/* The rectangle of a thing; two things whose rectangles do not touch have no flaw. */
typedef struct extent {
  double least[2], most[2];
  int32_t thing;
} extent;

static extent extent_of(const things *t, int32_t i) {
  const strut_member_table *m = &t->model->members;
  extent e = {.thing = i};
  for (int c = 0; c < 2; c++) {
    double a = t->q[t->members ? (int32_t)m->from[i] + c : 2 * i + c];
    double b = t->members ? t->q[(int32_t)m->to[i] + c] : a + margin(t);
    e.least[c] = fmin(a, b);
    e.most[c] = fmax(a, b);
  }
  return e;
}

static int by_left_edge(const void *a, const void *b) {
  double x = ((const extent *)a)->least[0], y = ((const extent *)b)->least[0];
  return (x > y) - (x < y);
}

static void find_flaws(const things *t) {
  extent *e = strut_allocate((size_t)t->count + 1, sizeof *e);
  if (!e) { /* memory is out */
    for (int32_t i = 0; i < t->count; i++)
      for (int32_t j = 0; j < i && !is_done(t); j++) compare(t, i, j);
    return;
  }
  for (int32_t i = 0; i < t->count; i++) e[i] = extent_of(t, i);
  qsort(e, (size_t)t->count, sizeof *e, by_left_edge);
  for (int32_t i = 0; i < t->count && !is_done(t); i++)
    for (int32_t j = i + 1; j < t->count && e[j].least[0] <= e[i].most[0]; j++)
      if (e[j].least[1] <= e[i].most[1] && e[j].most[1] >= e[i].least[1])
        compare(t, e[i].thing, e[j].thing);
  strut_release(e);
}

void strut_find_shape_flaws(const strut_model *model, strut_equilibrium *e) {
  e->collapsed = false, e->crossings = 0;
  find_flaws(&(things){model, e->point.q, model->node_count, false, e});
  find_flaws(&(things){model, e->point.q, model->members.count, true, e});
}
