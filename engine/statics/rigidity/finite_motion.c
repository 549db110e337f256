/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/rigidity/finite_motion.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "engine/base/vec.h"

enum { STEPS = 10, MOST_CORRECTIONS = 12 };

static const double STRIDE = 0.01;       /* of the size, by the node that moves most */
static const double KEPT = 1e-12;        /* strain that counts as none */
static const double PROGRESS = 0.5;      /* of a stride that corrections must leave */
static const double LEAST_CHANGE = 0.02; /* of the size: else it was a rigid motion */
/* Redundant members make A' A singular; this much on its diagonal leaves the rest alone. */
static const double DAMPING = 1e-11;

typedef struct walker {
  const strut_model *model;
  const double *start; /* positions at the beginning */
  double *q, *before, *motion, *length, *strain, *gram, *step;
  strut_equilibrium_matrix a;
  strut_arena matrix;
} walker;

static bool set_up(walker *w, const double *q, strut_arena *arena, int32_t rows) {
  size_t length = (size_t)w->model->length, members = (size_t)w->model->members.count;
  w->start = q;
  w->q = strut_arena_allocate(arena, length, sizeof(double));
  w->before = strut_arena_allocate(arena, length, sizeof(double));
  w->motion = strut_arena_allocate(arena, (size_t)rows + 1, sizeof(double));
  w->step = strut_arena_allocate(arena, (size_t)rows + 1, sizeof(double));
  w->length = strut_arena_allocate(arena, members + 1, sizeof(double));
  w->strain = strut_arena_allocate(arena, members + 1, sizeof(double));
  w->gram = strut_arena_allocate(arena, members * members + 1, sizeof(double));
  if (!w->q || !w->before || !w->motion || !w->step || !w->length || !w->strain || !w->gram)
    return false;
  memcpy(w->q, q, length * sizeof *q);
  return true;
}

static bool look_around(walker *w) {
  strut_arena_free(&w->matrix);
  return strut_equilibrium_matrix_build(w->model, w->q, &w->matrix, &w->a) == STRUT_OK;
}

/* x (members) = (A' A + damping)^-1 x, by Cholesky; false where rounding spoils it. */
static bool solve_gram(walker *w, double *x) {
  const strut_equilibrium_matrix *a = &w->a;
  size_t n = (size_t)a->columns;
  if (n == 0) return true;
  for (int32_t j = 0; j < a->columns; j++) {
    memset(w->step, 0, (size_t)a->rows * sizeof *w->step);
    for (int32_t k = a->start[j]; k < a->start[j + 1]; k++) w->step[a->row[k]] = a->value[k];
    strut_equilibrium_elongate(a, w->step, w->gram + (size_t)j * n);
    w->gram[(size_t)j * n + (size_t)j] += DAMPING;
  }
  gsl_matrix_view gram = gsl_matrix_view_array(w->gram, n, n);
  gsl_vector_view view = gsl_vector_view_array(x, n);
  if (gsl_linalg_cholesky_decomp1(&gram.matrix) != 0) return false;
  return gsl_linalg_cholesky_svx(&gram.matrix, &view.vector) == 0;
}

static double largest_strain(const walker *w) {
  double largest = 0.0;
  for (int32_t j = 0; j < w->a.columns; j++)
    if (w->length[j] > 0)
      largest = fmax(largest, fabs(w->a.length[j] - w->length[j]) / w->length[j]);
    else
      largest = fmax(largest, w->a.length[j] / w->model->size);
  return largest;
}

/* Back to the lengths by the least displacement that does it. */
static bool correct(walker *w, double *strain) {
  for (int i = 0; i < MOST_CORRECTIONS; i++) {
    if (!look_around(w)) return false;
    *strain = largest_strain(w);
    if (*strain <= KEPT) return true;
    for (int32_t j = 0; j < w->a.columns; j++) w->strain[j] = w->length[j] - w->a.length[j];
    if (!solve_gram(w, w->strain)) return false;
    strut_equilibrium_multiply(&w->a, w->strain, w->step);
    for (int32_t r = 0; r < w->a.rows; r++) w->q[w->a.coordinate[r]] += w->step[r];
  }
  return false;
}

/* The motion at hand without what stretches members here; largest entry 1. */
static bool straighten(walker *w) {
  strut_equilibrium_elongate(&w->a, w->motion, w->strain);
  if (!solve_gram(w, w->strain)) return false;
  strut_equilibrium_multiply(&w->a, w->strain, w->step);
  double largest = 0.0;
  for (int32_t r = 0; r < w->a.rows; r++) {
    w->motion[r] -= w->step[r];
    largest = fmax(largest, fabs(w->motion[r]));
  }
  for (int32_t r = 0; r < w->a.rows; r++) w->motion[r] /= largest;
  return largest > 0.1;
}

static bool stride(walker *w, double stride_length, double *strain) {
  double gone = 0.0;
  memcpy(w->before, w->q, (size_t)w->model->length * sizeof *w->q);
  for (int32_t r = 0; r < w->a.rows; r++) w->q[w->a.coordinate[r]] += stride_length * w->motion[r];
  if (!correct(w, strain)) return false;
  for (int32_t r = 0; r < w->a.rows; r++) {
    int32_t at = w->a.coordinate[r];
    w->motion[r] = w->q[at] - w->before[at];
    gone = fmax(gone, fabs(w->motion[r]));
  }
  for (int32_t r = 0; r < w->a.rows; r++) w->motion[r] /= gone > 0 ? gone : 1.0;
  return gone >= PROGRESS * stride_length;
}

/* Largest change of the distance between two nodes: zero for rigid motions. */
static double change_of_shape(const walker *w) {
  double largest = 0.0;
  for (int32_t i = 0; i < w->model->node_count; i++)
    for (int32_t k = 0; k < i; k++) {
      const double *p = w->q, *s = w->start;
      double now = strut_distance(p + 2 * k, p + 2 * i);
      double then = strut_distance(s + 2 * k, s + 2 * i);
      largest = fmax(largest, fabs(now - then));
    }
  return largest;
}

strut_status strut_finite_motion_walk(const strut_model *model, const double *q,
                                      const double *motion, strut_walk *walk) {
  *walk = (strut_walk){.moved = (double)NAN, .strain = (double)NAN};
  if (model->members.count > STRUT_WALK_MEMBERS) return STRUT_OK;
  strut_arena scratch = {0};
  walker w = {.model = model};
  strut_status status = STRUT_NO_MEMORY;
  strut_equilibrium_matrix first;
  if (strut_equilibrium_matrix_build(model, q, &scratch, &first) == STRUT_OK &&
      set_up(&w, q, &scratch, first.rows) && look_around(&w)) {
    status = STRUT_OK;
    memcpy(w.length, first.length, (size_t)first.columns * sizeof *w.length);
    memcpy(w.motion, motion, (size_t)first.rows * sizeof *motion);
    bool good = true;
    double worst = 0.0;
    for (int i = 0; i < STEPS && good; i++) {
      double strain = 0.0;
      good = straighten(&w) && stride(&w, STRIDE * model->size, &strain);
      worst = fmax(worst, strain);
    }
    walk->moved = change_of_shape(&w);
    walk->strain = worst;
    walk->arrived = good && walk->moved >= LEAST_CHANGE * model->size;
  }
  strut_arena_free(&w.matrix);
  strut_arena_free(&scratch);
  return status;
}
