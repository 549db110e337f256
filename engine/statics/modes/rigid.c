/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The motions of the plane as a whole that supports and closed contacts leave free. */
#include <gsl/gsl_eigen.h>
#include <math.h>

#include "engine/statics/modes/parts.h"

/* A motion (a, b, w): a - w (y - y0) / size in x, b + w (x - x0) / size in y. */
typedef struct pivot {
  double x, y, size;
} pivot;

static pivot middle_of(const strut_vibration *v) {
  pivot c = {0.0, 0.0, v->model->size > 0 ? v->model->size : 1.0};
  for (int32_t i = 0; i < v->model->node_count; i++)
    c.x += v->q[2 * i].hi, c.y += v->q[2 * i + 1].hi;
  c.x /= v->model->node_count;
  c.y /= v->model->node_count;
  return c;
}

/* Adds what holding direction (nx, ny) at coordinates `at` forbids: g += row row'. */
static void forbid(const strut_vibration *v, const pivot *c, int32_t at, double nx, double ny,
                   gsl_matrix *g) {
  double x = (v->q[at].hi - c->x) / c->size, y = (v->q[at + 1].hi - c->y) / c->size;
  double row[3] = {nx, ny, ny * x - nx * y};
  for (size_t i = 0; i < 3; i++)
    for (size_t k = 0; k < 3; k++)
      gsl_matrix_set(g, i, k, gsl_matrix_get(g, i, k) + row[i] * row[k]);
}

static void forbid_all(const strut_vibration *v, const pivot *c, gsl_matrix *g) {
  const strut_model *model = v->model;
  const strut_contact_table *contacts = &model->contacts;
  for (int32_t at = 0; at < 2 * model->node_count; at++)
    if (v->shape->row_of[at] < 0) forbid(v, c, at & ~1, at % 2 == 0, at % 2 != 0, g);
  for (int32_t i = 0; i < contacts->count; i++)
    if (v->closed[i])
      forbid(v, c, (int32_t)contacts->at[i], contacts->normal[0], contacts->normal[1], g);
}

static void fill(const strut_vibration *v, const pivot *c, const double motion[3], double *x) {
  for (int32_t i = 0; i < v->n; i++) {
    int32_t at = v->shape->coordinate[i], node = at / 2;
    if (at % 2)
      x[i] = motion[1] + motion[2] * (v->q[2 * node].hi - c->x) / c->size;
    else
      x[i] = motion[0] - motion[2] * (v->q[2 * node + 1].hi - c->y) / c->size;
  }
}

/* Gram and Schmidt, twice, in the product of the mass; false: nothing is left of x. */
static bool orthonormalise(const strut_modes_work *work, double *x, double *product) {
  const strut_vibration *v = work->v;
  double square = 0.0;
  for (int pass = 0; pass < 2; pass++)
    for (int32_t k = 0; k <= work->rigid_count; k++) {
      const double *y = k < work->rigid_count ? work->rigid + (size_t)k * (size_t)v->n : x;
      double share = 0.0;
      strut_vibration_multiply(v, v->m, x, product);
      for (int32_t i = 0; i < v->n; i++) share += y[i] * product[i];
      square = share;
      for (int32_t i = 0; i < v->n && k < work->rigid_count; i++) x[i] -= share * y[i];
    }
  if (!(square > 0)) return false;
  for (int32_t i = 0; i < v->n; i++) x[i] /= sqrt(square);
  return true;
}

strut_status strut_modes_rigid(strut_modes_work *work, strut_error *error) {
  const strut_vibration *v = work->v;
  pivot c = middle_of(v);
  work->rigid_count = 0;
  work->rigid = strut_arena_allocate(work->arena, 3 * (size_t)v->n, sizeof *work->rigid);
  gsl_matrix *g = gsl_matrix_calloc(3, 3), *vector = gsl_matrix_alloc(3, 3);
  gsl_vector *value = gsl_vector_alloc(3);
  gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(3);
  bool good = work->rigid && g && vector && value && w;
  if (good) {
    forbid_all(v, &c, g);
    double trace = gsl_matrix_get(g, 0, 0) + gsl_matrix_get(g, 1, 1) + gsl_matrix_get(g, 2, 2);
    good = gsl_eigen_symmv(g, value, vector, w) == 0 &&
           gsl_eigen_symmv_sort(value, vector, GSL_EIGEN_SORT_VAL_ASC) == 0;
    for (size_t i = 0; i < 3 && good; i++) {
      if (gsl_vector_get(value, i) > 1e-12 * trace) break;
      double motion[3], *x = work->rigid + (size_t)work->rigid_count * (size_t)v->n;
      for (size_t k = 0; k < 3; k++) motion[k] = gsl_matrix_get(vector, k, i);
      fill(v, &c, motion, x);
      if (orthonormalise(work, x, (double *)v->work)) work->rigid_count++;
    }
  }
  gsl_matrix_free(g);
  gsl_matrix_free(vector);
  gsl_vector_free(value);
  gsl_eigen_symmv_free(w);
  return good ? STRUT_OK : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
}
