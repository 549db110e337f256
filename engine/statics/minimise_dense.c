/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by all eigenvectors of the Hessian: exact trust-region steps. */
#include <math.h>
#include <string.h>

#include "engine/statics/descent_parts.h"
#include "engine/statics/spectrum.h"
#include "engine/statics/trust_step.h"

typedef struct room {
  strut_spectrum_workspace *spectra;
  strut_spectrum now;
  double *part, *x;  /* (n) the gradient's and the step's share of each mode */
  uint8_t *idle;     /* (n) modes to leave alone */
  double scale;      /* largest |eigenvalue| */
  double multiplier; /* of the step that descend gave last */
} room;

static void room_free(void *memory) {
  room *r = memory;
  if (!r) return;
  strut_spectrum_free(r->spectra);
  strut_release(r->part);
  strut_release(r->x);
  strut_release(r->idle);
  strut_release(r);
}

void *strut_curvature_dense_create(const strut_potential *potential) {
  room *r = strut_allocate(1, sizeof *r);
  if (!r) return NULL;
  r->spectra = strut_spectrum_create(potential);
  r->part = strut_allocate((size_t)potential->n, sizeof *r->part);
  r->x = strut_allocate((size_t)potential->n, sizeof *r->x);
  r->idle = strut_allocate((size_t)potential->n, sizeof *r->idle);
  if (r->spectra && r->part && r->x && r->idle) return r;
  room_free(r);
  return NULL;
}

static bool look(void *memory, const double *q) {
  room *r = memory;
  if (!strut_spectrum_compute(r->spectra, q, 0.0, false, &r->now)) return false;
  const double *value = r->now.value;
  r->scale = r->now.n ? fmax(fabs(value[0]), fabs(value[r->now.n - 1])) : 0.0;
  return true;
}

/* Shares of the gradient; a mode without stiffness and without force beyond `still` is idle. */
static void share(room *r, const double *g, double still) {
  size_t n = (size_t)r->now.n;
  for (size_t i = 0; i < n; i++) {
    const double *mode = r->now.vector + i * n;
    double sum = 0.0;
    for (size_t k = 0; k < n; k++) sum += mode[k] * g[k];
    r->part[i] = sum;
    r->idle[i] = fabs(r->now.value[i]) <= 4.0 * r->now.noise[i] && fabs(sum) <= still;
  }
}

/* s from its shares; its length and what the model gains by it. */
static strut_model_step assemble(const room *r, double *s) {
  size_t n = (size_t)r->now.n;
  strut_model_step step = {0};
  memset(s, 0, n * sizeof *s);
  for (size_t i = 0; i < n; i++) {
    double x = r->x[i];
    if (x == 0.0) continue;
    step.length += x * x;
    step.reduction -= x * (r->part[i] + 0.5 * r->now.value[i] * x);
    for (size_t k = 0; k < n; k++) s[k] += x * r->now.vector[i * n + k];
  }
  step.length = sqrt(step.length);
  return step;
}

static strut_model_step descend(void *memory, const double *g, double radius, double still,
                                double *s) {
  room *r = memory;
  share(r, g, still);
  strut_quadratic model = {r->now.n, r->now.value, r->part, r->idle, r->scale, 0.0};
  if (r->now.n > 0) model.noise = 4.0 * r->now.noise[0];
  r->multiplier = strut_trust_step(&model, radius, r->x);
  return assemble(r, s);
}

static bool straighten(void *memory, const double *g, double *s) {
  room *r = memory;
  size_t n = (size_t)r->now.n;
  double stiff = r->multiplier > 0 ? 10.0 * r->multiplier : 1e-3 * r->scale;
  bool any = false;
  for (size_t i = 0; i < n; i++) {
    const double *mode = r->now.vector + i * n;
    double sum = 0.0;
    if (!(r->now.value[i] > stiff)) continue;
    for (size_t k = 0; k < n; k++) sum += mode[k] * g[k];
    for (size_t k = 0; k < n; k++) s[k] -= sum / r->now.value[i] * mode[k];
    any = true;
  }
  return any;
}

static double newton(void *memory, const double *g, double *s) {
  room *r = memory;
  share(r, g, HUGE_VAL);
  for (int32_t i = 0; i < r->now.n; i++) r->x[i] = r->idle[i] ? 0.0 : -r->part[i] / r->now.value[i];
  return assemble(r, s).length;
}

static bool ridge(void *memory, double *s) {
  room *r = memory;
  if (r->now.n == 0 || !(r->now.value[0] < -4.0 * r->now.noise[0])) return false;
  memcpy(s, r->now.vector, (size_t)r->now.n * sizeof *s);
  return true;
}

const strut_curvature strut_curvature_dense = {look, descend, straighten, newton, ridge, room_free};
