/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the laws of closed gases share: the pressure outside, and a finite force where next to no area is
 * left. There the law goes straight on, so that a step that went too far can be judged; a run stops.
 */
#ifndef STRUT_ENGINE_SCENE_LAWS_GAS_H
#define STRUT_ENGINE_SCENE_LAWS_GAS_H

#include "engine/scene/laws/numbers.h"

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
                              energy + force};
}

#endif
