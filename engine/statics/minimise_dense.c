/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by all eigenvectors of the Hessian: the exact trust-region step of More and Sorensen. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/statics/descent_parts.h"
#include "engine/statics/spectrum.h"

typedef struct room {
  strut_spectrum_room *spectra;
  strut_spectrum now;
  double *part; /* (n) the gradient's share of each mode; then the step's */
  double scale; /* largest |eigenvalue| */
} room;

static void room_free(void *memory) {
  room *r = memory;
  if (!r) return;
  strut_spectrum_free(r->spectra);
  strut_release(r->part);
  strut_release(r);
}

void *strut_curvature_dense_create(const strut_potential *potential) {
  room *r = strut_allocate(1, sizeof *r);
  if (!r) return NULL;
  r->spectra = strut_spectrum_create(potential);
  r->part = strut_allocate((size_t)potential->n, sizeof *r->part);
  if (r->spectra && r->part) return r;
  room_free(r);
  return NULL;
}

static bool look(void *memory, const double *q) {
  room *r = memory;
  if (!strut_spectrum_compute(r->spectra, q, false, &r->now)) return false;
  const double *value = r->now.value;
  r->scale = r->now.n ? fmax(fabs(value[0]), fabs(value[r->now.n - 1])) : 0.0;
  return true;
}

/* Shares of the gradient; those in a mode without stiffness that rounding explains become 0. */
static void share(room *r, const double *g, double still) {
  size_t n = (size_t)r->now.n;
  for (size_t i = 0; i < n; i++) {
    const double *mode = r->now.vector + i * n;
    double sum = 0.0;
    for (size_t k = 0; k < n; k++) sum += mode[k] * g[k];
    bool flat = fabs(r->now.value[i]) <= 4.0 * r->now.noise[i];
    r->part[i] = flat && fabs(sum) <= still ? 0.0 : sum;
  }
}

/* |s| for the multiplier mu, and d|s|/dmu; mu lies above minus the lowest value. */
static double length_at(const room *r, double mu, double *slope) {
  double square = 0.0, cube = 0.0;
  for (int32_t i = 0; i < r->now.n; i++) {
    if (r->part[i] == 0.0) continue;
    double x = r->part[i] / (r->now.value[i] + mu);
    square += x * x;
    cube += x * x / (r->now.value[i] + mu);
  }
  double length = sqrt(square);
  *slope = length > 0 ? -cube / length : 0.0;
  return length;
}

/* The multiplier at which |s| is the radius, between low (too long a step there) and high. */
static double solve_secular(const room *r, double low, double high, double radius) {
  double mu = low > 0 ? low * (1.0 + 1e-12) : low;
  for (int i = 0; i < 80 && high - low > 1e-14 * high; i++) {
    if (!(mu > low && mu < high)) mu = low > 0 ? 0.5 * (low + high) : fmax(1e-3 * high, 0.0);
    double slope, length = length_at(r, mu, &slope);
    if (fabs(length - radius) <= 1e-6 * radius) return mu;
    if (length > radius)
      low = mu;
    else
      high = mu;
    mu += (length / radius - 1.0) * (slope < 0 ? -length / slope : 0.0); /* Newton on 1/|s| */
  }
  return isfinite(mu) && mu >= low && mu <= high ? mu : high;
}

/* s from its shares; its length and what the model gains by it. */
static strut_model_step assemble(const room *r, double mu, double extra, double *s) {
  size_t n = (size_t)r->now.n;
  strut_model_step step = {0};
  memset(s, 0, n * sizeof *s);
  for (size_t i = 0; i < n; i++) {
    double g = r->part[i], value = r->now.value[i];
    double x = g == 0.0 ? 0.0 : -g / (value + mu);
    if (i == 0) x += extra;
    if (x == 0.0) continue;
    step.length += x * x;
    step.reduction -= x * (g + 0.5 * value * x);
    for (size_t k = 0; k < n; k++) s[k] += x * r->now.vector[i * n + k];
  }
  step.length = sqrt(step.length);
  return step;
}

static strut_model_step descend(void *memory, const double *g, double radius, double still,
                                double *s) {
  room *r = memory;
  int32_t n = r->now.n;
  double lowest = HUGE_VAL, size = 0.0, slope;
  share(r, g, still);
  for (int32_t i = n - 1; i >= 0; i--) {
    bool flat = fabs(r->now.value[i]) <= 4.0 * r->now.noise[i];
    if (r->part[i] != 0.0 || !flat) lowest = r->now.value[i];
    size += r->part[i] * r->part[i];
  }
  size = sqrt(size);
  if (lowest == HUGE_VAL) return assemble(r, 1.0, 0.0, s); /* nothing pushes anywhere */
  double floor = fmax(0.0, -lowest) + (lowest <= 0 ? DBL_EPSILON * r->scale + 1e-300 : 0.0);
  double length = length_at(r, floor, &slope);
  if (length <= radius) {
    if (lowest > 0) return assemble(r, 0.0, 0.0, s);
    if (-lowest <= 4.0 * r->now.noise[0]) return assemble(r, floor, 0.0, s);
    double rest = sqrt(fmax(radius * radius - length * length, 0.0));
    return assemble(r, floor, r->part[0] > 0 ? -rest : rest, s); /* the hard case */
  }
  return assemble(r, solve_secular(r, floor, floor + size / radius, radius), 0.0, s);
}

static double newton(void *memory, const double *g, double *s) {
  room *r = memory;
  share(r, g, HUGE_VAL);
  return assemble(r, 0.0, 0.0, s).length;
}

static bool ridge(void *memory, double *s) {
  room *r = memory;
  if (r->now.n == 0 || !(r->now.value[0] < -4.0 * r->now.noise[0])) return false;
  memcpy(s, r->now.vector, (size_t)r->now.n * sizeof *s);
  return true;
}

const strut_curvature strut_curvature_dense = {look, descend, newton, ridge, room_free};
