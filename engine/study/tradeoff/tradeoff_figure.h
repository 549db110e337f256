/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The work-precision diagram of a tradeoff: step errors by method, and total errors by model.
 */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_TRADEOFF_FIGURE_H
#define STRUT_ENGINE_STUDY_TRADEOFF_TRADEOFF_FIGURE_H

#include "engine/study/tradeoff/tradeoff.h"

/**
 * Draws it into the file `path`, `width` [pt] wide. Over several operating points a marker is the
 * median and a bar leads to the worst. As strut_canvas_open and strut_canvas_commit.
 */
STRUT_API strut_status strut_tradeoff_figure(const char *path, double width,
                                             const strut_tradeoff *result, strut_error *error);

#endif
