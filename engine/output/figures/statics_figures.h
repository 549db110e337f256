/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figures of statics: equilibria, forms, modes, paths, rigidity. Each writes the file of its plot and
 * fails as strut_canvas_open and strut_canvas_commit, or with STRUT_NO_MEMORY.
 */
#pragma once

#include "engine/model/model.h"
#include "engine/output/draw/chart.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/modes/waves.h"
#include "engine/statics/path/path.h"
#include "engine/statics/rigidity/rigidity.h"

/** Draws the equilibria that stand as cards, their energies with barriers, and the others small. */
STRUT_API strut_status strut_equilibria_figure(const strut_plot *plot, const strut_model *model,
                                               const strut_equilibria *equilibria,
                                               strut_error *error);

/**
 * The found form coloured by force over the drawn one in grey. `model` is that of the found scene;
 * drawn (node_count) are the original positions [m].
 */
STRUT_API strut_status strut_form_figure(const strut_plot *plot, const strut_model *model,
                                         const double (*drawn)[2], strut_error *error);

/** Default number of panels, and the largest. */
enum { STRUT_MODES_FIGURE_PANELS = 6, STRUT_MODES_FIGURE_MOST = 24 };

/** The largest displacement of a node as drawn, in units of the structure's larger extent. */
#define STRUT_MODES_FIGURE_SWING 0.08

/**
 * The lowest `panels` modes (0: STRUT_MODES_FIGURE_PANELS) to one scale. Rigid-body motions are
 * omitted where there are other modes, and counted in the key. In each panel the shape at rest is
 * grey and the displaced shape coloured by the members' strains, relative to the largest in that
 * mode; arrows join both where nodes are few.
 */
STRUT_API strut_status strut_modes_figure(const strut_plot *plot, const strut_model *model,
                                          const strut_modes *modes, size_t panels,
                                          strut_error *error);

/** Frequencies over the line through the zone of phases, gaps between bands in grey. */
STRUT_API strut_status strut_waves_figure(const strut_plot *plot, const strut_model *model,
                                          const strut_waves *waves, strut_error *error);

/**
 * The load factor over the displacement of the coordinate of a loaded node that moves farthest,
 * positive in its direction; dashed where the equilibrium is unstable. Events are marked with
 * letters and drawn as shapes, dark to bright, with start and end; small displacements are enlarged
 * by a round factor given in the key.
 */
STRUT_API strut_status strut_path_figure(const strut_plot *plot, const strut_model *model,
                                         const strut_path *path, strut_error *error);

/**
 * The shape q (length), called `at`, in panels: its forces if it has any, then states of
 * self-stress, then mechanisms, as many as fit in four rows.
 */
STRUT_API strut_status strut_rigidity_figure(const strut_plot *plot, const strut_model *model,
                                             const double *positions, const char *at,
                                             const strut_rigidity *rigidity, strut_error *error);
