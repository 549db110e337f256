/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The energy ladder: stable states as levels, with the barriers between them. */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_ENERGY_LADDER_H
#define STRUT_ENGINE_OUTPUT_FIGURES_ENERGY_LADDER_H

#include "engine/output/draw/figure.h"
#include "engine/statics/equilibria/equilibria.h"

/** True if there are barriers between some of the (count) chosen equilibria. */
bool strut_ladder_wanted(const strut_equilibria *all, const size_t *chosen, size_t count);
/** Adds a panel with them as levels in the order given, and the barriers between them. */
strut_panel *strut_add_ladder(strut_figure *figure, const strut_equilibria *all,
                              const size_t *chosen, size_t count);

#endif
