/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Force k x up to |x| = knee (`first`), and with the slope `second` beyond, alike on both sides. */
#ifndef STRUT_ENGINE_SCENE_LAWS_BILINEAR_H
#define STRUT_ENGINE_SCENE_LAWS_BILINEAR_H

#include "engine/scene/laws/numbers.h"

static inline strut_law_response strut_law_bilinear(const strut_law_numbers *n, double e, double e0,
                                                    int piece) {
  double x = e - e0, knee = n->first, k = n->stiffness;
  if (piece < 0) piece = x > knee ? 2 : x > -knee ? 1 : 0;
  if (piece == 1) return (strut_law_response){k * x, 0.5 * k * x * x, k, 0.0};
  double end = piece == 2 ? knee : -knee, beyond = x - end;
  return (strut_law_response){
      k * end + n->second * beyond,
      0.5 * k * end * end + k * end * beyond + 0.5 * n->second * beyond * beyond, n->second, 0.0};
}
static inline int strut_law_bilinear_kinks(const strut_law_numbers *n) {
  (void)n;
  return 2;
}
static inline double strut_law_bilinear_kink(const strut_law_numbers *n, int k) {
  return k ? n->first : -n->first;
}

#endif
