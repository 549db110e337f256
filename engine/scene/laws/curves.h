/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Laws through points: tables, and curves that may fold back; see engine/scene/law.h. */
#pragma once

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

/** Force through points, by straight lines or by a monotone spline; straight on beyond the ends. */
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

/*
 * Force over elongation along a curve of pieces that may fold back. Where x falls along it, nothing holds an
 * element in place; one that reaches a fold jumps to the next piece along which x grows.
 *
 * Which of several pieces holds at an x is a memory. Alone, this law starts from the piece at x = 0; runs
 * and paths give the piece, see engine/forces/history.h. The rule that folds turn with falling force is that
 * of a potential over x and a place t on the curve, which is stable in t where x grows with t:
 * U = int F dx + F (x - x(t)) + k(t)/2 (x - x(t))^2 with k x' > F', which needs F' < 0 where x' = 0.
 */

/** Does x grow (1) or fall (-1) along piece i, 0 <= i < count - 1? */
static inline int strut_folding_way(const strut_law_curve *c, int i) {
  return c->x[i + 1] > c->x[i] ? 1 : -1;
}

/** Is x beyond the end (1) or the begin (-1) of piece i? 0: it lies on it. */
static inline int strut_folding_beyond(const strut_law_curve *c, int i, double x) {
  double way = strut_folding_way(c, i);
  if (i > 0 && way * (x - c->x[i]) < 0.0) return -1;
  return i + 2 < (int)c->count && way * (x - c->x[i + 1]) > 0.0 ? 1 : 0;
}

/**
 * The piece that one goes to from piece i over its end (way 1) or its begin (way -1) at x: the next one or,
 * where that folds back, the next stable one with this x. The first and the last piece have no end.
 */
static inline int strut_folding_pass(const strut_law_curve *c, int i, int way, double x) {
  int to = i + way;
  if (strut_folding_way(c, to) > 0) return to;
  while (strut_folding_way(c, to) < 0 || strut_folding_beyond(c, to, x) == way) to += way;
  return to;
}

/**
 * The stable piece on which x lies for one who comes from piece i; `freed` grows by the energy that jumps at
 * folds set free on the way, unless it is NULL.
 */
static inline int strut_folding_follow(const strut_law_curve *c, int i, double x, double *freed) {
  for (int way; (way = strut_folding_beyond(c, i, x)) != 0;) {
    double end = c->x[way > 0 ? i + 1 : i];
    int to = strut_folding_pass(c, i, way, end);
    if (freed && to != i + way)
      *freed += strut_law_curve_piece(c, (size_t)i, end).energy -
                strut_law_curve_piece(c, (size_t)to, end).energy;
    i = to;
  }
  return i;
}

static inline strut_law_response strut_law_folding(const strut_law_numbers *n, double e, double e0,
                                                   int piece) {
  const strut_law_curve *c = n->curve;
  if (piece < 0) piece = strut_folding_follow(c, c->start, e - e0, NULL);
  return strut_law_curve_piece(c, (size_t)piece, e - e0);
}
static inline int strut_law_folding_kinks(const strut_law_numbers *n) {
  return (int)n->curve->count - 2;
}
static inline double strut_law_folding_kink(const strut_law_numbers *n, int k) {
  return n->curve->x[k + 1];
}
