/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Force k e0 ln(e / e0): linear in the logarithmic strain. e and e0 are above zero. */
#ifndef STRUT_ENGINE_SCENE_LAWS_LOGARITHMIC_H
#define STRUT_ENGINE_SCENE_LAWS_LOGARITHMIC_H

#include "engine/scene/laws/numbers.h"

static inline strut_law_response strut_law_logarithmic(const strut_law_numbers *n, double e,
                                                       double e0, int piece) {
  double strain = log1p((e - e0) / e0), k = n->stiffness * e0;
  (void)piece;
  double excess = n->stiffness * ((e + e0) * strain - 2.0 * (e - e0));
  return (strut_law_response){k * strain, k * (e * strain - (e - e0)), k / e, excess};
}
STRUT_LAW_WITHOUT_KINKS(logarithmic)

#endif
