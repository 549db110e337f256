/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Natural modes as a picture: for each of the lowest ones the shape at rest and displaced. */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_MODES_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_MODES_FIGURE_H

#include "engine/statics/modes/modes.h"

/** Default number of panels, and the largest. */
enum { STRUT_MODES_FIGURE_PANELS = 6, STRUT_MODES_FIGURE_MOST = 24 };

/** The largest displacement of a node as drawn, in units of the structure's larger extent. */
#define STRUT_MODES_FIGURE_SWING 0.08

/**
 * Draws the lowest `panels` modes (0: STRUT_MODES_FIGURE_PANELS) into the file `path`, `width` [pt]
 * wide; all to one scale. Rigid-body motions are left out where there are others, and counted below.
 * In each panel the shape at rest is grey and the displaced shape coloured by the members' strains,
 * relative to the largest in that mode; arrows join both where nodes are few. Fails as strut_canvas_open and strut_canvas_commit; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_modes_figure(const char *path, double width, const strut_model *model,
                                          const strut_modes *modes, size_t panels,
                                          strut_error *error);

#endif
