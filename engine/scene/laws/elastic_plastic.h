/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A spring in series with a slider that gives way at a force, beside a spring that hardens: k x until the
 * force reaches the yield, then with the slope second_stiffness, and back along k where x turns.
 *
 * That is a memory, which a function of e cannot have: this header is the law before anything has yielded,
 * as statics take it. Runs shift e0 by what has yielded, see engine/forces/history.h.
 */
#ifndef STRUT_ENGINE_SCENE_LAWS_ELASTIC_PLASTIC_H
#define STRUT_ENGINE_SCENE_LAWS_ELASTIC_PLASTIC_H

#include "engine/scene/laws/linear.h"

static inline strut_law_response strut_law_elastic_plastic(const strut_law_numbers *n, double e,
                                                           double e0, int piece) {
  return strut_law_linear(n, e, e0, piece);
}
STRUT_LAW_WITHOUT_KINKS(elastic_plastic)

#endif
