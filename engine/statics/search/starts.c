/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/search/starts.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Single nodes are folded across the line of one member of theirs and the next that leads away. */
enum { WHOLE = 2 };

static uint64_t mix_bits(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

uint64_t strut_counted_bits(uint64_t seed, uint64_t index, uint64_t *counter) {
  uint64_t key = mix_bits(seed + 0x9e3779b97f4a7c15u) ^ mix_bits(index * 0xd1342543de82ef95u + 1);
  return mix_bits(key + (*counter += 1) * 0x9e3779b97f4a7c15u);
}

typedef struct source {
  uint64_t seed, index, counter;
} source;

/* In [-1, 1). */
static double signed_unit(source *s) {
  return (double)(strut_counted_bits(s->seed, s->index, &s->counter) >> 11) * 0x1p-52 - 1.0;
}

static int64_t random_below(source *s, int64_t count) {
  assert(count > 0);
  return (int64_t)(strut_counted_bits(s->seed, s->index, &s->counter) % (uint64_t)count);
}

int64_t strut_fold_count(const strut_potential *p) {
  return WHOLE + 4 * (int64_t)p->model->members.count;
}

static void set_node(const strut_potential *p, double *q, int32_t node, const double at[2]) {
  for (int c = 0; c < 2; c++)
    if (p->row_of[2 * node + c] >= 0) q[2 * node + c] = at[c];
}

/* The mirror image of a node in the line through a with direction u (not of unit length). */
static void mirror_point(const double *at, const double *a, const double u[2], double image[2]) {
  double square = u[0] * u[0] + u[1] * u[1], dx = at[0] - a[0], dy = at[1] - a[1];
  double share = square > 0 ? (dx * u[0] + dy * u[1]) / square : 0.0;
  image[0] = a[0] + 2.0 * share * u[0] - dx;
  image[1] = a[1] + 2.0 * share * u[1] - dy;
}

/* All nodes on one side of a member's line go to the other. */
static void fold_side(const strut_potential *p, int32_t member, double side, double *q) {
  const strut_member_table *t = &p->model->members;
  double a[2] = {q[t->from[member]], q[t->from[member] + 1]};
  double u[2] = {q[t->to[member]] - a[0], q[t->to[member] + 1] - a[1]};
  for (int32_t i = 0; i < p->model->node_count; i++) {
    double *at = q + 2 * i, image[2];
    if (!(side * (u[0] * (at[1] - a[1]) - u[1] * (at[0] - a[0])) > 0)) continue;
    mirror_point(at, a, u, image);
    set_node(p, q, i, image);
  }
}

/* Mirrors one end of a member in the line through its other end and a further neighbour. */
static void flip_end(const strut_potential *p, int32_t member, bool first, double *q) {
  const strut_member_table *t = &p->model->members;
  uint32_t moved = first ? t->from[member] : t->to[member];
  uint32_t hinge = first ? t->to[member] : t->from[member];
  for (int32_t k = 1; k < t->count; k++) {
    int32_t j = (member + k) % t->count;
    if (t->from[j] != moved && t->to[j] != moved) continue;
    uint32_t other = t->from[j] == moved ? t->to[j] : t->from[j];
    if (other == hinge) continue;
    double u[2] = {q[other] - q[hinge], q[other + 1] - q[hinge + 1]}, image[2];
    mirror_point(q + moved, q + hinge, u, image);
    set_node(p, q, (int32_t)(moved / 2), image);
    return;
  }
}

static void mirror_whole(const strut_potential *p, int axis, double *q) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int32_t i = 0; i < p->model->node_count; i++) {
    low = fmin(low, q[2 * i + axis]);
    high = fmax(high, q[2 * i + axis]);
  }
  for (int32_t i = 0; i < p->model->node_count; i++)
    if (p->row_of[2 * i + axis] >= 0) q[2 * i + axis] = low + high - q[2 * i + axis];
}

void strut_fold(const strut_potential *p, int64_t fold, double *q) {
  assert(fold >= 0 && fold < strut_fold_count(p));
  if (fold < WHOLE) {
    mirror_whole(p, (int)fold, q);
    return;
  }
  int32_t member = (int32_t)((fold - WHOLE) / 4), variant = (int32_t)((fold - WHOLE) % 4);
  if (variant < 2)
    fold_side(p, member, variant == 0 ? 1.0 : -1.0, q);
  else
    flip_end(p, member, variant == 2, q);
}

/* Nodes anywhere in a box about the middle of the start. */
static void scatter_nodes(const strut_potential *p, source *s, double half, double *q) {
  const strut_model *model = p->model;
  double middle[2] = {0.0, 0.0};
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    middle[at % 2] += model->start[at] / model->node_count;
  for (int32_t i = 0; i < p->n; i++) {
    int32_t at = p->coordinate[i];
    q[at] = middle[at % 2] + half * signed_unit(s);
  }
}

static void shake_nodes(const strut_potential *p, source *s, double by, double *q) {
  for (int32_t i = 0; i < p->n; i++) q[p->coordinate[i]] += by * signed_unit(s);
}

void strut_random_shape(const strut_potential *p, uint64_t seed, uint64_t index, double *q) {
  source s = {seed, index, 0};
  double size = p->model->size > 0 ? p->model->size : 1.0;
  memcpy(q, p->model->start, (size_t)p->model->length * sizeof *q);
  int64_t kind = random_below(&s, 4);
  double part = 0.65 + 0.35 * signed_unit(&s); /* 0.3 to 1 */
  if (kind < 2) {
    scatter_nodes(p, &s, size * part, q);
  } else if (kind == 2) {
    shake_nodes(p, &s, size * part / (double)(1 << random_below(&s, 5)), q);
  } else {
    for (int64_t folds = 1 + random_below(&s, 3); folds > 0; folds--)
      strut_fold(p, random_below(&s, strut_fold_count(p)), q);
    shake_nodes(p, &s, 0.02 * size, q);
  }
}

void strut_shake(const strut_potential *p, uint64_t seed, uint64_t index, double *q) {
  source s = {seed, index, 0};
  double size = p->model->size > 0 ? p->model->size : 1.0;
  double part = 0.375 + 0.125 * signed_unit(&s); /* a quarter to a half */
  shake_nodes(p, &s, size * part / (double)(1 << random_below(&s, 5)), q);
}

void strut_cross(const strut_potential *p, uint64_t seed, uint64_t index, const double *other,
                 double *q) {
  source s = {seed, index, 0};
  for (int32_t i = 0; i < p->model->node_count; i++)
    if (random_below(&s, 2)) set_node(p, q, i, other + 2 * i);
}
