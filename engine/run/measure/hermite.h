/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The cubic through both ends of a step with their slopes.
 */
#ifndef STRUT_ENGINE_RUN_MEASURE_HERMITE_H
#define STRUT_ENGINE_RUN_MEASURE_HERMITE_H

/** At the fraction s of a step of length h, from x0 with slope v0 to x1 with slope v1. */
static inline double strut_hermite(double x0, double v0, double x1, double v1, double h, double s) {
  double r = 1.0 - s;
  return x0 * (1.0 + 2.0 * s) * r * r + h * v0 * s * r * r + x1 * s * s * (3.0 - 2.0 * s) -
         h * v1 * s * s * r;
}

#endif
