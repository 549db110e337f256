/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Damping of modes: (z^2 M + z D + K) x = 0, each solution given to the mode that it is most of. */
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

#include "engine/statics/modes/parts.h"

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
  double *product = (double *)work->v->work;
  bool any = false;
  for (size_t j = 0; j < count; j++) {
    strut_vibration_multiply(work->v, work->v->d, set->vector + j * n, product);
    for (size_t i = 0; i < count; i++) {
      double sum = 0.0;
      for (size_t k = 0; k < n; k++) sum += set->vector[i * n + k] * product[k];
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
  double *product = (double *)work->v->work;
  for (size_t j = 0; j < (size_t)work->set.count; j++) {
    const double *x = work->set.vector + j * n;
    double sum = 0.0;
    strut_vibration_multiply(work->v, work->v->d, x, product);
    for (size_t k = 0; k < n; k++) sum += x[k] * product[k];
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
