/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Force through points, by straight lines or by a monotone spline; straight on beyond the ends. */
#ifndef STRUT_ENGINE_SCENE_LAWS_TABLE_H
#define STRUT_ENGINE_SCENE_LAWS_TABLE_H

#include "engine/scene/laws/numbers.h"

/* Piece i of the curve, extended beyond its ends. */
static inline strut_law_response strut_law_curve_piece(const strut_law_curve *c, size_t i,
                                                       double x) {
  const double *p = c->piece[i];
  double d = x - c->x[i];
  return (strut_law_response){
      p[0] + d * (p[1] + d * (p[2] + d * p[3])),
      c->energy[i] + d * (p[0] + d * (p[1] / 2.0 + d * (p[2] / 3.0 + d * p[3] / 4.0))),
      p[1] + d * (2.0 * p[2] + d * 3.0 * p[3]), 0.0};
}

static inline strut_law_response strut_law_table(const strut_law_numbers *n, double e, double e0,
                                                 int piece) {
  const strut_law_curve *c = n->curve;
  double x = e - e0;
  size_t low = 0, high = c->count - 1;
  if (piece >= 0 && !c->smooth) return strut_law_curve_piece(c, (size_t)piece, x);
  if (x < c->x[0] || x > c->x[high]) {
    size_t end = x < c->x[0] ? 0 : high;
    strut_law_response r = strut_law_curve_piece(c, end ? end - 1 : 0, c->x[end]);
    double beyond = x - c->x[end];
    return (strut_law_response){r.force + r.slope * beyond,
                                r.energy + beyond * (r.force + 0.5 * r.slope * beyond), r.slope,
                                0.0};
  }
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    *(c->x[middle] <= x ? &low : &high) = middle;
  }
  return strut_law_curve_piece(c, low, x);
}
static inline int strut_law_table_kinks(const strut_law_numbers *n) {
  return n->curve->smooth ? 0 : (int)n->curve->count - 2;
}
static inline double strut_law_table_kink(const strut_law_numbers *n, int k) {
  return n->curve->x[k + 1];
}

#endif
