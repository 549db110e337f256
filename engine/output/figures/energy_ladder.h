/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The energy ladder of the figure of equilibria. */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_ENERGY_LADDER_H
#define STRUT_ENGINE_OUTPUT_FIGURES_ENERGY_LADDER_H

#include "engine/base/memory.h"
#include "engine/output/draw/canvas.h"
#include "engine/statics/equilibria/equilibria.h"

/** True if there are barriers between some of the (count) chosen equilibria. */
bool strut_ladder_wanted(const strut_equilibria *all, const size_t *chosen, size_t count);
/** Draws them as levels in the order given, with the barriers between them. STRUT_NO_MEMORY. */
strut_status strut_ladder_draw(strut_canvas *canvas, strut_box box, const strut_equilibria *all,
                               const size_t *chosen, size_t count);

#endif
