/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Force c1 x + c2 x^2 + c3 x^3 + ... */
#ifndef STRUT_ENGINE_SCENE_LAWS_POLYNOMIAL_H
#define STRUT_ENGINE_SCENE_LAWS_POLYNOMIAL_H

#include "engine/scene/laws/numbers.h"

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

#endif
