/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A given pressure e0 [N/m], which pushes an area e outwards. */
#ifndef STRUT_ENGINE_SCENE_LAWS_PRESSURE_H
#define STRUT_ENGINE_SCENE_LAWS_PRESSURE_H

#include "engine/scene/laws/numbers.h"

static inline strut_law_response strut_law_pressure(const strut_law_numbers *n, double e, double e0,
                                                    int piece) {
  double grown = e - n->area;
  (void)piece;
  return (strut_law_response){-e0, -e0 * grown, 0.0, -grown - e0};
}
STRUT_LAW_WITHOUT_KINKS(pressure)

#endif
