/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Curves through few readings: Hermite's cubic, and the vertex of a parabola. */
#pragma once

/**
 * Cubic Hermite interpolation at the fraction s of a step of length h, from x0 with slope v0 to x1
 * with slope v1.
 */
static inline double strut_hermite(double x0, double v0, double x1, double v1, double h, double s) {
  double r = 1.0 - s;
  return x0 * (1.0 + 2.0 * s) * r * r + h * v0 * s * r * r + x1 * s * s * (3.0 - 2.0 * s) -
         h * v1 * s * s * r;
}

typedef struct strut_reading {
  double at, value;
} strut_reading;

/** Where the parabola through three readings turns, and its value there. */
static inline strut_reading strut_vertex(strut_reading a, strut_reading b, strut_reading c) {
  double left = (b.value - a.value) / (b.at - a.at), right = (c.value - b.value) / (c.at - b.at);
  double bend = (right - left) / (c.at - a.at);
  double slope = left + bend * (b.at - a.at); /* at b */
  return (strut_reading){b.at - 0.5 * slope / bend, b.value - 0.25 * slope * slope / bend};
}
