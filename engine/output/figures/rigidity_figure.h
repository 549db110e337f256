/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figure of what holds and what moves: forces in the shape, states of self-stress, mechanisms.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_RIGIDITY_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_RIGIDITY_FIGURE_H

#include "engine/statics/rigidity/rigidity.h"

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
