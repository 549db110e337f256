/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/slow_elements.h"

#include <gsl/gsl_spline.h>

#include "tests/support/check.h"

slow_strain slow_path_of(const strut_member *m) {
  slow_strain s = {.kind = SLOW_PATH, .count = m->guide_count + 2};
  assert_true(s.count <= SLOW_MOST);
  s.node[0] = m->node[0], s.node[s.count - 1] = m->node[1];
  for (size_t k = 0; k < m->guide_count; k++) s.node[k + 1] = m->guides[k];
  return s;
}

static long double distance(const long double *a, const long double *b) {
  return hypotl(b[0] - a[0], b[1] - a[1]);
}

static long double path_of(const slow_strain *s, const long double *q) {
  long double sum = 0;
  for (size_t k = 0; k + 1 < s->count; k++)
    sum += distance(q + 2 * s->node[k], q + 2 * s->node[k + 1]);
  return sum;
}

static long double angle_of(const slow_strain *s, const long double *q) {
  const long double *a = q + 2 * s->node[0], *o = q + 2 * s->node[1], *c = q + 2 * s->node[2];
  long double turn = atan2l(c[1] - o[1], c[0] - o[0]) - atan2l(a[1] - o[1], a[0] - o[0]);
  return turn - 2 * acosl(-1) * roundl((turn - s->near) / (2 * acosl(-1)));
}

/* The shoelace formula. */
static long double area_of(const slow_strain *s, const long double *q) {
  long double twice = 0;
  for (size_t k = 0; k < s->count; k++) {
    const long double *a = q + 2 * s->node[k], *b = q + 2 * s->node[(k + 1) % s->count];
    twice += a[0] * b[1] - b[0] * a[1];
  }
  return s->near < 0 ? -twice / 2 : twice / 2;
}

/* Where on the segment the nearest point is: beyond an end where the angle there is obtuse. */
static long double share_of(const slow_strain *s, const long double *q) {
  const long double *p = q + 2 * s->node[0], *a = q + 2 * s->node[1], *b = q + 2 * s->node[2];
  long double pa = distance(p, a), pb = distance(p, b), ab = distance(a, b);
  if (pb * pb >= pa * pa + ab * ab) return 0;
  if (pa * pa >= pb * pb + ab * ab) return 1;
  return (pa * pa - pb * pb + ab * ab) / (2 * ab * ab); /* the law of cosines */
}

static long double reach_of(const slow_strain *s, const long double *q) {
  const long double *p = q + 2 * s->node[0], *a = q + 2 * s->node[1], *b = q + 2 * s->node[2];
  long double share = s->held ? s->share : share_of(s, q);
  long double foot[2] = {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])};
  return distance(foot, p);
}

static long double along_of(const slow_strain *s, const long double *q) {
  const long double *a = q + 2 * s->node[0], *b = q + 2 * s->node[1];
  return distance(a, b) * cosl(atan2l(b[1] - a[1], b[0] - a[0]) - s->near);
}

/* By the sine of the angle at the line's first node. */
static long double offset_of(const slow_strain *s, const long double *q) {
  const long double *p = q + 2 * s->node[0], *a = q + 2 * s->node[1], *b = q + 2 * s->node[2];
  return distance(a, p) * sinl(atan2l(p[1] - a[1], p[0] - a[0]) - atan2l(b[1] - a[1], b[0] - a[0]));
}

long double slow_strain_value(const slow_strain *s, const long double *q) {
  switch (s->kind) {
    case SLOW_PATH: return path_of(s, q);
    case SLOW_ANGLE: return angle_of(s, q);
    case SLOW_AREA: return area_of(s, q);
    case SLOW_REACH: return reach_of(s, q);
    case SLOW_ALONG: return along_of(s, q);
    case SLOW_OFFSET: return offset_of(s, q);
  }
  fail_msg("no such strain");
  return 0;
}

/* Along coordinate i, by differences of fourth order. */
static long double slope_along(const slow_strain *s, long double *q, size_t i) {
  const long double h = 1e-5L;
  long double at = q[i], f[4];
  for (int k = 0; k < 4; k++) {
    q[i] = at + h * (k < 2 ? k - 2 : k - 1);
    f[k] = slow_strain_value(s, q);
  }
  q[i] = at;
  return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h);
}

static void path_gradient(const slow_strain *s, const long double *q, long double *b) {
  memset(b, 0, 2 * s->count * sizeof *b);
  for (size_t k = 0; k + 1 < s->count; k++) {
    const long double *from = q + 2 * s->node[k], *to = q + 2 * s->node[k + 1];
    long double length = distance(from, to);
    for (size_t c = 0; c < 2 && length > 0; c++) {
      b[2 * k + c] -= (to[c] - from[c]) / length;
      b[2 * k + 2 + c] += (to[c] - from[c]) / length;
    }
  }
}

/* Where the nearest point is does not matter to first order, but bends where it comes to an end. */
void slow_strain_gradient(const slow_strain *strain, const long double *at, long double *b) {
  long double *q = (long double *)(uintptr_t)at; /* moved and put back */
  slow_strain held = *strain, *s = &held;
  if (s->kind == SLOW_PATH) {
    path_gradient(s, q, b);
    return;
  }
  if (s->kind == SLOW_REACH) held.held = true, held.share = share_of(strain, q);
  for (size_t k = 0; k < s->count; k++) {
    bool again = false;
    for (size_t j = 0; j < k; j++) again = again || s->node[j] == s->node[k];
    for (size_t c = 0; c < 2; c++)
      b[2 * k + c] = again ? 0 : slope_along(s, q, 2 * (size_t)s->node[k] + c);
  }
}

static long double force_of_table(const strut_law *law, long double x) {
  size_t n = law->count, i = 0;
  gsl_spline *spline = gsl_spline_alloc(law->smooth ? gsl_interp_steffen : gsl_interp_linear, n);
  assert_non_null(spline);
  gsl_spline_init(spline, law->x, law->force, n);
  double inside = fmin(fmax((double)x, law->x[0]), law->x[n - 1]);
  long double force = gsl_spline_eval(spline, inside, NULL);
  bool below = x < law->x[0];
  if (below || x > law->x[n - 1]) {
    i = below ? 0 : n - 1;
    long double slope =
        law->smooth ? (long double)gsl_spline_eval_deriv(spline, law->x[i], NULL)
                    : ((long double)law->force[below ? 1 : n - 1] - law->force[below ? 0 : n - 2]) /
                          ((long double)law->x[below ? 1 : n - 1] - law->x[below ? 0 : n - 2]);
    force = law->force[i] + slope * (x - law->x[i]);
  }
  gsl_spline_free(spline);
  return force;
}

long double slow_law_force(const strut_law *law, long double k, long double e, long double e0) {
  long double x = e - e0, size = fabsl(x), sign = x < 0 ? -1 : 1, sum = 0;
  switch (law->kind) {
    case STRUT_LAW_BILINEAR:
      if (size <= law->knee) return k * x;
      return sign * (k * law->knee + law->second_stiffness * (size - law->knee));
    case STRUT_LAW_PLAY: return size <= law->gap ? 0 : sign * k * (size - law->gap);
    case STRUT_LAW_POLYNOMIAL:
      for (size_t i = law->count; i-- > 0;) sum = (sum + law->force[i]) * x;
      return sum;
    case STRUT_LAW_LOGARITHMIC: return k * e0 * logl(e / e0);
    case STRUT_LAW_EXPONENTIAL: return k * law->scale * (expl(x / law->scale) - 1);
    case STRUT_LAW_TABLE: return force_of_table(law, x);
    case STRUT_LAW_LINEAR: return k * x;
    default: fail_msg("a law without memory is wanted here");
  }
  return 0;
}
