/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figures of statics: equilibria, forms, modes, paths, rigidity. Each writes the file `path` (SVG, PDF or
 * PNG by its ending), `width` [pt] wide, and fails as strut_canvas_open and strut_canvas_commit, or with
 * STRUT_NO_MEMORY.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_STATICS_FIGURES_H
#define STRUT_ENGINE_OUTPUT_FIGURES_STATICS_FIGURES_H

#include "engine/model/model.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/path/path.h"
#include "engine/statics/rigidity/rigidity.h"

/** Draws it into the file `path`, `width` [pt] wide; fails as strut_canvas_open and _commit. */
STRUT_API strut_status strut_equilibria_figure(const char *path, double width,
                                               const strut_model *model,
                                               const strut_equilibria *equilibria,
                                               strut_error *error);

/**
 * Draws it into the file `path`, `width` [pt] wide. `model` is that of the new scene, which starts
 * where it holds; drawn (node_count) are the positions before [m]. Fails as strut_canvas_open and
 * strut_canvas_commit.
 */
STRUT_API strut_status strut_form_figure(const char *path, double width, const strut_model *model,
                                         const double (*drawn)[2], strut_error *error);

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

/**
 * Draws the shape q (length), called `at`, into the file `path`, `width` [pt] wide: its forces if it
 * has any, then states of self-stress, then mechanisms, a panel each, as many as fit in four rows.
 * Fails as strut_canvas_open and strut_canvas_commit.
 */
STRUT_API strut_status strut_rigidity_figure(const char *path, double width,
                                             const strut_model *model, const double *q,
                                             const char *at, const strut_rigidity *rigidity,
                                             strut_error *error);

#endif
