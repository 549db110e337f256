/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The laws of cells, of an area e with the pressure e0 as drawn; see engine/scene/law.h. */
#pragma once

#include "engine/scene/laws/numbers.h"

/*
 * What the laws of closed gases share: the pressure outside, and a finite force where next to no area is
 * left. There the law goes straight on, so that a step that went too far can be judged; a run stops.
 */

/** Share of the drawn area at which a cell counts as collapsed. */
#define STRUT_CELL_COLLAPSED 1e-3

/** A gas whose pressure as drawn is 1: pressure, energy from the drawn area on, -dp/de. */
typedef struct strut_gas {
  double pressure, energy, slope;
} strut_gas;

/** The area at which a gas in the area e is evaluated. */
static inline double strut_gas_area(const strut_law_numbers *n, double e) {
  double least = STRUT_CELL_COLLAPSED * n->area;
  return e > least ? e : least;
}

/** The law of the gas at strut_gas_area, straight on to e, with the pressure e0 as drawn. */
static inline strut_law_response strut_gas_response(const strut_law_numbers *n, double e, double e0,
                                                    strut_gas gas) {
  double beyond = e - strut_gas_area(n, e), pressure = gas.pressure - gas.slope * beyond;
  double energy = gas.energy - beyond * (gas.pressure - 0.5 * gas.slope * beyond);
  double force = n->outside - e0 * pressure;
  return (strut_law_response){force, e0 * energy + n->outside * (e - n->area), e0 * gas.slope,
                              energy};
}

/** A given pressure e0 [N/m], which pushes an area e outwards. */
static inline strut_law_response strut_law_pressure(const strut_law_numbers *n, double e, double e0,
                                                    int piece) {
  double grown = e - n->area;
  (void)piece;
  return (strut_law_response){-e0, -e0 * grown, 0.0, -grown};
}
STRUT_LAW_WITHOUT_KINKS(pressure)

/** A closed gas at constant temperature in an area e: p e = e0 area, with the pressure e0 as drawn. */
static inline strut_law_response strut_law_isothermal(const strut_law_numbers *n, double e,
                                                      double e0, int piece) {
  double at = strut_gas_area(n, e), p = n->area / at;
  (void)piece;
  return strut_gas_response(n, e, e0, (strut_gas){p, -n->area * log(at / n->area), p / at});
}
STRUT_LAW_WITHOUT_KINKS(isothermal)

/** A closed gas without exchange of heat in an area e: p e^exponent is constant, p = e0 as drawn. */
static inline strut_law_response strut_law_isentropic(const strut_law_numbers *n, double e,
                                                      double e0, int piece) {
  double at = strut_gas_area(n, e), k = n->exponent, shrunk = log(n->area / at);
  double p = exp(k * shrunk);
  (void)piece;
  return strut_gas_response(
      n, e, e0, (strut_gas){p, n->area * expm1((k - 1.0) * shrunk) / (k - 1.0), k * p / at});
}
STRUT_LAW_WITHOUT_KINKS(isentropic)

/** Rows as of STRUT_LAWS. No member and no hinge can have these laws. */
#define STRUT_CELL_LAWS(X, context)                                                                \
  X(PRESSURE, pressure, "pressure", 0, context)                                                    \
  X(ISOTHERMAL, isothermal, "isothermal", 0, context)                                              \
  X(ISENTROPIC, isentropic, "isentropic", 0, context)
