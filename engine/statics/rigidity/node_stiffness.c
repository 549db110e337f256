/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/node_stiffness.h"

#include <math.h>

#include "engine/base/memory.h"
#include "engine/model/pose.h"
#include "engine/statics/potential.h"
#include "engine/statics/rigid_motions.h"
#include "engine/statics/rigidity/linear_matrices.h"

static const double NOTHING = 1e-9, PIVOT = 1e-12;

typedef strut_node_stiffness stiff;
struct strut_node_stiffness {
  size_t n;
  double *k;     /* (n, n) K, then its Cholesky factor in the lower triangle */
  double *rigid; /* (rigid_count, n) orthonormal */
  int32_t rigid_count;
  double *load; /* (n) */
  strut_potential *potential;
  strut_arena arena;
};

static void add_sparse(stiff *s, const strut_sparse *a) {
  for (int32_t j = 0; a && j < a->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      size_t r = (size_t)a->row[at], c = (size_t)j;
      s->k[r * s->n + c] += a->value[at];
      if (r != c) s->k[c * s->n + r] += a->value[at];
    }
}

/* Adds to K a contact stiffness along the ground, equal to that normal to it. */
static void hold_contacts(stiff *s, const strut_model *model, const double *q,
                          const int32_t *row_of) {
  const strut_contact_table *c = &model->contacts;
  for (int32_t i = 0; i < c->count; i++) {
    uint32_t at = c->at[i];
    const strut_contact_pose pose = strut_contact_pose_at(c, i, q, NULL, -1);
    const double *t = pose.axes.tangent;
    if (!(pose.gap < 0)) continue;
    for (uint32_t a = 0; a < 2; a++)
      for (uint32_t b = 0; b < 2; b++)
        if (row_of[at + a] >= 0 && row_of[at + b] >= 0)
          s->k[(size_t)row_of[at + a] * s->n + (size_t)row_of[at + b]] +=
              c->entry[i].stiffness * t[a] * t[b];
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

/* Finds the rigid motions without stiffness in K, as combinations, and adds stiffness against them. */
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

double strut_node_stiffness_along(stiff *s, int32_t node, const double direction[2]) {
  double compliance = 0.0;
  const int32_t *row_of = &s->potential->row_of[2 * node];
  for (size_t i = 0; i < s->n; i++) s->load[i] = 0.0;
  for (int d = 0; d < 2; d++)
    if (row_of[d] >= 0) s->load[row_of[d]] = direction[d];
  for (int32_t m = 0; m < s->rigid_count; m++) {
    const double *x = s->rigid + (size_t)m * s->n;
    double along = 0.0;
    for (int d = 0; d < 2; d++)
      if (row_of[d] >= 0) along += direction[d] * x[row_of[d]];
    for (size_t i = 0; i < s->n; i++) s->load[i] -= along * x[i];
  }
  for (size_t i = 0; i < s->n; i++) { /* |L^-1 d|^2 = d' K^-1 d */
    const double *row = s->k + i * s->n;
    double sum = s->load[i];
    for (size_t m = 0; m < i; m++) sum -= row[m] * s->load[m];
    s->load[i] = sum / row[i];
    compliance += s->load[i] * s->load[i];
  }
  return compliance > 0.0 ? 1.0 / compliance : (double)NAN;
}

/* K at q, with its rigid motions lifted, factored; or why not. */
static strut_status fill(stiff *s, const strut_model *model, const double *q, const char **reason) {
  strut_linear_matrices matrices;
  s->k = strut_arena_allocate(&s->arena, s->n * s->n, sizeof *s->k);
  s->rigid = strut_arena_allocate(&s->arena, 3 * s->n, sizeof *s->rigid);
  s->load = strut_arena_allocate(&s->arena, s->n, sizeof *s->load);
  strut_status status = s->k && s->rigid && s->load
                            ? strut_linear_matrices_build(model, q, &s->arena, &matrices)
                            : STRUT_NO_MEMORY;
  if (status) return status;
  add_sparse(s, matrices.elastic);
  add_sparse(s, matrices.geometric);
  add_sparse(s, matrices.contact);
  hold_contacts(s, model, q, s->potential->row_of);
  s->rigid_count = strut_rigid_motions(s->potential, q, s->rigid);
  lift_rigid(s);
  if (!factorise(s)) *reason = "a motion has no stiffness";
  return STRUT_OK;
}

strut_status strut_node_stiffness_create(const strut_model *model, const double *q, stiff **to,
                                         const char **reason, strut_error *error) {
  stiff *s = strut_allocate(1, sizeof *s);
  *to = NULL;
  *reason = NULL;
  if (!s) return strut_no_memory(error, "");
  strut_status status = strut_potential_create(model, NULL, true, &s->potential, error);
  if (!status) s->n = (size_t)s->potential->n;
  if (!status && s->n == 0) *reason = "nothing can move";
  if (!status && s->n > STRUT_STIFFNESS_COORDINATES) *reason = "more than 1000 free coordinates";
  if (!status && !*reason) status = fill(s, model, q, reason);
  if (status == STRUT_NO_MEMORY) strut_no_memory(error, "");
  if (status || *reason)
    strut_node_stiffness_free(s);
  else
    *to = s;
  return status;
}

void strut_node_stiffness_free(stiff *s) {
  if (!s) return;
  strut_potential_free(s->potential);
  strut_arena_free(&s->arena);
  strut_release(s);
}
