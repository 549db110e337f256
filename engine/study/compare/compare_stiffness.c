/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How far a unit load on a node moves it: 1 / (e' K^-1 e), K being the tangent stiffness at rest.
 * Nodes that touch the ground are held along it as firmly as into it. Where rigid motions are left,
 * loads and displacements are told without their part in these.
 */
#include <math.h>

#include "engine/model/pose.h"
#include "engine/statics/rigid_motions.h"
#include "engine/statics/rigidity/linear_matrices.h"
#include "engine/study/compare/compare_parts.h"

enum { MOST = 1000 }; /* free coordinates: K is dense here */
static const double NOTHING = 1e-9, PIVOT = 1e-12;

typedef struct stiff {
  size_t n;
  double *k;     /* (n, n) K, then its Cholesky factor in the lower triangle */
  double *rigid; /* (rigid_count, n) orthonormal */
  int32_t rigid_count;
  double *load; /* (n) */
} stiff;

static void add_sparse(stiff *s, const strut_sparse *a) {
  for (int32_t j = 0; a && j < a->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      size_t r = (size_t)a->row[at], c = (size_t)j;
      s->k[r * s->n + c] += a->value[at];
      if (r != c) s->k[c * s->n + r] += a->value[at];
    }
}

/* What linear_matrices adds into the ground, along it too. */
static void hold_contacts(stiff *s, const strut_model *model, const double *q,
                          const int32_t *row_of) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    uint32_t at = c->at[i];
    if (!(strut_contact_gap(c, i, q) < 0)) continue;
    for (uint32_t a = 0; a < 2; a++)
      for (uint32_t b = 0; b < 2; b++)
        if (row_of[at + a] >= 0 && row_of[at + b] >= 0)
          s->k[(size_t)row_of[at + a] * s->n + (size_t)row_of[at + b]] +=
              c->entry[i].stiffness * c->tangent[a] * c->tangent[b];
  }
}

static double largest_diagonal(const stiff *s) {
  double largest = 0.0;
  for (size_t i = 0; i < s->n; i++) largest = fmax(largest, fabs(s->k[i * s->n + i]));
  return largest;
}

/* x' K y */
static double form(const stiff *s, const double *x, const double *y) {
  double sum = 0.0;
  for (size_t i = 0; i < s->n; i++)
    for (size_t j = 0; j < s->n; j++) sum += x[i] * s->k[i * s->n + j] * y[j];
  return sum;
}

/* Of the rigid motions those that K does not resist, as combinations; and makes K resist them. */
static void lift_rigid(stiff *s) {
  double a[3][3] = {{0}}, value[3], vector[3][3], largest = largest_diagonal(s);
  int32_t count = s->rigid_count, kept = 0;
  for (int32_t i = 0; i < 3; i++)
    for (int32_t j = 0; j < 3; j++) {
      bool both = i < count && j < count;
      a[i][j] = both ? form(s, s->rigid + (size_t)i * s->n, s->rigid + (size_t)j * s->n)
                     : (i == j) * 2.0 * largest * (double)s->n; /* unused: sorted to the end */
    }
  strut_symmetric_3(a, value, vector);
  while (kept < count && fabs(value[kept]) <= NOTHING * largest) kept++;
  for (size_t i = 0; i < s->n; i++) {
    double r[3] = {0, 0, 0}, combined[3];
    for (int32_t m = 0; m < count; m++) r[m] = s->rigid[(size_t)m * s->n + i];
    for (int32_t m = 0; m < kept; m++)
      combined[m] = vector[m][0] * r[0] + vector[m][1] * r[1] + vector[m][2] * r[2];
    for (int32_t m = 0; m < kept; m++) s->rigid[(size_t)m * s->n + i] = combined[m];
  }
  s->rigid_count = kept;
  for (int32_t m = 0; m < kept; m++) {
    const double *x = s->rigid + (size_t)m * s->n;
    for (size_t i = 0; i < s->n; i++)
      for (size_t j = 0; j < s->n; j++) s->k[i * s->n + j] += largest * x[i] * x[j];
  }
}

/* False where K is not positive definite. */
static bool factorise(stiff *s) {
  for (size_t j = 0; j < s->n; j++) {
    double *row = s->k + j * s->n, before = row[j];
    for (size_t i = 0; i <= j; i++) {
      double *other = s->k + i * s->n, sum = row[i];
      for (size_t m = 0; m < i; m++) sum -= row[m] * other[m];
      if (i < j)
        row[i] = sum / other[i];
      else if (!(sum > PIVOT * before))
        return false;
      else
        row[j] = sqrt(sum);
    }
  }
  return true;
}

/* Stiffness of coordinate `at` under a unit load there. */
static double stiffness_of(stiff *s, size_t at) {
  double compliance = 0.0;
  for (size_t i = 0; i < s->n; i++) s->load[i] = i == at ? 1.0 : 0.0;
  for (int32_t m = 0; m < s->rigid_count; m++) {
    const double *x = s->rigid + (size_t)m * s->n;
    for (size_t i = 0; i < s->n; i++) s->load[i] -= x[at] * x[i];
  }
  for (size_t i = 0; i < s->n; i++) { /* |L^-1 e|^2 = e' K^-1 e */
    const double *row = s->k + i * s->n;
    double sum = s->load[i];
    for (size_t m = 0; m < i; m++) sum -= row[m] * s->load[m];
    s->load[i] = sum / row[i];
    compliance += s->load[i] * s->load[i];
  }
  return compliance > 0.0 ? 1.0 / compliance : (double)NAN;
}

static void put_softest(strut_compare_work *work, const strut_model *model) {
  strut_compare_column *c = work->column;
  for (int d = 0; d < 2; d++) {
    const strut_compare_quantity at = d ? STRUT_COMPARE_STIFFNESS_Y : STRUT_COMPARE_STIFFNESS_X;
    for (int32_t i = 0; i < model->node_count; i++) {
      bool softer = c->softest[d] < 0 || c->stiffness[i][d] < c->stiffness[c->softest[d]][d];
      if (isfinite(c->stiffness[i][d]) && softer) c->softest[d] = i;
    }
    if (c->softest[d] >= 0)
      strut_compare_put(work, at, c->stiffness[c->softest[d]][d]);
    else
      strut_compare_leave(work, at, at, "no node can move that way");
  }
}

static strut_status measure(strut_compare_work *work, const strut_model *model,
                            const strut_potential *potential, stiff *s) {
  strut_compare_column *c = work->column;
  size_t nodes = (size_t)model->node_count;
  c->stiffness = strut_arena_allocate(work->arena, nodes, sizeof *c->stiffness);
  if (!c->stiffness) return STRUT_NO_MEMORY;
  s->rigid_count = strut_rigid_motions(potential, work->stand.q, s->rigid);
  lift_rigid(s);
  if (!factorise(s)) {
    c->stiffness = NULL;
    strut_compare_leave(work, STRUT_COMPARE_STIFFNESS_X, STRUT_COMPARE_STIFFNESS_Y,
                        "some motion meets no stiffness");
    return STRUT_OK;
  }
  for (size_t i = 0; i < nodes; i++)
    for (size_t d = 0; d < 2; d++) {
      int32_t row = potential->row_of[2 * i + d];
      c->stiffness[i][d] = row < 0 ? (double)NAN : stiffness_of(s, (size_t)row);
    }
  put_softest(work, model);
  return STRUT_OK;
}

strut_status strut_compare_stiffness(strut_compare_work *work, const strut_model *model) {
  strut_arena scratch = {0};
  strut_potential *potential = NULL;
  strut_linear_matrices matrices;
  strut_error error = {0};
  strut_status status = strut_potential_create(model, NULL, true, &potential, &error);
  stiff s = {.n = status == STRUT_OK ? (size_t)potential->n : 0};
  if (status == STRUT_OK && (s.n == 0 || s.n > MOST)) {
    strut_compare_leave(work, STRUT_COMPARE_STIFFNESS_X, STRUT_COMPARE_STIFFNESS_Y,
                        s.n ? "more than 1000 free coordinates" : "nothing can move");
  } else if (status == STRUT_OK) {
    s.k = strut_arena_allocate(&scratch, s.n * s.n, sizeof *s.k);
    s.rigid = strut_arena_allocate(&scratch, 3 * s.n, sizeof *s.rigid);
    s.load = strut_arena_allocate(&scratch, s.n, sizeof *s.load);
    status = s.k && s.rigid && s.load
                 ? strut_linear_matrices_build(model, work->stand.q, &scratch, &matrices)
                 : STRUT_NO_MEMORY;
    if (status == STRUT_OK) {
      add_sparse(&s, matrices.elastic);
      add_sparse(&s, matrices.geometric);
      add_sparse(&s, matrices.contact);
      hold_contacts(&s, model, work->stand.q, potential->row_of);
      status = measure(work, model, potential, &s);
    }
  }
  strut_potential_free(potential);
  strut_arena_free(&scratch);
  return status;
}
