/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Force k x. */
#ifndef STRUT_ENGINE_SCENE_LAWS_LINEAR_H
#define STRUT_ENGINE_SCENE_LAWS_LINEAR_H

#include "engine/scene/laws/numbers.h"

static inline strut_law_response strut_law_linear(const strut_law_numbers *n, double e, double e0,
                                                  int piece) {
  double x = e - e0, force = n->stiffness * x;
  (void)piece;
  return (strut_law_response){force, 0.5 * force * x, n->stiffness, 0.0};
}
STRUT_LAW_WITHOUT_KINKS(linear)

#endif
