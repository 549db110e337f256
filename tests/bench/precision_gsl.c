/* SPDX-License-Identifier: GPL-3.0-or-later */
/* GSL's odeiv2, and the classical Runge-Kutta method written by hand, in the work-precision tables. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdio.h>

#include "engine/base/memory.h"
#include "tests/bench/precision.h"
#include "tests/bench/scenes.h"

enum { MOST_DENSE = 200 };

static int rate(double t, const double y[], double dydt[], void *problem) {
  return precision_rate(problem, t, y, dydt) ? GSL_SUCCESS : GSL_EBADFUNC;
}

/* By differences, (2 n, 2 n) row by row: every call costs 2 n + 2 evaluations. */
static int jacobian(double t, const double y[], double *dfdy, double dfdt[], void *problem) {
  precision_problem *p = problem;
  int n = 2 * p->n;
  static double z[MOST_DENSE], base[MOST_DENSE], moved[MOST_DENSE];
  double later = 1e-7 * p->end;
  for (int i = 0; i < n; i++) z[i] = y[i];
  bool good = precision_rate(p, t, z, base);
  for (int j = 0; j < n && good; j++) {
    double step = 1e-7 * (j < p->n ? p->reach : p->speed);
    z[j] = y[j] + step;
    good = precision_rate(p, t, z, moved);
    z[j] = y[j];
    for (int i = 0; i < n; i++) dfdy[i * n + j] = (moved[i] - base[i]) / step;
  }
  good = good && precision_rate(p, t + later, z, moved);
  for (int i = 0; i < n; i++) dfdt[i] = (moved[i] - base[i]) / later;
  return good ? GSL_SUCCESS : GSL_EBADFUNC;
}

static const gsl_odeiv2_step_type *type_of(int variant) {
  switch (variant) {
    case 0: return gsl_odeiv2_step_rkf45;
    case 1: return gsl_odeiv2_step_rk8pd;
    case 2: return gsl_odeiv2_step_msadams;
    case 3: return gsl_odeiv2_step_msbdf;
    default: return gsl_odeiv2_step_bsimp;
  }
}

static bool integrate(precision_problem *p, gsl_odeiv2_driver *d, double *t, double to, double *y) {
  int status = GSL_SUCCESS;
  while (*t < to && status == GSL_SUCCESS) {
    status = gsl_odeiv2_evolve_apply(d->e, d->c, d->s, d->sys, t, to, &d->h, y);
    if (d->h > d->hmax) d->h = d->hmax;
    if (precision_renew(p, *t, y)) gsl_odeiv2_driver_reset(d);
  }
  return status == GSL_SUCCESS;
}

static bool solve(precision_problem *p, const precision_method *method, double setting,
                  precision_answer *answer) {
  int n = 2 * p->n;
  if (method->implicit && n > MOST_DENSE) {
    snprintf(answer->note, sizeof answer->note, "dense Jacobian only");
    return false;
  }
  double *y = strut_allocate((size_t)(2 * n), sizeof *y), *scale = y + n;
  double t = 0.0, from = 0.0, loose = method->implicit && p->scene->loose > 0 ? p->scene->loose : 1;
  if (!y) return false;
  gsl_odeiv2_system system = {rate, jacobian, (size_t)n, p};
  gsl_set_error_handler_off();
  precision_start(p, y);
  for (int i = 0; i < n; i++) scale[i] = i < p->n ? p->reach : loose * p->speed;
  double begin = bench_seconds();
  double longest = p->end / (double)p->parts / 5;
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_scaled_new(
      &system, type_of(method->variant), 1e-4 * longest, setting, 0.0, 1.0, 0.0, scale);
  gsl_odeiv2_driver_set_hmax(d, longest);
  bool good = integrate(p, d, &t, p->begin, y);
  if (good) from = precision_place(p, y);
  good = good && integrate(p, d, &t, p->end, y);
  answer->velocity = good ? (precision_place(p, y) - from) / (p->end - p->begin) : (double)NAN;
  gsl_odeiv2_driver_free(d);
  answer->seconds = bench_seconds() - begin;
  answer->evaluations = p->evaluations;
  if (!good && !precision_late) snprintf(answer->note, sizeof answer->note, "failed at %.3g s", t);
  strut_release(y);
  return true;
}

/* ---- by hand ---- */

static bool step_by_hand(precision_problem *p, double t, double h, double *y, double *work) {
  int n = 2 * p->n;
  double *k[4] = {work, work + n, work + 2 * n, work + 3 * n}, *z = work + 4 * n;
  bool good = precision_rate(p, t, y, k[0]);
  for (int s = 1; s < 4 && good; s++) {
    double ahead = s < 3 ? 0.5 * h : h;
    for (int i = 0; i < n; i++) z[i] = y[i] + ahead * k[s - 1][i];
    good = precision_rate(p, t + ahead, z, k[s]);
  }
  for (int i = 0; i < n; i++) y[i] += h / 6 * (k[0][i] + 2 * (k[1][i] + k[2][i]) + k[3][i]);
  return good;
}

static bool solve_by_hand(precision_problem *p, const precision_method *method, double setting,
                          precision_answer *answer) {
  int n = 2 * p->n;
  double *y = strut_allocate((size_t)(6 * n), sizeof *y), from = 0.0;
  int64_t steps = p->parts * (int64_t)ceil(p->end / (double)p->parts / setting);
  int64_t first = (int64_t)(p->begin / p->end * (double)steps + 0.5);
  double h = p->end / (double)steps;
  bool good = true;
  (void)method;
  if (!y) return false;
  precision_start(p, y);
  double begin = bench_seconds();
  for (int64_t s = 0; s < steps && good; s++) {
    if (s == first) from = precision_place(p, y);
    good = step_by_hand(p, (double)s * h, h, y, y + n);
    precision_renew(p, (double)(s + 1) * h, y);
  }
  answer->velocity = good ? (precision_place(p, y) - from) / (p->end - p->begin) : (double)NAN;
  answer->seconds = bench_seconds() - begin;
  answer->evaluations = p->evaluations;
  strut_release(y);
  return true;
}

const precision_method precision_gsl_methods[] = {
    {.name = "RK4 by hand", .ladder = PRECISION_STEPS, .like = "rk4", .solve = solve_by_hand},
    {.name = "GSL rkf45", .solve = solve},
    {.name = "GSL rk8pd", .variant = 1, .solve = solve},
    {.name = "GSL msadams", .variant = 2, .solve = solve},
    {.name = "GSL msbdf", .variant = 3, .implicit = true, .solve = solve},
    {.name = "GSL bsimp", .variant = 4, .implicit = true, .solve = solve},
    {.name = NULL}};
