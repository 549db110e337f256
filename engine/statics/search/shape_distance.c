/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far two shapes are from each other after the best rigid motion (Procrustes in the plane). */
#include <math.h>

#include "engine/statics/search/critical.h"

static void centre_of(const strut_model *model, const double *q, double centre[2]) {
  centre[0] = centre[1] = 0.0;
  for (int32_t at = 0; at < 2 * model->node_count; at++) centre[at % 2] += q[at];
  for (int c = 0; c < 2; c++) centre[c] /= model->node_count;
}

/* b, mirrored in x where `side` is -1, turned and shifted onto a by least squares. */
static double distance(const strut_model *model, const double *a, const double *b, double side) {
  double p[2], r[2], along = 0.0, across = 0.0, largest = 0.0;
  centre_of(model, a, p);
  centre_of(model, b, r);
  for (int32_t i = 0; i < model->node_count; i++) {
    double ax = a[2 * i] - p[0], ay = a[2 * i + 1] - p[1];
    double bx = side * (b[2 * i] - r[0]), by = b[2 * i + 1] - r[1];
    along += ax * bx + ay * by;
    across += ay * bx - ax * by;
  }
  double size = sqrt(along * along + across * across);
  double c = size > 0 ? along / size : 1.0, s = size > 0 ? across / size : 0.0;
  for (int32_t i = 0; i < model->node_count; i++) {
    double ax = a[2 * i] - p[0], ay = a[2 * i + 1] - p[1];
    double bx = side * (b[2 * i] - r[0]), by = b[2 * i + 1] - r[1];
    largest = fmax(largest, hypot(ax - (c * bx - s * by), ay - (s * bx + c * by)));
  }
  return largest;
}

double strut_shape_distance(const strut_model *model, const double *a, const double *b, bool mirror,
                            bool *mirrored) {
  double plain = distance(model, a, b, 1.0);
  double other = mirror ? distance(model, a, b, -1.0) : HUGE_VAL;
  if (mirrored) *mirrored = other < plain;
  return fmin(plain, other);
}
