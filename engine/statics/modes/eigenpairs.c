/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

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

static void fill_matrices(const dense *d) {
  const strut_vibration *v = d->work->v;
  const strut_sparse *a = v->shape->pattern;
  for (int32_t j = 0; j < v->n; j++)
    for (int32_t at = a->start[j]; at < a->start[j + 1]; at++) {
      size_t r = d->place[a->row[at]], c = d->place[j];
      gsl_matrix_set(d->k, r, c, v->k[at]);
      gsl_matrix_set(d->k, c, r, v->k[at]);
      gsl_matrix_set(d->m, r, c, v->m[at]);
      gsl_matrix_set(d->m, c, r, v->m[at]);
    }
}

/* K11 loses K10 K00^-1 K01. */
static bool condense(dense *d) {
  size_t light = d->n - d->massive;
  if (light == 0) return true;
  d->follow = strut_arena_matrix(&d->arena, light, d->massive);
  gsl_permutation *order = strut_arena_order(&d->arena, light);
  int sign = 0;
  bool good = d->follow && order;
  if (good) {
    gsl_matrix_view k00 = gsl_matrix_submatrix(d->k, d->massive, d->massive, light, light);
    gsl_matrix_view k01 = gsl_matrix_submatrix(d->k, d->massive, 0, light, d->massive);
    gsl_matrix_view k11 = gsl_matrix_submatrix(d->k, 0, 0, d->massive, d->massive);
    gsl_matrix_memcpy(d->follow, &k01.matrix);
    good = gsl_linalg_LU_decomp(&k00.matrix, order, &sign) == 0;
    for (size_t c = 0; c < d->massive && good; c++) {
      gsl_vector_view column = gsl_matrix_column(d->follow, c);
      good = gsl_linalg_LU_svx(&k00.matrix, order, &column.vector) == 0;
    }
    if (good)
      gsl_blas_dgemm(CblasTrans, CblasNoTrans, -1.0, &k01.matrix, d->follow, 1.0, &k11.matrix);
  }
  return good;
}

/* Vectors of unit length to such of x'Mx = 1, into the set. */
static void store_eigenpairs(const dense *d) {
  strut_eigen_set *set = &d->work->set;
  double *product = d->work->v->work;
  for (size_t i = 0; i < d->massive; i++) {
    double *x = set->vector + i * d->n, square = 0.0;
    set->value[i] = gsl_vector_get(d->value, i);
    for (size_t r = 0; r < d->n; r++) {
      size_t row = d->place[r];
      x[r] = row < d->massive ? gsl_matrix_get(d->vector, row, i) : 0.0;
      for (size_t c = 0; c < d->massive && row >= d->massive; c++)
        x[r] -= gsl_matrix_get(d->follow, row - d->massive, c) * gsl_matrix_get(d->vector, c, i);
    }
    strut_vibration_multiply(d->work->v, d->work->v->m, x, product);
    for (size_t r = 0; r < d->n; r++) square += x[r] * product[r];
    for (size_t r = 0; r < d->n; r++) x[r] /= sqrt(square);
  }
}

static bool allocate_dense(dense *d) {
  strut_eigen_set *set = &d->work->set;
  const strut_vibration *v = d->work->v;
  d->n = (size_t)v->n, d->massive = (size_t)v->massive;
  d->place = strut_arena_allocate(d->work->arena, d->n, sizeof *d->place);
  set->n = v->n, set->count = v->massive;
  set->value = strut_arena_allocate(d->work->arena, d->massive, sizeof *set->value);
  set->vector = strut_arena_allocate(d->work->arena, d->massive * d->n, sizeof *set->vector);
  d->k = strut_arena_matrix(&d->arena, d->n, d->n);
  d->m = strut_arena_matrix(&d->arena, d->n, d->n);
  d->vector = strut_arena_matrix(&d->arena, d->massive, d->massive);
  d->value = strut_arena_vector(&d->arena, d->massive);
  if (!d->place || !set->value || !set->vector || !d->k || !d->m || !d->vector || !d->value)
    return false;
  for (size_t i = 0, heavy = 0, light = d->massive; i < d->n; i++)
    d->place[i] = v->mass[i] > 0 ? heavy++ : light++;
  return true;
}

static bool solve_dense(dense *d) {
  fill_matrices(d);
  if (!condense(d)) return false;
  gsl_eigen_gensymmv_workspace *w = gsl_eigen_gensymmv_alloc(d->massive);
  if (!w) return false;
  gsl_matrix_view k = gsl_matrix_submatrix(d->k, 0, 0, d->massive, d->massive);
  gsl_matrix_view m = gsl_matrix_submatrix(d->m, 0, 0, d->massive, d->massive);
  bool good = gsl_eigen_gensymmv(&k.matrix, &m.matrix, d->value, d->vector, w) == 0 &&
              gsl_eigen_gensymmv_sort(d->value, d->vector, GSL_EIGEN_SORT_VAL_ASC) == 0;
  if (good) store_eigenpairs(d);
  gsl_eigen_gensymmv_free(w);
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
static const double LEAST =
    1e-13; /* of the largest eigenvalue: less drowns in a factor's rounding */

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

static void apply_inverse(void *context, double *x) {
  strut_modes_work *work = context;
  strut_modes_solve(&work->solver, x);
}

static void apply_mass(void *context, const double *x, double *y) {
  strut_modes_work *work = context;
  strut_vibration_multiply(work->v, work->v->m, x, y);
}

strut_status strut_modes_sparse(strut_modes_work *work, int32_t count, strut_error *error) {
  strut_vibration *v = work->v;
  int32_t below = 0;
  if (count > v->massive - 3) count = v->massive - 3; /* Lanczos's method wants a few to spare */
  double bound = find_bound(work, count, &below), shift = -fmax(1e-3 * bound, LEAST * v->largest);
  if (below > 2 * count + MOST_ALIKE && bound <= LEAST * v->largest)
    return strut_fail(
        error, STRUT_SINGULAR,
        "%d modes have no stiffness, or less than rounding leaves, too many to tell apart "
        "in a structure of this size; cables that are only just taut have none: give "
        "them a prestress",
        (int)below);
  if (below >= v->massive) below = v->massive - 1;
  size_t room = (size_t)below;
  strut_eigen_set *set = &work->set;
  set->n = v->n;
  set->count = below;
  set->value = strut_arena_allocate(work->arena, room, sizeof *set->value);
  set->vector = strut_arena_allocate(work->arena, room * (size_t)v->n, sizeof *set->vector);
  if (!set->value || !set->vector) return strut_no_memory(error, "");
  for (int i = 0; i < MOST_FACTORS && count_below(work, shift) > 0; i++) shift *= 4.0;
  strut_lanczos_problem problem = {v->n,          shift,      work,
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

static void fill_system(const strut_modes_work *work, quadratic *p) {
  for (size_t i = 0; i < p->n; i++) {
    double z = work->set.value[i], a = sqrt(fabs(z));
    gsl_matrix_set(p->system, i, p->n + i, a);
    gsl_matrix_set(p->system, p->n + i, i, z > 0 ? -a : a);
    for (size_t j = 0; j < p->n; j++)
      gsl_matrix_set(p->system, p->n + i, p->n + j, -gsl_matrix_get(p->damping, i, j));
  }
}

static void compute_weights(quadratic *p) {
  for (size_t i = 0; i < 2 * p->n; i++)
    for (size_t j = 0; j < p->n; j++) {
      gsl_complex a = gsl_matrix_complex_get(p->vector, j, i);
      gsl_complex b = gsl_matrix_complex_get(p->vector, p->n + j, i);
      p->weight[i * p->n + j] = GSL_REAL(a) * GSL_REAL(a) + GSL_IMAG(a) * GSL_IMAG(a) +
                                GSL_REAL(b) * GSL_REAL(b) + GSL_IMAG(b) * GSL_IMAG(b);
    }
}

/* Repeatedly assigns the best free solution to a mode that lacks one in `slot`. */
static void assign_solutions(quadratic *p, bool oscillating, int32_t *slot) {
  for (;;) {
    double most = LEAST_SHARE;
    size_t solution = 0, mode = 0;
    for (size_t i = 0; i < 2 * p->n; i++) {
      double im = GSL_IMAG(gsl_vector_complex_get(p->value, i));
      if (p->taken[i] || (oscillating ? !(im > 0) : im != 0)) continue;
      for (size_t j = 0; j < p->n; j++)
        if (slot[j] == NONE && p->weight[i * p->n + j] > most)
          most = p->weight[i * p->n + j], solution = i, mode = j;
    }
    if (!(most > LEAST_SHARE)) return;
    p->taken[solution] = 1;
    slot[mode] = (int32_t)solution;
  }
}

/* Modes that swing by themselves get a conjugate pair, or two real solutions. */
static void assign_all_solutions(quadratic *p, const strut_mode *list) {
  for (size_t j = 0; j < p->n; j++)
    p->first[j] = p->second[j] = list[j].kind == STRUT_MODE_ELASTIC ? NONE : NOT_WANTED;
  assign_solutions(p, true, p->first);
  for (size_t j = 0; j < p->n; j++)
    if (p->first[j] >= 0) p->second[j] = NOT_WANTED;
  assign_solutions(p, false, p->first);
  assign_solutions(p, false, p->second);
}

/* From the two roots of a mode: a conjugate pair, or two real ones. */
static void set_damped_mode(const quadratic *p, size_t j, strut_mode *mode) {
  if (p->first[j] < 0) return;
  gsl_complex z = gsl_vector_complex_get(p->value, (size_t)p->first[j]);
  double re = GSL_REAL(z), im = GSL_IMAG(z);
  if (im != 0) {
    mode->decay_rate = -re;
    mode->damped_frequency = fabs(im);
    mode->damping_ratio = -re / hypot(re, im);
    return;
  }
  double other =
      p->second[j] < 0 ? re : GSL_REAL(gsl_vector_complex_get(p->value, (size_t)p->second[j]));
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

static bool allocate_quadratic(const strut_modes_work *work, quadratic *p) {
  size_t n = p->n;
  p->system = gsl_matrix_calloc(2 * n, 2 * n);
  p->damping = gsl_matrix_calloc(n, n);
  p->value = gsl_vector_complex_calloc(2 * n);
  p->vector = gsl_matrix_complex_calloc(2 * n, 2 * n);
  p->w = gsl_eigen_nonsymmv_alloc(2 * n);
  p->weight = strut_arena_allocate(work->arena, 2 * n * n, sizeof *p->weight);
  p->taken = strut_arena_allocate(work->arena, 2 * n, sizeof *p->taken);
  p->first = strut_arena_allocate(work->arena, n, sizeof *p->first);
  p->second = strut_arena_allocate(work->arena, n, sizeof *p->second);
  return p->system && p->damping && p->value && p->vector && p->w && p->weight && p->taken &&
         p->first && p->second;
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
  gsl_matrix_free(p.system);
  gsl_matrix_free(p.damping);
  gsl_vector_complex_free(p.value);
  gsl_matrix_complex_free(p.vector);
  gsl_eigen_nonsymmv_free(p.w);
  return status;
}
