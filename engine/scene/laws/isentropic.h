/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A closed gas without exchange of heat in an area e: p e^exponent is constant, p = e0 as drawn. */
#ifndef STRUT_ENGINE_SCENE_LAWS_ISENTROPIC_H
#define STRUT_ENGINE_SCENE_LAWS_ISENTROPIC_H

#include "engine/scene/laws/gas.h"

static inline strut_law_response strut_law_isentropic(const strut_law_numbers *n, double e,
                                                      double e0, int piece) {
  double at = strut_gas_area(n, e), k = n->exponent, shrunk = log(n->area / at);
  double p = exp(k * shrunk);
  (void)piece;
  return strut_gas_response(
      n, e, e0, (strut_gas){p, n->area * expm1((k - 1.0) * shrunk) / (k - 1.0), k * p / at});
}
STRUT_LAW_WITHOUT_KINKS(isentropic)

#endif
