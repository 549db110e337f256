/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the figure of equilibria is made of.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_EQUILIBRIA_PARTS_H
#define STRUT_ENGINE_OUTPUT_FIGURES_EQUILIBRIA_PARTS_H

#include "engine/output/draw/structure.h"
#include "engine/statics/equilibria/equilibria.h"

/** Where an equilibrium is drawn: at rest on the real ground if it comes to rest as itself. */
const double *strut_drawn_shape(const strut_equilibria *all, size_t i);
/** Its energy there [J]. */
double strut_drawn_energy(const strut_equilibria *all, size_t i);

/** Levels of the states `chosen` (in their order from left to right) and the passes between them. */
strut_status strut_draw_ladder(strut_canvas *canvas, strut_box box, const strut_equilibria *all,
                               const size_t *chosen, size_t count);
/** Whether there is a pass between any two of them. */
bool strut_ladder_wanted(const strut_equilibria *all, const size_t *chosen, size_t count);

#endif
