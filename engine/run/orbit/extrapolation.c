/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/run/orbit/extrapolation.h"

#include <math.h>

#include "engine/base/vec.h"

enum { WINDOW = STRUT_EXTRAPOLATION_WINDOW };

/* Weights beyond this lose more digits than they win. */
static const double MOST_WEIGHT = 100.0;

/* Solves the small symmetric system a x = 1 in place by elimination; false if it is singular. */
static bool solve_ones(double a[WINDOW][WINDOW], int32_t n, double *x) {
  for (int32_t i = 0; i < n; i++) x[i] = 1.0;
  for (int32_t p = 0; p < n; p++) {
    if (!(a[p][p] > 0.0)) return false;
    for (int32_t i = p + 1; i < n; i++) {
      double f = a[i][p] / a[p][p];
      for (int32_t j = p; j < n; j++) a[i][j] -= f * a[p][j];
      x[i] -= f * x[p];
    }
  }
  for (int32_t i = n - 1; i >= 0; i--) {
    for (int32_t j = i + 1; j < n; j++) x[i] -= a[i][j] * x[j];
    x[i] /= a[i][i];
  }
  return true;
}

bool strut_extrapolation_weights(const strut_period_map *map, double *const *d, int32_t count,
                                 double *weight) {
  int32_t length = map->model->length, nodes = 2 * map->model->node_count;
  double a[WINDOW][WINDOW], sum = 0.0, most = 0.0;
  double in = map->model->size, speed = in * STRUT_TAU / map->period;
  for (int32_t i = 0; i < count; i++)
    for (int32_t j = 0; j <= i; j++) {
      double product = 0.0;
      for (int32_t k = 0; k < nodes; k++)
        product +=
            d[i][k] * d[j][k] / (in * in) + d[i][length + k] * d[j][length + k] / (speed * speed);
      a[i][j] = a[j][i] = product;
    }
  for (int32_t i = 0; i < count; i++) a[i][i] *= 1.0 + 1e-10;
  if (!solve_ones(a, count, weight)) return false;
  for (int32_t i = 0; i < count; i++) sum += weight[i];
  if (!(fabs(sum) > 0.0)) return false;
  for (int32_t i = 0; i < count; i++) most = fmax(most, fabs(weight[i] /= sum));
  return most < MOST_WEIGHT;
}
