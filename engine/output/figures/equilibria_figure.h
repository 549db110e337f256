/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figure of all equilibria: those that stand, true to scale; the passes between them; what was set
 * aside.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_EQUILIBRIA_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_EQUILIBRIA_FIGURE_H

#include "engine/statics/equilibria/equilibria.h"

/** Draws it into the file `path`, `width` [pt] wide; fails as strut_canvas_open and _commit. */
STRUT_API strut_status strut_equilibria_figure(const char *path, double width,
                                               const strut_model *model,
                                               const strut_equilibria *equilibria,
                                               strut_error *error);

#endif
