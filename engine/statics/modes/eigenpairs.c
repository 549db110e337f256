/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>

#include "engine/base/vec.h"
#include "engine/statics/algebra.h"
#include "engine/statics/modes/parts.h"

/*
 * All modes of a small structure, by GSL's dense eigensolver. Coordinates without mass are condensed:
 * they follow those with mass, x0 = -K00^-1 K01 x1.
 */
typedef struct dense {
  strut_modes_work *work;
  size_t n, massive;
  size_t *place;      /* (n) those with mass first */
  gsl_matrix *k, *m;  /* (n, n), in that order */
  gsl_matrix *follow; /* (n - massive, massive) K00^-1 K01 */
  gsl_matrix *vector; /* (massive, massive) */
  gsl_vector *value;  /* (massive) */
  strut_arena arena;
} dense;

static void fill_matrices(const dense *self) {
  const strut_vibration *vibration = self->work->v;
  const strut_sparse *matrix = vibration->shape->pattern;
  for (int32_t j = 0; j < vibration->n; j++)
    for (int32_t at = matrix->start[j]; at < matrix->start[j + 1]; at++) {
      size_t r = self->place[matrix->row[at]], c = self->place[j];
      gsl_matrix_set(self->k, r, c, vibration->k[at]);
      gsl_matrix_set(self->k, c, r, vibration->k[at]);
      gsl_matrix_set(self->m, r, c, vibration->m[at]);
      gsl_matrix_set(self->m, c, r, vibration->m[at]);
    }
}

/* K11 loses K10 K00^-1 K01. */
static bool condense(dense *self) {
  size_t light = self->n - self->massive;
  if (light == 0) return true;
  self->follow = strut_arena_matrix(&self->arena, light, self->massive);
  gsl_permutation *order = strut_arena_order(&self->arena, light);
  int sign = 0;
  bool good = self->follow && order;
  if (good) {
    gsl_matrix_view k00 = gsl_matrix_submatrix(self->k, self->massive, self->massive, light, light);
    gsl_matrix_view k01 = gsl_matrix_submatrix(self->k, self->massive, 0, light, self->massive);
    gsl_matrix_view k11 = gsl_matrix_submatrix(self->k, 0, 0, self->massive, self->massive);
    gsl_matrix_memcpy(self->follow, &k01.matrix);
    good = gsl_linalg_LU_decomp(&k00.matrix, order, &sign) == 0;
    for (size_t c = 0; c < self->massive && good; c++) {
      gsl_vector_view column = gsl_matrix_column(self->follow, c);
      good = gsl_linalg_LU_svx(&k00.matrix, order, &column.vector) == 0;
    }
    if (good)
      gsl_blas_dgemm(CblasTrans, CblasNoTrans, -1.0, &k01.matrix, self->follow, 1.0, &k11.matrix);
  }
  return good;
}

/* Vectors of unit length to such of x'Mx = 1, into the set. */
static void store_eigenpairs(const dense *self) {
  strut_eigen_set *set = &self->work->set;
  double *product = self->work->v->work;
  for (size_t i = 0; i < self->massive; i++) {
    double *x = set->vector + i * self->n, square = 0.0;
    set->value[i] = gsl_vector_get(self->value, i);
    for (size_t r = 0; r < self->n; r++) {
      size_t row = self->place[r];
      x[r] = row < self->massive ? gsl_matrix_get(self->vector, row, i) : 0.0;
      for (size_t c = 0; c < self->massive && row >= self->massive; c++)
        x[r] -= gsl_matrix_get(self->follow, row - self->massive, c) *
                gsl_matrix_get(self->vector, c, i);
    }
    strut_vibration_multiply(self->work->v, self->work->v->m, x, product);
    for (size_t r = 0; r < self->n; r++) square += x[r] * product[r];
    for (size_t r = 0; r < self->n; r++) x[r] /= sqrt(square);
  }
}

static bool allocate_set(strut_modes_work *work) {
  strut_eigen_set *set = &work->set;
  size_t count = (size_t)set->count;
  return STRUT_NUMBERS(work->arena, count, &set->value, &set->noise, &set->error, &set->residual) &&
         STRUT_NUMBERS(work->arena, count * (size_t)set->n, &set->vector);
}

static bool allocate_dense(dense *self) {
  strut_eigen_set *set = &self->work->set;
  const strut_vibration *vibration = self->work->v;
  self->n = (size_t)vibration->n, self->massive = (size_t)vibration->massive;
  self->place = strut_arena_allocate(self->work->arena, self->n, sizeof *self->place);
  set->n = vibration->n, set->count = vibration->massive;
  self->k = strut_arena_matrix(&self->arena, self->n, self->n);
  self->m = strut_arena_matrix(&self->arena, self->n, self->n);
  self->vector = strut_arena_matrix(&self->arena, self->massive, self->massive);
  self->value = strut_arena_vector(&self->arena, self->massive);
  if (!self->place || !self->k || !self->m || !self->vector || !self->value ||
      !allocate_set(self->work))
    return false;
  for (size_t i = 0, heavy = 0, light = self->massive; i < self->n; i++)
    self->place[i] = vibration->mass[i] > 0 ? heavy++ : light++;
  return true;
}

static bool solve_dense(dense *self) {
  fill_matrices(self);
  if (!condense(self)) return false;
  gsl_eigen_gensymmv_workspace *workspace = gsl_eigen_gensymmv_alloc(self->massive);
  if (!workspace) return false;
  gsl_matrix_view k = gsl_matrix_submatrix(self->k, 0, 0, self->massive, self->massive);
  gsl_matrix_view m = gsl_matrix_submatrix(self->m, 0, 0, self->massive, self->massive);
  bool good = gsl_eigen_gensymmv(&k.matrix, &m.matrix, self->value, self->vector, workspace) == 0 &&
              gsl_eigen_gensymmv_sort(self->value, self->vector, GSL_EIGEN_SORT_VAL_ASC) == 0;
  if (good) store_eigenpairs(self);
  gsl_eigen_gensymmv_free(workspace);
  return good;
}

strut_status strut_modes_dense(strut_modes_work *work, strut_error *error) {
  dense d = {.work = work};
  bool good = allocate_dense(&d) && solve_dense(&d);
  strut_arena_free(&d.arena);
  return good ? STRUT_OK : strut_no_memory(error, "for all modes");
}

/* The lowest modes of a large structure: bracketed by counting, found by Lanczos's method. */

enum { MOST_FACTORS = 80, MOST_ALIKE = 100 }; /* eigenvalues at one place */
static const double LEAST = 1e-13; /* of the largest eigenvalue: less drowns in rounding */

/* Eigenvalues below z, by the signs of the factor of K - z M. */
static int32_t count_below(strut_modes_work *work, double z) {
  strut_modes_factorise(&work->solver, -z);
  return work->solver.inertia.negative;
}

/* Some z > 0 with at least `count` and a few more eigenvalues below; *below gets how many. */
static double find_bound(strut_modes_work *work, int32_t count, int32_t *below) {
  double low = 0.0, high = 0.0, z = 1e-7 * work->v->largest;
  int32_t least = count + 2, most = 2 * count + 10;
  for (int i = 0; i < MOST_FACTORS; i++) {
    int32_t found = count_below(work, z);
    if (found < least)
      low = z;
    else
      high = z, *below = found;
    if (found >= least && (found <= most || z <= LEAST * work->v->largest)) break;
    if (low > 0 && high > 0 && high < 1.0001 * low) break; /* many at one place */
    z = low > 0 && high > 0 ? sqrt(low * high) : low > 0 ? 30.0 * low : 0.01 * high;
    z = fmax(z, LEAST * work->v->largest);
  }
  return high;
}

static void apply_inverse(void *context, double *vector) {
  strut_modes_work *work = context;
  strut_modes_solve(&work->solver, vector);
}

static void apply_mass(void *context, const double *vector, double *y) {
  strut_modes_work *work = context;
  strut_vibration_multiply(work->v, work->v->m, vector, y);
}

strut_status strut_modes_sparse(strut_modes_work *work, int32_t count, strut_error *error) {
  strut_vibration *vibration = work->v;
  int32_t below = 0;
  if (count > vibration->massive - 3) count = vibration->massive - 3; /* Lanczos's */
  double bound = find_bound(work, count, &below),
         shift = -fmax(1e-3 * bound, LEAST * vibration->largest);
  if (below > 2 * count + MOST_ALIKE && bound <= LEAST * vibration->largest)
    return strut_fail(
        error, STRUT_SINGULAR,
        "%d modes have no stiffness, or less than rounding leaves, too many to tell apart "
        "in a structure of this size; cables that are only just taut have none: give "
        "them a prestress",
        (int)below);
  if (below >= vibration->massive) below = vibration->massive - 1;
  strut_eigen_set *set = &work->set;
  set->n = vibration->n, set->count = below;
  if (!allocate_set(work)) return strut_no_memory(error, "");
  for (int i = 0; i < MOST_FACTORS && count_below(work, shift) > 0; i++) shift *= 4.0;
  strut_lanczos_problem problem = {vibration->n,  shift,      work,
                                   apply_inverse, apply_mass, work->experiment->interrupt};
  const strut_sparse_algebra_library *sparse = NULL;
  strut_status status = strut_sparse_algebra_load(&sparse, error);
  if (status == STRUT_OK)
    status = sparse->lowest_eigenpairs(&problem, below, set->value, set->vector, error);
  /* All that the signs have counted must be there. */
  if (status == STRUT_OK && !(set->value[below - 1] < 1.001 * bound))
    status = strut_fail(error, STRUT_SINGULAR,
                        "Lanczos's method missed some of the %d modes below %.4g Hz", (int)below,
                        sqrt(bound) / STRUT_TAU);
  return status;
}

/* Damping of modes: (z^2 M + z D + K) x = 0, each solution given to the mode that it is most of. */

enum { NONE = -1, NOT_WANTED = -2 };

/*
 * In the undamped modes' coordinates M is 1 and K diagonal. With a = sqrt|eigenvalue| of each, the
 * pairs (a y, y') obey a first-order system of [0 a; -+a -D], in which all entries have the size of
 * frequencies, whatever the units.
 */
/* A solution that has less of a mode is not its own: roots of zero that rounding has split. */
static const double LEAST_SHARE = 1e-6;

typedef struct quadratic {
  size_t n;
  gsl_matrix *system, *damping;
  gsl_vector_complex *value;
  gsl_matrix_complex *vector;
  gsl_eigen_nonsymmv_workspace *w;
  double *weight;          /* (2 n, n) how much of mode j is in solution i */
  uint8_t *taken;          /* (2 n) solutions */
  int32_t *first, *second; /* (n) of each mode: solutions, NONE or NOT_WANTED */
} quadratic;

/* x_i' D x_j of all modes. */
static bool fill_damping(const strut_modes_work *work, gsl_matrix *damping) {
  const strut_eigen_set *set = &work->set;
  size_t n = (size_t)set->n, count = (size_t)set->count;
  double *product = work->v->work;
  bool any = false;
  for (size_t j = 0; j < count; j++) {
    strut_vibration_multiply(work->v, work->v->d, set->vector + j * n, product);
    for (size_t i = 0; i < count; i++) {
      double sum = strut_dot(set->vector + i * n, product, (ptrdiff_t)n);
      if (i == j) sum += work->v->model->mass_damping; /* vectors have x' M x = 1 */
      gsl_matrix_set(damping, i, j, sum);
      any = any || sum != 0;
    }
  }
  return any;
}

static void fill_system(const strut_modes_work *work, quadratic *self) {
  for (size_t i = 0; i < self->n; i++) {
    double z = work->set.value[i], a = sqrt(fabs(z));
    gsl_matrix_set(self->system, i, self->n + i, a);
    gsl_matrix_set(self->system, self->n + i, i, z > 0 ? -a : a);
    for (size_t j = 0; j < self->n; j++)
      gsl_matrix_set(self->system, self->n + i, self->n + j, -gsl_matrix_get(self->damping, i, j));
  }
}

static void compute_weights(quadratic *self) {
  for (size_t i = 0; i < 2 * self->n; i++)
    for (size_t j = 0; j < self->n; j++) {
      gsl_complex a = gsl_matrix_complex_get(self->vector, j, i);
      gsl_complex b = gsl_matrix_complex_get(self->vector, self->n + j, i);
      self->weight[i * self->n + j] = GSL_REAL(a) * GSL_REAL(a) + GSL_IMAG(a) * GSL_IMAG(a) +
                                      GSL_REAL(b) * GSL_REAL(b) + GSL_IMAG(b) * GSL_IMAG(b);
    }
}

/* Repeatedly assigns the best free solution to a mode that lacks one in `slot`. */
static void assign_solutions(quadratic *self, bool oscillating, int32_t *slot) {
  for (;;) {
    double most = LEAST_SHARE;
    size_t solution = 0, mode = 0;
    for (size_t i = 0; i < 2 * self->n; i++) {
      double im = GSL_IMAG(gsl_vector_complex_get(self->value, i));
      if (self->taken[i] || (oscillating ? !(im > 0) : im != 0)) continue;
      for (size_t j = 0; j < self->n; j++)
        if (slot[j] == NONE && self->weight[i * self->n + j] > most)
          most = self->weight[i * self->n + j], solution = i, mode = j;
    }
    if (!(most > LEAST_SHARE)) return;
    self->taken[solution] = 1;
    slot[mode] = (int32_t)solution;
  }
}

/* Modes that swing by themselves get a conjugate pair, or two real solutions. */
static void assign_all_solutions(quadratic *self, const strut_mode *list) {
  for (size_t j = 0; j < self->n; j++)
    self->first[j] = self->second[j] = list[j].kind == STRUT_MODE_ELASTIC ? NONE : NOT_WANTED;
  assign_solutions(self, true, self->first);
  for (size_t j = 0; j < self->n; j++)
    if (self->first[j] >= 0) self->second[j] = NOT_WANTED;
  assign_solutions(self, false, self->first);
  assign_solutions(self, false, self->second);
}

/* From the two roots of a mode: a conjugate pair, or two real ones. */
static void set_damped_mode(const quadratic *self, size_t j, strut_mode *mode) {
  if (self->first[j] < 0) return;
  gsl_complex z = gsl_vector_complex_get(self->value, (size_t)self->first[j]);
  double re = GSL_REAL(z), im = GSL_IMAG(z);
  if (im != 0) {
    mode->decay_rate = -re;
    mode->damped_frequency = fabs(im);
    mode->damping_ratio = -re / hypot(re, im);
    return;
  }
  double other = self->second[j] < 0
                     ? re
                     : GSL_REAL(gsl_vector_complex_get(self->value, (size_t)self->second[j]));
  mode->damped_frequency = 0.0;
  mode->decay_rate = -fmax(re, other);
  if (re * other > 0) mode->damping_ratio = -(re + other) / (2.0 * sqrt(re * other));
}

/* Damps each mode separately: exact if the damping does not couple them. */
static void apply_modal_quotient(const strut_modes_work *work, size_t j, double damping,
                                 strut_mode *mode) {
  double z = work->set.value[j], half = 0.5 * damping, inside = half * half - z;
  mode->decay_rate = inside > 0 ? half - sqrt(inside) : half;
  if (inside > 0 && half > 0 && z > 0) mode->decay_rate = z / (half + sqrt(inside));
  mode->damped_frequency = inside < 0 ? sqrt(-inside) : 0.0;
  if (z > 0) mode->damping_ratio = half / sqrt(z);
}

static void apply_modal_quotients(const strut_modes_work *work, strut_mode *list) {
  size_t n = (size_t)work->set.n;
  double *product = work->v->work;
  for (size_t j = 0; j < (size_t)work->set.count; j++) {
    const double *x = work->set.vector + j * n;
    strut_vibration_multiply(work->v, work->v->d, x, product);
    double sum = strut_dot(x, product, (ptrdiff_t)n);
    apply_modal_quotient(work, j, sum + work->v->model->mass_damping, &list[j]);
  }
}

static bool allocate_quadratic(const strut_modes_work *work, quadratic *self) {
  size_t n = self->n;
  self->system = strut_arena_matrix(work->arena, 2 * n, 2 * n);
  self->damping = strut_arena_matrix(work->arena, n, n);
  self->value = gsl_vector_complex_calloc(2 * n);
  self->vector = gsl_matrix_complex_calloc(2 * n, 2 * n);
  self->w = gsl_eigen_nonsymmv_alloc(2 * n);
  return self->system && self->damping && self->value && self->vector && self->w &&
         STRUT_ALLOCATE(work->arena, STRUT_NEW(self->weight, 2 * n * n),
                        STRUT_NEW(self->taken, 2 * n), STRUT_NEW(self->first, n),
                        STRUT_NEW(self->second, n));
}

strut_status strut_modes_damping(const strut_modes_work *work, bool exactly, strut_mode *list,
                                 strut_error *error) {
  apply_modal_quotients(work, list);
  if (!exactly) return STRUT_OK;
  quadratic p = {.n = (size_t)work->set.count};
  strut_status status = STRUT_OK;
  if (!allocate_quadratic(work, &p)) {
    status = strut_no_memory(error, "for damped modes");
  } else if (fill_damping(work, p.damping)) {
    fill_system(work, &p);
    if (gsl_eigen_nonsymmv(p.system, p.value, p.vector, p.w) == 0) {
      compute_weights(&p);
      assign_all_solutions(&p, list);
      for (size_t j = 0; j < p.n; j++) set_damped_mode(&p, j, &list[j]);
    }
  }
  gsl_vector_complex_free(p.value);
  gsl_matrix_complex_free(p.vector);
  gsl_eigen_nonsymmv_free(p.w);
  return status;
}
