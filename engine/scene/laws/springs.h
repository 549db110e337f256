/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Springs of members and hinges, x = e - e0; see engine/scene/law.h. */
#pragma once

#include "engine/scene/laws/numbers.h"

/** Force k x. */
static inline strut_law_response strut_law_linear(const strut_law_numbers *n, double e, double e0,
                                                  int piece) {
  double x = e - e0, force = n->stiffness * x;
  (void)piece;
  return (strut_law_response){force, 0.5 * force * x, n->stiffness, 0.0};
}
STRUT_LAW_WITHOUT_KINKS(linear)

/** Force k x up to |x| = knee, and with the slope second_stiffness beyond, alike on both sides. */
static inline strut_law_response strut_law_bilinear(const strut_law_numbers *n, double e, double e0,
                                                    int piece) {
  double x = e - e0, knee = n->knee, k = n->stiffness;
  if (piece < 0) piece = x > knee ? 2 : x > -knee ? 1 : 0;
  if (piece == 1) return (strut_law_response){k * x, 0.5 * k * x * x, k, 0.0};
  double end = piece == 2 ? knee : -knee, beyond = x - end;
  return (strut_law_response){
      k * end + n->second_stiffness * beyond,
      0.5 * k * end * end + k * end * beyond + 0.5 * n->second_stiffness * beyond * beyond,
      n->second_stiffness, 0.0};
}
static inline int strut_law_bilinear_kinks(const strut_law_numbers *n) {
  (void)n;
  return 2;
}
static inline double strut_law_bilinear_kink(const strut_law_numbers *n, int k) {
  return k ? n->knee : -n->knee;
}

/** Free play: no force up to |x| = gap, and k (|x| - gap) towards the gap beyond. */
static inline strut_law_response strut_law_play(const strut_law_numbers *n, double e, double e0,
                                                int piece) {
  double x = e - e0, gap = n->gap;
  if (piece < 0) piece = x > gap ? 2 : x > -gap ? 1 : 0;
  if (piece == 1) return (strut_law_response){0.0, 0.0, 0.0, 0.0};
  double beyond = piece == 2 ? x - gap : x + gap, force = n->stiffness * beyond;
  return (strut_law_response){force, 0.5 * force * beyond, n->stiffness, 0.0};
}
static inline int strut_law_play_kinks(const strut_law_numbers *n) {
  (void)n;
  return 2;
}
static inline double strut_law_play_kink(const strut_law_numbers *n, int k) {
  return k ? n->gap : -n->gap;
}

/** Force c1 x + c2 x^2 + c3 x^3 + ... */
static inline strut_law_response strut_law_polynomial(const strut_law_numbers *n, double e,
                                                      double e0, int piece) {
  double x = e - e0, force = 0.0, energy = 0.0, slope = 0.0;
  (void)piece;
  for (size_t i = n->count; i-- > 0;) {
    double c = n->coefficient[i], order = (double)i + 1.0;
    force = force * x + c;
    energy = energy * x + c / (order + 1.0);
    slope = slope * x + c * order;
  }
  return (strut_law_response){force * x, energy * x * x, slope, 0.0};
}
STRUT_LAW_WITHOUT_KINKS(polynomial)

/** Force k s (exp(x / s) - 1), as of tissue, with the scale s. */
static inline strut_law_response strut_law_exponential(const strut_law_numbers *n, double e,
                                                       double e0, int piece) {
  double x = e - e0, s = n->scale, k = n->stiffness, growth = expm1(x / s);
  (void)piece;
  return (strut_law_response){k * s * growth, k * s * s * strut_law_exp_rest(x / s),
                              k * (growth + 1.0), 0.0};
}
STRUT_LAW_WITHOUT_KINKS(exponential)

/** Force k e0 ln(e / e0): linear in the logarithmic strain. e and e0 are above zero. */
static inline strut_law_response strut_law_logarithmic(const strut_law_numbers *n, double e,
                                                       double e0, int piece) {
  double u = (e - e0) / e0, strain = log1p(u), k = n->stiffness * e0;
  (void)piece;
  double excess = k * (2.0 * e0 * strut_law_log_rest(u) - (e - e0) * strain) / e0;
  return (strut_law_response){k * strain, k * e0 * strut_law_log_rest(u), k / e, excess};
}
STRUT_LAW_WITHOUT_KINKS(logarithmic)

/**
 * A spring in series with a slider that gives way at a force, beside a spring that hardens: k x until the
 * force reaches the yield, then with the slope second_stiffness, and back along k where x turns.
 *
 * That is a memory, which a function of e cannot have: this is the law before anything has yielded,
 * as statics take it. Runs shift e0 by what has yielded, see engine/forces/history.h.
 */
static inline strut_law_response strut_law_elastic_plastic(const strut_law_numbers *n, double e,
                                                           double e0, int piece) {
  return strut_law_linear(n, e, e0, piece);
}
STRUT_LAW_WITHOUT_KINKS(elastic_plastic)
