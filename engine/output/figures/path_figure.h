/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A path of equilibria as a picture: the load over what it moves, and the shapes on the way.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_PATH_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_PATH_FIGURE_H

#include "engine/statics/path/path.h"

/**
 * Draws the path into the file `path_name`, `width` [pt] wide. The curve is the load's factor over
 * the motion from the beginning of that coordinate of a loaded node which moves farthest, counted
 * positive the way it goes; dashed where the equilibrium is unstable. Events are marked with
 * letters, and drawn as shapes from dark to bright with the beginning and the end; motion too small
 * to be seen is drawn larger, by a round factor which the key gives. Fails as strut_canvas_open and
 * strut_canvas_commit; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_path_figure(const char *path_name, double width,
                                         const strut_model *model, const strut_path *path,
                                         strut_error *error);

#endif
