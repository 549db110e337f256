/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Force k s (exp(x / s) - 1), as of tissue, with the scale s (`first`). */
#ifndef STRUT_ENGINE_SCENE_LAWS_EXPONENTIAL_H
#define STRUT_ENGINE_SCENE_LAWS_EXPONENTIAL_H

#include "engine/scene/laws/numbers.h"

static inline strut_law_response strut_law_exponential(const strut_law_numbers *n, double e,
                                                       double e0, int piece) {
  double x = e - e0, s = n->first, k = n->stiffness, growth = expm1(x / s);
  (void)piece;
  return (strut_law_response){k * s * growth, k * s * (s * growth - x), k * (growth + 1.0), 0.0};
}
STRUT_LAW_WITHOUT_KINKS(exponential)

#endif
