/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The way of a taut cable over guides that are circles: straight along common tangents, and round the circles in
 * between. A guide that the cable would have to be pulled round is left aside: it unwraps there, and wraps again.
 *
 * Each circle stands to the left or to the right of the cable, as it is followed from its first node to its last.
 * Where it touches, the arc is up to three quarters of a turn. Length and slope of the length are continuous where
 * the cable unwraps.
 */
#pragma once

#include <assert.h>
#include <math.h>
#include <stdint.h>

enum { STRUT_MOST_WRAPPED = 32 };

/** Its straight segments, from touched node k to the next one. */
typedef struct strut_wrap {
  int count;                       /* touched nodes, the ends among them */
  int node[STRUT_MOST_WRAPPED];    /* (count) their places along the cable */
  double ux[STRUT_MOST_WRAPPED];   /* (count - 1) direction */
  double uy[STRUT_MOST_WRAPPED];   /* */
  double free[STRUT_MOST_WRAPPED]; /* (count - 1) length of the tangent [m] */
} strut_wrap;

/** -1 where the centre of guide k (1 is the first) is to the right of the cable, else 1. */
static inline double strut_wrap_side(uint32_t right, int k) { return right >> k & 1 ? -1.0 : 1.0; }

/** Segment k of w, and by how far the circles at its ends are apart across it. */
static inline void strut_wrap_lay(strut_wrap *wrap, int k, const double (*p)[2], int n,
                                  uint32_t right, double radius) {
  int a = wrap->node[k], b = wrap->node[k + 1];
  double x = p[b][0] - p[a][0], y = p[b][1] - p[a][1], square = x * x + y * y;
  double before = a > 0 ? strut_wrap_side(right, a) : 0.0;
  double behind = b < n - 1 ? strut_wrap_side(right, b) : 0.0;
  double across = radius * (behind - before), rest = square - across * across;
  double along = rest > 0.0 ? sqrt(rest) : 0.0, inverse = square > 0.0 ? 1.0 / square : 0.0;
  wrap->free[k] = along;
  wrap->ux[k] = (along * x + across * y) * inverse,
  wrap->uy[k] = (along * y - across * x) * inverse;
}

/** Angle by which the cable winds round touched node k; slightly negative where it would have to be pulled round. */
static inline double strut_wrap_turn(const strut_wrap *wrap, int k, uint32_t right) {
  double cross = wrap->ux[k - 1] * wrap->uy[k] - wrap->uy[k - 1] * wrap->ux[k];
  double turn = strut_wrap_side(right, wrap->node[k]) *
                atan2(cross, wrap->ux[k - 1] * wrap->ux[k] + wrap->uy[k - 1] * wrap->uy[k]);
  return turn < -1.5707963267948966 ? turn + 6.283185307179586 : turn;
}

/**
 * The way over points p (n), of which those in between are centres of circles; `right`: bit k where guide k is to the
 * right. Returns its length [m].
 */
static inline double strut_wrap_find(const double (*p)[2], int n, uint32_t right, double radius,
                                     strut_wrap *wrap) {
  double sum = 0.0;
  assert(n >= 2 && n <= STRUT_MOST_WRAPPED);
  wrap->count = n;
  for (int k = 0; k < n; k++) wrap->node[k] = k;
  for (int k = 0; k + 1 < n; k++) strut_wrap_lay(wrap, k, p, n, right, radius);
  while (wrap->count > 2) { /* leave aside the guide that it is pulled round the most */
    int worst = 0;
    double least = 0.0;
    for (int k = 1; k + 1 < wrap->count; k++) {
      double turn = strut_wrap_turn(wrap, k, right);
      if (turn < least) least = turn, worst = k;
    }
    if (!worst) break;
    wrap->count--;
    for (int k = worst; k < wrap->count; k++) wrap->node[k] = wrap->node[k + 1];
    for (int k = worst; k + 1 < wrap->count; k++)
      wrap->ux[k] = wrap->ux[k + 1], wrap->uy[k] = wrap->uy[k + 1],
      wrap->free[k] = wrap->free[k + 1];
    strut_wrap_lay(wrap, worst - 1, p, n, right, radius);
  }
  for (int k = 0; k + 1 < wrap->count; k++) sum += wrap->free[k];
  for (int k = 1; k + 1 < wrap->count; k++) sum += radius * strut_wrap_turn(wrap, k, right);
  return sum;
}
