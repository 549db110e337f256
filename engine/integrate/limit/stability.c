/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/limit/stability.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>

/* |R(z)| of RK4 for z = x + i y, R(z) = 1 + z (1 + z/2 (1 + z/3 (1 + z/4))). */
static double growth(double x, double y) {
  double re = 1.0, im = 0.0;
  for (int k = 4; k >= 1; k--) {
    double next = 1.0 + (re * x - im * y) / k;
    im = (re * y + im * x) / k;
    re = next;
  }
  return hypot(re, im);
}

double strut_rk4_limit(double re, double im) {
  double size = hypot(re, im);
  if (!(size > 0)) return HUGE_VAL;
  if (re > 0) re = 0, size = fabs(im); /* a motion that grows by itself says nothing of the step */
  if (!(size > 0)) return HUGE_VAL;
  double x = re / size, y = im / size;
  double inside = 0.0, outside = 3.5; /* RK4's region lies within |z| < 3.5 */
  for (double r = 0.05; r < 3.5; r += 0.05) {
    if (growth(r * x, r * y) > 1.0 + 1e-12) {
      outside = r;
      break;
    }
    inside = r;
  }
  for (int i = 0; i < 60; i++) {
    double middle = 0.5 * (inside + outside);
    if (growth(middle * x, middle * y) > 1.0 + 1e-12)
      outside = middle;
    else
      inside = middle;
  }
  return inside / size;
}

/*
 * One step of Verlet maps (q, v, a) linearly. Are the roots of its characteristic polynomial,
 * x^3 + p x^2 + r x + s, within the unit circle? Jury's conditions; undamped modes lie on it.
 */
static bool verlet_holds(double h, double k, double d) {
  double hk = h * h * k, hd = h * d; /* rows of the matrix for (q, h v, h^2 a) */
  double m[3][3] = {{1.0, 1.0, 0.5},
                    {-0.5 * hk, 1.0 - 0.5 * (hk + hd), 0.5 - 0.5 * (0.5 * hk + hd)},
                    {-hk, -hk - hd, -0.5 * hk - hd}};
  double p = -(m[0][0] + m[1][1] + m[2][2]);
  double r = m[0][0] * m[1][1] - m[0][1] * m[1][0] + m[0][0] * m[2][2] - m[0][2] * m[2][0] +
             m[1][1] * m[2][2] - m[1][2] * m[2][1];
  double s = -(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
  const double slack = 1e-12;
  return 1.0 + p + r + s >= -slack && 1.0 - p + r - s >= -slack && fabs(s) <= 1.0 + slack &&
         fabs(r - p * s) <= 1.0 - s * s + slack;
}

double strut_verlet_limit(double k, double d) {
  double scale = fmax(sqrt(fmax(k, 0.0)), d);
  if (!(scale > 0.0)) return HUGE_VAL;
  double inside = 0.0, outside = 4.0;
  for (double x = 0.02; x < 4.0; x += 0.02) {
    if (!verlet_holds(x / scale, k, d)) {
      outside = x;
      break;
    }
    inside = x;
  }
  for (int i = 0; i < 60; i++) {
    double middle = 0.5 * (inside + outside);
    *(verlet_holds(middle / scale, k, d) ? &inside : &outside) = middle;
  }
  return inside / scale;
}

double strut_euler_limit(double k, double d) {
  if (!(k > 0.0)) return d > 0.0 ? 2.0 / d : HUGE_VAL;
  return 4.0 / (d + sqrt(d * d + 4.0 * k));
}

double strut_region_limit(strut_region region, double re, double im, double k, double d) {
  if (re > 0.0) k = im * im, d = 0.0; /* grows by itself, whatever the step */
  switch (region) {
    case STRUT_REGION_RK4: return strut_rk4_limit(re, im);
    case STRUT_REGION_VERLET: return strut_verlet_limit(k, fmax(d, 0.0));
    case STRUT_REGION_EULER: return strut_euler_limit(k, fmax(d, 0.0));
    case STRUT_REGION_ALL:
    case STRUT_REGIONS: break;
  }
  return HUGE_VAL;
}

const strut_region_data *strut_region_at(strut_region region) {
  /* RK4 bears every complex eigenvalue below 2.6 / h, and every real one below 2.785 / h */
  static const strut_region_data data[STRUT_REGIONS] = {
      [STRUT_REGION_RK4] = {.sets = 2,
                            .set = {{1.0 / (2.6 * 2.6), 0.0}, {0.0, 1.0 / 2.7852935634}},
                            .growth = 4.0,
                            .by_eigenvalue = true},
      [STRUT_REGION_VERLET] = {.sets = 1, .set = {{0.25, 1.0}}, .growth = 1.0},
      [STRUT_REGION_EULER] = {.sets = 1, .set = {{0.25, 0.5}}, .growth = 1.0}};
  assert(region >= 0 && region < STRUT_REGIONS);
  return &data[region];
}
