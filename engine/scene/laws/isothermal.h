/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A closed gas at constant temperature in an area e: p e = e0 area, with the pressure e0 as drawn. */
#ifndef STRUT_ENGINE_SCENE_LAWS_ISOTHERMAL_H
#define STRUT_ENGINE_SCENE_LAWS_ISOTHERMAL_H

#include "engine/scene/laws/gas.h"

static inline strut_law_response strut_law_isothermal(const strut_law_numbers *n, double e,
                                                      double e0, int piece) {
  double at = strut_gas_area(n, e), p = n->area / at;
  (void)piece;
  return strut_gas_response(n, e, e0, (strut_gas){p, -n->area * log(at / n->area), p / at});
}
STRUT_LAW_WITHOUT_KINKS(isothermal)

#endif
