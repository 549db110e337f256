/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Numbers of twice a double's length: an unevaluated sum hi + lo, good to about 32 digits.
 *
 * Sums and products after Dekker (1971) and Knuth, made of plain doubles, so that every compiler
 * gives the same bits as long as it neither contracts nor reorders.
 */
#pragma once

#include <math.h>

typedef struct strut_dd {
  double hi, lo; /* |lo| <= half of the last bit of hi */
} strut_dd;

static inline strut_dd dd_of(double a) { return (strut_dd){a, 0.0}; }

/** a + b exactly. */
static inline strut_dd dd_sum(double a, double b) {
  double s = a + b, c = s - a;
  return (strut_dd){s, (a - (s - c)) + (b - c)};
}

/** The same where |a| >= |b|. */
static inline strut_dd dd_quick_sum(double a, double b) {
  double s = a + b;
  return (strut_dd){s, b - (s - a)};
}

/** a * b exactly, away from overflow and underflow. */
static inline strut_dd dd_product(double a, double b) {
  const double split = 134217729.0; /* 2^27 + 1 */
  double p = a * b, x = split * a, y = split * b;
  double ah = x - (x - a), al = a - ah, bh = y - (y - b), bl = b - bh;
  return (strut_dd){p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

static inline strut_dd dd_add(strut_dd a, strut_dd b) {
  strut_dd s = dd_sum(a.hi, b.hi), t = dd_sum(a.lo, b.lo);
  s = dd_quick_sum(s.hi, s.lo + t.hi);
  return dd_quick_sum(s.hi, s.lo + t.lo);
}

static inline strut_dd dd_negative(strut_dd a) { return (strut_dd){-a.hi, -a.lo}; }
static inline strut_dd dd_sub(strut_dd a, strut_dd b) { return dd_add(a, dd_negative(b)); }

static inline strut_dd dd_mul(strut_dd a, strut_dd b) {
  strut_dd p = dd_product(a.hi, b.hi);
  return dd_quick_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

static inline strut_dd dd_scale(strut_dd a, double b) {
  strut_dd p = dd_product(a.hi, b);
  return dd_quick_sum(p.hi, p.lo + a.lo * b);
}

static inline strut_dd dd_div(strut_dd a, strut_dd b) {
  double q = a.hi / b.hi;
  strut_dd r = dd_sub(a, dd_scale(b, q));
  double q2 = r.hi / b.hi;
  r = dd_sub(r, dd_scale(b, q2));
  strut_dd sum = dd_quick_sum(q, q2);
  return dd_add(sum, dd_of(r.hi / b.hi));
}

/** Square root of a >= 0: one step of Newton's method from a double's. */
static inline strut_dd dd_sqrt(strut_dd a) {
  if (!(a.hi > 0)) return dd_of(0.0);
  double x = sqrt(a.hi);
  strut_dd rest = dd_sub(a, dd_product(x, x));
  return dd_quick_sum(x, rest.hi / (2.0 * x));
}

/** Length of the vector (x, y). */
static inline strut_dd dd_length(strut_dd x, strut_dd y) {
  return dd_sqrt(dd_add(dd_mul(x, x), dd_mul(y, y)));
}

static inline double dd_double(strut_dd a) { return a.hi + a.lo; }

/*
 * Numbers below 2.3e-308 count as zero between these two calls, on processors that are slow with
 * them (x86: 100 cycles and more for each). Other results keep their bits. The mode is the thread's:
 * no one else's code may run in between.
 */

#if defined(__SSE2__)
#include <xmmintrin.h>

/** The mode, for strut_subnormals_restore in another thread. */
static inline unsigned strut_subnormals_mode(void) { return _mm_getcsr(); }

/** The mode before, for strut_subnormals_restore. */
static inline unsigned strut_subnormals_off(void) {
  unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040u); /* results are flushed to zero, operands are taken as zero */
  return before;
}

/** Only the two bits of it: exceptions that were raised in between stay raised. */
static inline void strut_subnormals_restore(unsigned before) {
  _mm_setcsr((_mm_getcsr() & ~0x8040u) | (before & 0x8040u));
}

#else

static inline unsigned strut_subnormals_mode(void) { return 0; }
static inline unsigned strut_subnormals_off(void) { return 0; }
static inline void strut_subnormals_restore(unsigned before) { (void)before; }

#endif
