/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Force k e0 ln(e / e0): linear in the logarithmic strain. e and e0 are above zero. */
#ifndef STRUT_ENGINE_SCENE_LAWS_LOGARITHMIC_H
#define STRUT_ENGINE_SCENE_LAWS_LOGARITHMIC_H

#include "engine/scene/laws/numbers.h"

static inline strut_law_response strut_law_logarithmic(const strut_law_numbers *n, double e,
                                                       double e0, int piece) {
  double u = (e - e0) / e0, strain = log1p(u), k = n->stiffness * e0;
  (void)piece;
  double excess = k * (2.0 * e0 * strut_law_log_rest(u) - (e - e0) * strain) / e0;
  return (strut_law_response){k * strain, k * e0 * strut_law_log_rest(u), k / e, excess};
}
STRUT_LAW_WITHOUT_KINKS(logarithmic)

#endif
