/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/step_limit.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

#include "engine/forces/rigid.h"
#include "engine/forces/stiffness.h"

/* A free-coordinate vector to node arrays, through M^-1 and what rigid bars allow, and back. */
static void divide_by_mass(const strut_model *model, const strut_tangent *tangent, double *x,
                           double *work) {
  size_t both = (size_t)model->length;
  double *force = work, *acceleration = work + both, *scratch = work + 2 * both;
  memset(force, 0, both * sizeof *force);
  for (int32_t i = 0; i < tangent->n; i++) force[tangent->coordinate[i]] = x[i];
  strut_mass_solve(model, force, acceleration, scratch);
  if (tangent->rigid) strut_rigid_filter(model, tangent->rigid, acceleration, scratch);
  for (int32_t i = 0; i < tangent->n; i++) x[i] = acceleration[tangent->coordinate[i]];
}

/* Steps of Lanczos's method at most; vectors of one run of it, and what it has found so far. */
enum { LANCZOS_STEPS = 120 };

typedef struct lanczos {
  double *v, *u, *before, *r, *work; /* v, u = M v, the u before, residual; 3 node arrays */
  double alpha[LANCZOS_STEPS], beta[LANCZOS_STEPS]; /* of the tridiagonal matrix */
} lanczos;

static bool lanczos_create(const strut_model *model, size_t n, strut_arena *arena, lanczos *l) {
  l->v = strut_arena_allocate(arena, n, sizeof(double));
  l->u = strut_arena_allocate(arena, n, sizeof(double));
  l->before = strut_arena_allocate(arena, n, sizeof(double));
  l->r = strut_arena_allocate(arena, n, sizeof(double));
  l->work = strut_arena_allocate(arena, 3 * (size_t)model->length, sizeof(double));
  return l->v && l->u && l->before && l->r && l->work;
}

/* Are all eigenvalues of the leading n rows below x? Then all pivots of T - x are negative. */
static bool all_below(const lanczos *l, int n, double x) {
  double pivot = l->alpha[0] - x;
  for (int j = 1; j < n && pivot < 0; j++)
    pivot = l->alpha[j] - x - l->beta[j - 1] * l->beta[j - 1] / pivot;
  return pivot < 0;
}

/* The largest eigenvalue of the leading n rows, at least 0. */
static double largest_of_tridiagonal(const lanczos *l, int n) {
  double low = 0.0, high = 0.0;
  for (int j = 0; j < n; j++)
    high = fmax(high, fabs(l->alpha[j]) + l->beta[j] + (j ? l->beta[j - 1] : 0.0));
  for (int i = 0; i < 50; i++) {
    double middle = 0.5 * (low + high);
    *(all_below(l, n, middle) ? &high : &low) = middle;
  }
  return high;
}

/* A start that leans on no motion: bits stirred from the index. */
static double stirred(uint64_t i) {
  uint64_t z = (i + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  return (double)((z ^ (z >> 27)) >> 11) * 0x1p-53 - 0.5;
}

/*
 * The next v and u from the residual: divided by its size in the mass, which is returned. 0: the
 * motions seen so far are all there are.
 */
static double next_vector(const strut_model *model, const strut_tangent *tangent, lanczos *l) {
  double square = 0.0;
  memcpy(l->v, l->r, (size_t)tangent->n * sizeof *l->v);
  divide_by_mass(model, tangent, l->v, l->work);
  for (int32_t i = 0; i < tangent->n; i++) square += l->r[i] * l->v[i];
  if (!(square > 0)) return 0.0;
  double size = sqrt(square), *swap = l->before;
  l->before = l->u, l->u = swap;
  for (int32_t i = 0; i < tangent->n; i++) l->u[i] = l->r[i] / size, l->v[i] /= size;
  return size;
}

/*
 * The largest eigenvalue of M^-1 A for a symmetric A, from below, by Lanczos's method in the inner
 * product of the mass; 0 if none is positive.
 */
static double largest_eigenvalue(const strut_model *model, const strut_tangent *tangent,
                                 const strut_sparse *matrix, lanczos *l) {
  int32_t n = tangent->n;
  int most = n < LANCZOS_STEPS ? n : LANCZOS_STEPS;
  double value = 0.0, size = 0.0;
  for (int32_t i = 0; i < n; i++) l->r[i] = stirred((uint64_t)i), l->u[i] = l->before[i] = 0.0;
  if (!(next_vector(model, tangent, l) > 0)) return 0.0;
  for (int j = 0; j < most; j++) {
    double alpha = 0.0, earlier = value;
    strut_sparse_multiply(matrix, l->v, l->r);
    for (int32_t i = 0; i < n; i++) alpha += l->v[i] * l->r[i];
    for (int32_t i = 0; i < n; i++) l->r[i] -= alpha * l->u[i] + size * l->before[i];
    l->alpha[j] = alpha;
    l->beta[j] = 0.0;
    value = largest_of_tridiagonal(l, j + 1);
    size = next_vector(model, tangent, l);
    l->beta[j] = size;
    if (size <= 1e-10 * value || (j > 30 && value - earlier < 1e-7 * value)) break;
  }
  return value;
}

/*
 * Without all eigenvalues: an eigenvalue z belongs to a motion x with z^2 + d z + k = 0, where k and
 * d are the quotients of its K and D with M, so not above the largest of those. Where z is complex
 * |z|^2 = k; where it is real |z| <= d. RK4 bears |h z| < 2.6 in every direction to the left, and
 * 2 sqrt(2) where d / (2 |z|) <= 0.3, which holds of all motions that matter if d is below 0.55 of
 * the largest |z|.
 */
static strut_status estimate(const strut_model *model, const strut_tangent *tangent,
                             strut_arena *arena, strut_step_limit *limit) {
  const double margin = 1.01; /* the method comes from below */
  lanczos l;
  if (!lanczos_create(model, (size_t)tangent->n, arena, &l)) return STRUT_NO_MEMORY;
  double omega = sqrt(margin * largest_eigenvalue(model, tangent, tangent->stiffness, &l));
  double rate = margin * largest_eigenvalue(model, tangent, tangent->damping, &l);
  for (int region = 0; region < STRUT_REGIONS; region++) {
    double swing = strut_region_limit((strut_region)region, 0.0, omega, omega * omega, 0.0);
    double decay = strut_region_limit((strut_region)region, -rate, 0.0, 0.0, rate);
    /* with both at once less than each alone bears; a mode's d is not above the largest */
    bool both = region != STRUT_REGION_RK4 && rate > 0.0 && omega > 0.0;
    double mixed =
        both ? strut_region_limit((strut_region)region, 0.0, 0.0, omega * omega, rate) : HUGE_VAL;
    limit->of[region] = fmin(fmin(swing, decay), mixed);
  }
  double oscillating = rate <= 0.55 * omega ? strut_rk4_limit(0.0, omega) : 2.6 / omega;
  limit->largest_frequency = omega;
  limit->limit = fmin(omega > 0 ? oscillating : HUGE_VAL, strut_rk4_limit(-rate, 0.0));
  limit->of[STRUT_REGION_RK4] = limit->limit;
  limit->exact = false;
  return STRUT_OK;
}

/* Dense M^-1 A of the free coordinates, column by column, times -1, into the block at (row, column). */
static void fill_block(const strut_model *model, const strut_tangent *tangent,
                       const strut_sparse *matrix, gsl_matrix *system, size_t column, double *x,
                       double *y, double *work) {
  size_t n = (size_t)tangent->n;
  for (size_t j = 0; j < n; j++) {
    memset(x, 0, n * sizeof *x);
    x[j] = 1.0;
    strut_sparse_multiply(matrix, x, y);
    divide_by_mass(model, tangent, y, work);
    for (size_t i = 0; i < n; i++) gsl_matrix_set(system, n + i, column + j, -y[i]);
  }
}

/*
 * k and d of the mode with eigenvalue z and vector x: d from the damping block, k from z^2 + d z + k
 * = 0. Both are exact where modes are not coupled by damping.
 */
static void mode_of(const gsl_matrix *system, gsl_complex z, const gsl_vector_complex *x, double *k,
                    double *d) {
  size_t n = system->size1 / 2;
  double re = GSL_REAL(z), im = GSL_IMAG(z), size = 0.0, product = 0.0;
  *d = -2.0 * re, *k = re * re + im * im;
  if (im != 0.0) return;
  for (size_t i = 0; i < n; i++) {
    double xi = GSL_REAL(gsl_vector_complex_get(x, i)), sum = 0.0;
    for (size_t j = 0; j < n; j++)
      sum -= gsl_matrix_get(system, n + i, n + j) * GSL_REAL(gsl_vector_complex_get(x, j));
    size += xi * xi;
    product += xi * sum;
  }
  *d = size > 0.0 ? product / size : -re;
  *k = fmax(0.0, -re * re - *d * re);
}

static void read_spectrum(const gsl_matrix *system, const gsl_vector_complex *values,
                          const gsl_matrix_complex *vectors, strut_step_limit *limit) {
  for (int region = 0; region < STRUT_REGIONS; region++) limit->of[region] = HUGE_VAL;
  for (size_t i = 0; i < values->size; i++) {
    gsl_complex z = gsl_vector_complex_get(values, i);
    gsl_vector_complex_const_view x = gsl_matrix_complex_const_column(vectors, i);
    double k, d;
    mode_of(system, z, &x.vector, &k, &d);
    for (int region = 0; region < STRUT_REGIONS; region++)
      limit->of[region] =
          fmin(limit->of[region],
               strut_region_limit((strut_region)region, GSL_REAL(z), GSL_IMAG(z), k, d));
  }
  limit->limit = limit->of[STRUT_REGION_RK4];
}

/* All eigenvalues of the first-order system [0 1; -M^-1 K, -M^-1 D]. */
static strut_status solve_exactly(const strut_model *model, const strut_tangent *tangent,
                                  strut_arena *arena, strut_step_limit *limit) {
  size_t n = (size_t)tangent->n, both = (size_t)model->length;
  double *x = strut_arena_allocate(arena, n, sizeof *x);
  double *y = strut_arena_allocate(arena, n, sizeof *y);
  double *work = strut_arena_allocate(arena, 3 * both, sizeof *work);
  lanczos l;
  bool room = lanczos_create(model, n, arena, &l);
  gsl_matrix *system = gsl_matrix_calloc(2 * n, 2 * n), *kept = gsl_matrix_calloc(2 * n, 2 * n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(2 * n);
  gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(2 * n, 2 * n);
  gsl_eigen_nonsymmv_workspace *w = gsl_eigen_nonsymmv_alloc(2 * n);
  strut_status status = STRUT_NO_MEMORY;
  if (x && y && work && room && system && kept && values && vectors && w) {
    for (size_t i = 0; i < n; i++) gsl_matrix_set(system, i, n + i, 1.0);
    fill_block(model, tangent, tangent->stiffness, system, 0, x, y, work);
    fill_block(model, tangent, tangent->damping, system, n, x, y, work);
    limit->largest_frequency = sqrt(largest_eigenvalue(model, tangent, tangent->stiffness, &l));
    gsl_matrix_memcpy(kept, system);
    if (gsl_eigen_nonsymmv(system, values, vectors, w) == 0) {
      read_spectrum(kept, values, vectors, limit);
      limit->exact = true;
      status = STRUT_OK;
    } else {
      status = estimate(model, tangent, arena, limit);
    }
  }
  gsl_matrix_free(system);
  gsl_matrix_free(kept);
  gsl_matrix_complex_free(vectors);
  gsl_vector_complex_free(values);
  gsl_eigen_nonsymmv_free(w);
  return status;
}

/* The same without the ground's dampers, for methods in which they are implicit. */
static strut_status limits(const strut_model *model, bool dampers, strut_arena *arena,
                           strut_step_limit *limit) {
  strut_tangent tangent;
  *limit = (strut_step_limit){.limit = HUGE_VAL, .exact = true};
  for (int region = 0; region < STRUT_REGIONS; region++)
    limit->of[region] = limit->of_implicit[region] = HUGE_VAL;
  strut_status status =
      strut_tangent_assemble(model, model->start, model->members.rest,
                             dampers ? STRUT_CLOSED_ALL : STRUT_CLOSED_UNDAMPED, arena, &tangent);
  if (status || tangent.n == 0) return status;
  if ((model->plan & STRUT_TERM_RIGID) &&
      !(tangent.rigid = strut_rigid_standing(model, model->start, arena)))
    return STRUT_NO_MEMORY;
  return tangent.n <= STRUT_EXACT_LIMIT ? solve_exactly(model, &tangent, arena, limit)
                                        : estimate(model, &tangent, arena, limit);
}

strut_status strut_step_limit_estimate(const strut_model *model, strut_step_limit *limit,
                                       strut_error *error) {
  strut_arena arena = {0};
  strut_step_limit implicit;
  bool damped = false;
  for (int32_t i = 0; i < model->contacts.count; i++)
    damped = damped || model->contacts.entry[i].damping > 0.0 ||
             model->contacts.entry[i].dissipation > 0.0;
  strut_status status = limits(model, true, &arena, limit);
  implicit = *limit;
  if (!status && damped) status = limits(model, false, &arena, &implicit);
  for (int region = 0; region < STRUT_REGIONS; region++)
    limit->of_implicit[region] = implicit.of[region];
  strut_arena_free(&arena);
  return status ? strut_fail(error, status, "out of memory") : STRUT_OK;
}

double strut_step_limit_of(const strut_step_limit *limit, const strut_integrator *method) {
  return method->implicit_damper ? limit->of_implicit[method->region] : limit->of[method->region];
}
