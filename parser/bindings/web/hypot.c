/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * hypot with the bits of the GNU C library (2.35 and later), which the program has; emscripten's own differs in the
 * last bit, and GSL's decompositions and eigenvalues carry that on.
 *
 * Algorithm: C. F. Borges, An Improved Algorithm for hypot(a, b), arXiv:1904.09481: a root, and one correction.
 */
#include <math.h>

/* Of a >= b > 0 whose squares neither overflow nor underflow. */
static double corrected(double a, double b) {
  double h = sqrt(a * a + b * b), first, second;
  if (h <= 2.0 * b) {
    double over = h - b;
    first = a * (2.0 * over - a);
    second = (over - 2.0 * (a - b)) * over;
  } else {
    double over = h - a;
    first = 2.0 * over * (a - 2.0 * b);
    second = (4.0 * over - b) * b + over * over;
  }
  return h - (first + second) / (2.0 * h);
}

double hypot(double x, double y) {
  const double half_bit = 0x1p-54, scale = 0x1p-600;
  if (!isfinite(x) || !isfinite(y)) return isinf(x) || isinf(y) ? (double)INFINITY : x + y;
  double a = fmax(fabs(x), fabs(y)), b = fmin(fabs(x), fabs(y));
  if (b <= a * half_bit) return a + b;
  if (a > 0x1p+511) return corrected(a * scale, b * scale) / scale;
  if (b < 0x1p-459) return corrected(a / scale, b / scale) * scale;
  return corrected(a, b);
}
