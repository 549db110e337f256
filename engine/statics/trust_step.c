/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/trust_step.h"

#include <float.h>
#include <math.h>

/* |x| for the multiplier mu, and d|x|/dmu; mu lies above minus the lowest value. */
static double length_at(const strut_quadratic *r, double mu, double *slope) {
  double square = 0.0, cube = 0.0;
  for (int32_t i = 0; i < r->n; i++) {
    if (r->idle[i] || r->part[i] == 0.0) continue;
    double x = r->part[i] / (r->value[i] + mu);
    square += x * x;
    cube += x * x / (r->value[i] + mu);
  }
  double length = sqrt(square);
  *slope = length > 0 ? -cube / length : 0.0;
  return length;
}

/* The multiplier at which |x| is the radius, between low (too long a step there) and high. */
static double solve_secular(const strut_quadratic *r, double low, double high, double radius) {
  double mu = low > 0 ? low * (1.0 + 1e-12) : low;
  for (int i = 0; i < 80 && high - low > 1e-14 * high; i++) {
    if (!(mu > low && mu < high)) mu = low > 0 ? 0.5 * (low + high) : 1e-3 * high;
    double slope, length = length_at(r, mu, &slope);
    if (fabs(length - radius) <= 1e-6 * radius) return mu;
    if (length > radius)
      low = mu;
    else
      high = mu;
    mu += (length / radius - 1.0) * (slope < 0 ? -length / slope : 0.0); /* Newton on 1/|x| */
  }
  return isfinite(mu) && mu >= low && mu <= high ? mu : high;
}

static double assemble(const strut_quadratic *r, double mu, double *x) {
  for (int32_t i = 0; i < r->n; i++)
    x[i] = r->idle[i] || r->part[i] == 0.0 ? 0.0 : -r->part[i] / (r->value[i] + mu);
  return mu;
}

double strut_trust_step(const strut_quadratic *r, double radius, double *x) {
  double size = 0.0, slope;
  int32_t low = -1;
  for (int32_t i = 0; i < r->n; i++) {
    if (r->idle[i]) continue;
    if (low < 0 || r->value[i] < r->value[low]) low = i;
    size += r->part[i] * r->part[i];
  }
  size = sqrt(size);
  if (low < 0) return assemble(r, 0.0, x); /* nothing pushes anywhere */
  double lowest = r->value[low];
  double floor = fmax(0.0, -lowest) + (lowest <= 0 ? DBL_EPSILON * r->scale + 1e-300 : 0.0);
  double length = length_at(r, floor, &slope);
  if (length > radius)
    return assemble(r, solve_secular(r, floor, floor + size / radius, radius), x);
  assemble(r, floor, x);
  if (lowest > -r->noise) return floor;
  double rest = sqrt(fmax(radius * radius - length * length, 0.0)); /* the hard case */
  x[low] += r->part[low] > 0 ? -rest : rest;
  return floor;
}
