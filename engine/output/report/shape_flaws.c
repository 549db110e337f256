/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Which nodes coincide and which members cross. Nodes and members are entered into the squares of a net over
 * the shape, and only those of one square are compared, so that the effort grows with their number alone.
 */
#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/report/equilibria_report.h"

enum {
  FEW = 64,
  ENTRIES_MOST = 8
}; /* fewer things are all compared; entries per thing on average */

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
  strut_shape_flaws *flaws;
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

static void compare_all(const things *t) {
  for (int32_t i = 0; i < t->count; i++)
    for (int32_t j = 0; j < i && !is_done(t); j++) compare(t, i, j);
}

/* The rectangle of a thing; two things that do not touch with theirs have no flaw. */
static void rectangle_of(const things *t, int32_t i, double least[2], double most[2]) {
  const strut_member_table *m = &t->model->members;
  for (int c = 0; c < 2; c++) {
    double a = t->q[t->members ? (int32_t)m->from[i] + c : 2 * i + c];
    double b = t->members ? t->q[(int32_t)m->to[i] + c] : a + margin(t);
    least[c] = fmin(a, b);
    most[c] = fmax(a, b);
  }
}

typedef struct net {
  double origin[2], side; /* of a square */
  int32_t squares[2];
  int32_t *start, *thing; /* of each square, row by row: the things that reach into it */
} net;

static void squares_of(const net *n, const double least[2], const double most[2], int32_t from[2],
                       int32_t to[2]) {
  for (int c = 0; c < 2; c++) {
    from[c] = (int32_t)((least[c] - n->origin[c]) / n->side);
    to[c] = (int32_t)((most[c] - n->origin[c]) / n->side);
  }
}

/* Counts the things of each square, or enters them; returns how many entries there are. */
static int64_t enter(const things *t, const net *n, bool fill) {
  int64_t entries = 0;
  for (int32_t i = 0; i < t->count; i++) {
    double least[2], most[2];
    int32_t from[2], to[2];
    rectangle_of(t, i, least, most);
    squares_of(n, least, most, from, to);
    entries += (int64_t)(to[0] - from[0] + 1) * (to[1] - from[1] + 1);
    for (int32_t y = from[1]; y <= to[1] && n->start; y++)
      for (int32_t x = from[0]; x <= to[0]; x++) {
        int32_t *at = &n->start[y * n->squares[0] + x];
        if (fill)
          n->thing[--*at] = i;
        else
          ++*at;
      }
  }
  return entries;
}

/* About as many squares as things, and larger ones where things are long. False: not to be had. */
static bool make_net(const things *t, net *n, strut_arena *arena) {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (int32_t i = 0; i < t->count; i++) {
    double least[2], most[2];
    rectangle_of(t, i, least, most);
    for (int c = 0; c < 2; c++) low[c] = fmin(low[c], least[c]), high[c] = fmax(high[c], most[c]);
  }
  double width = high[0] - low[0], height = high[1] - low[1], longer = fmax(width, height);
  if (!isfinite(longer) || !(longer > 0)) return false;
  *n = (net){.origin = {low[0], low[1]}};
  n->side = fmax(sqrt(width * height / t->count), longer / t->count);
  int64_t entries;
  for (;; n->side *= 2) {
    n->squares[0] = (int32_t)(width / n->side) + 1;
    n->squares[1] = (int32_t)(height / n->side) + 1;
    entries = enter(t, n, false);
    if (entries <= (int64_t)ENTRIES_MOST * t->count) break;
  }
  size_t squares = (size_t)n->squares[0] * (size_t)n->squares[1];
  n->thing = strut_arena_allocate(arena, (size_t)entries, sizeof *n->thing);
  n->start = strut_arena_allocate(arena, squares + 1, sizeof *n->start);
  if (!n->thing || !n->start) return false;
  enter(t, n, false);
  for (size_t k = 0; k < squares; k++) n->start[k + 1] += n->start[k];
  enter(t, n, true);
  return true;
}

/* Two things that reach into several squares together are compared in the first one only. */
static bool is_first_square(const things *t, const net *n, int32_t i, int32_t j, int32_t square) {
  double least[2][2], most[2][2], corner[2];
  int32_t from[2], to[2];
  rectangle_of(t, i, least[0], most[0]);
  rectangle_of(t, j, least[1], most[1]);
  for (int c = 0; c < 2; c++) corner[c] = fmax(least[0][c], least[1][c]);
  squares_of(n, corner, corner, from, to);
  return from[1] * n->squares[0] + from[0] == square;
}

static void find_flaws(const things *t) {
  net n;
  strut_arena arena = {0};
  bool many = t->count > FEW && make_net(t, &n, &arena);
  if (!many) compare_all(t);
  int32_t squares = many ? n.squares[0] * n.squares[1] : 0;
  for (int32_t s = 0; s < squares && !is_done(t); s++)
    for (int32_t a = n.start[s]; a < n.start[s + 1]; a++)
      for (int32_t b = n.start[s]; b < a; b++)
        if (is_first_square(t, &n, n.thing[a], n.thing[b], s)) compare(t, n.thing[a], n.thing[b]);
  strut_arena_free(&arena);
}

strut_shape_flaws strut_find_shape_flaws(const strut_model *model, const double *q) {
  strut_shape_flaws flaws = {0};
  find_flaws(&(things){model, q, model->node_count, false, &flaws});
  find_flaws(&(things){model, q, model->members.count, true, &flaws});
  return flaws;
}
