/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figure of form finding: what was drawn in grey, what holds over it, coloured by force.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_FORM_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_FORM_FIGURE_H

#include "engine/model/model.h"

/**
 * Draws it into the file `path`, `width` [pt] wide. `model` is that of the new scene, which starts
 * where it holds; drawn (node_count) are the positions before [m]. Fails as strut_canvas_open and
 * strut_canvas_commit.
 */
STRUT_API strut_status strut_form_figure(const char *path, double width, const strut_model *model,
                                         const double (*drawn)[2], strut_error *error);

#endif
