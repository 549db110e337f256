/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Does a structure rest in a valley, or on a ridge? By the signs of its stiffness's factor. */
#include <math.h>
#include <string.h>

#include "engine/forces/energy.h"
#include "engine/forces/tangent.h"
#include "engine/run/settle.h"

/* Of the largest stiffness: what rounding may make of a motion without any. */
static const double NOTHING = 1e-12;
/* A shift that makes the matrix definite is found to this part, and turns of inverse iteration. */
static const double CLOSE = 0.01;
enum { TURNS = 40 };

typedef struct shifted {
  const strut_sparse *matrix;
  strut_ldl *ldl;
  strut_status status;
} shifted;

/* Negative eigenvalues of the matrix plus shift; a shift that hits one is moved a little. */
static int32_t count_negative(shifted *s, double *shift) {
  strut_inertia inertia = {0};
  for (int i = 0; i < 4; i++, *shift *= 1.001) {
    s->status = strut_ldl_factorise(s->ldl, s->matrix, *shift, &inertia);
    if (s->status != STRUT_SINGULAR) break;
  }
  return s->status ? 0 : inertia.negative;
}

/* The least shift, about, with which the matrix is positive definite; it is then factorised. */
static double lift(shifted *s, double low) {
  double high = low;
  do {
    low = high;
    high *= 16.0;
  } while (count_negative(s, &high) > 0 && isfinite(high) && !s->status);
  while (high - low > CLOSE * high && !s->status) {
    double middle = sqrt(low * high);
    if (count_negative(s, &middle) > 0)
      low = middle;
    else
      high = middle;
  }
  count_negative(s, &high);
  return high;
}

/* -1 to 1, from an index. */
static double stirred(uint64_t i) {
  uint64_t z = (i + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

/* Scales x to length 1; false where it is none. */
static bool normalise(double *x, int32_t n) {
  double most = 0.0, sum = 0.0;
  for (int32_t i = 0; i < n; i++) most = fmax(most, fabs(x[i]));
  if (!(most > 0.0) || !isfinite(most)) return false;
  for (int32_t i = 0; i < n; i++) x[i] /= most, sum += x[i] * x[i];
  for (int32_t i = 0; i < n; i++) x[i] /= sqrt(sum);
  return true;
}

/* The row of a coordinate, or -1 where it is held: coordinates ascend. */
static int32_t find_row(const strut_tangent *tangent, int32_t coordinate) {
  int32_t low = 0, high = tangent->n;
  while (low < high) {
    int32_t middle = low + (high - low) / 2;
    if (tangent->coordinate[middle] < coordinate)
      low = middle + 1;
    else
      high = middle;
  }
  return low < tangent->n && tangent->coordinate[low] == coordinate ? low : -1;
}

/* Contacts that touch and may stick hold along the ground as they do across it. */
static void hold_sticking(const strut_model *model, const double *q, strut_tangent *tangent) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    const strut_contact_entry *e = &c->entry[i];
    const double *t = c->tangent;
    bool touches = strut_contact_gap(c, i, q) < 0.0;
    if (!touches || e->friction.law == STRUT_FRICTION_NONE || !(e->friction.mu_static > 0.0))
      continue;
    strut_sparse *k = tangent->stiffness;
    const int32_t row[2] = {find_row(tangent, (int32_t)c->at[i]),
                            find_row(tangent, (int32_t)c->at[i] + 1)};
    for (int a = 0; a < 2; a++) {
      if (row[a] < 0) continue;
      k->value[k->start[row[a]]] += e->stiffness * t[a] * t[a];
      for (int32_t p = k->start[row[a]] + 1; a == 0 && p < k->start[row[a] + 1]; p++)
        if (k->row[p] == row[1]) k->value[p] += e->stiffness * t[0] * t[1];
    }
  }
}

/* What is below it is no stiffness: rounding, and forces that are not quite in balance. */
static double least_of(const strut_model *model, double acceleration, const strut_sparse *k) {
  double stiffest = 0.0, heaviest = 0.0;
  for (int32_t i = 0; i < k->n; i++) stiffest = fmax(stiffest, fabs(k->value[k->start[i]]));
  for (int32_t i = 0; i < model->node_count; i++) heaviest = fmax(heaviest, model->weight[i]);
  return NOTHING * stiffest + 10.0 * acceleration * heaviest / model->size;
}

/* From the eigenvector x (n): which node moves most, where to, and how fast that grows. */
static void describe(const strut_model *model, const strut_tangent *tangent, const double *x,
                     strut_instability *found) {
  double *d = found->direction, most = -1.0;
  for (int32_t i = 0; i < tangent->n; i++) d[tangent->coordinate[i]] = x[i];
  for (int32_t i = 0; i < model->node_count; i++) {
    double moved = hypot(d[2 * i], d[2 * i + 1]);
    if (moved > most * (1.0 + 1e-9)) most = moved, found->node = i;
  }
  const double *at = d + 2 * found->node;
  double scale = (fabs(at[0]) >= 1e-6 * fabs(at[1]) ? at[0] : at[1]) < 0.0 ? -most : most;
  for (int32_t i = 0; i < 2 * model->node_count; i++) d[i] = d[i] / scale + 0.0;
  double inertia = 2.0 * strut_energy_kinetic(model, d) * most * most;
  found->growth_rate = inertia > 0.0 ? sqrt(-found->stiffness / inertia) : 0.0;
}

/* The lowest eigenvector, by inverse iteration with the matrix that was lifted. */
static void find_direction(shifted *s, const strut_model *model, const strut_tangent *tangent,
                           double least, double *x, double *product, strut_instability *found) {
  int32_t n = tangent->n;
  lift(s, least);
  for (int32_t i = 0; i < n; i++) x[i] = stirred((uint64_t)i);
  for (int turn = 0; turn < TURNS && !s->status; turn++) {
    if (!normalise(x, n)) return;
    strut_ldl_solve(s->ldl, x);
  }
  if (s->status || !normalise(x, n)) return;
  strut_sparse_multiply(s->matrix, x, product);
  found->stiffness = 0.0;
  for (int32_t i = 0; i < n; i++) found->stiffness += x[i] * product[i];
  if (found->stiffness < -0.5 * least) describe(model, tangent, x, found);
}

strut_status strut_find_instability(const strut_model *model, double acceleration, const double *q,
                                    strut_arena *arena, strut_instability *found,
                                    strut_error *error) {
  strut_arena scratch = {0};
  strut_tangent tangent;
  shifted s = {.status = STRUT_OK};
  *found = (strut_instability){.node = -1};
  strut_status status = strut_tangent_assemble(model, q, model->members.rest, STRUT_CLOSED_TOUCHING,
                                               &scratch, &tangent);
  double *x = NULL;
  if (!status) {
    x = strut_arena_allocate(&scratch, 2 * (size_t)tangent.n + 1, sizeof *x);
    found->direction = strut_arena_allocate(arena, (size_t)model->length, sizeof(double));
    if (!x || !found->direction) status = STRUT_NO_MEMORY;
  }
  if (!status && tangent.n > 0) {
    s.matrix = tangent.stiffness;
    hold_sticking(model, q, &tangent);
    double least = least_of(model, acceleration, s.matrix), shift = least;
    status = strut_ldl_create(s.matrix, &s.ldl, error);
    if (!status && least > 0.0 && isfinite(least) && count_negative(&s, &shift) > 0)
      find_direction(&s, model, &tangent, least, x, x + tangent.n, found);
    if (s.status == STRUT_NO_MEMORY) status = s.status;
  }
  if (found->node < 0) *found = (strut_instability){.node = -1};
  strut_ldl_free(s.ldl);
  strut_arena_free(&scratch);
  return status ? strut_fail(error, status, "out of memory") : STRUT_OK;
}
