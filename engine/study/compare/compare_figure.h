/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Pictures of what is compared: each by itself, and all on one sheet.
 */
#ifndef STRUT_ENGINE_STUDY_COMPARE_COMPARE_FIGURE_H
#define STRUT_ENGINE_STUDY_COMPARE_COMPARE_FIGURE_H

#include "engine/study/compare/compare.h"

/**
 * Draws the structures [first, first + count) of a comparison into the file `path`, `width` [pt] wide:
 * each in the shape in which it stands, members by kind, driven ones marked, its name and a few of its
 * numbers above. All to one scale unless some are more than four times as large as others; a rod tells
 * it. Fails as strut_canvas_open and strut_canvas_commit; STRUT_NO_MEMORY.
 */
STRUT_API strut_status strut_compare_figure(const char *path, double width,
                                            const strut_compare *result, size_t first, size_t count,
                                            strut_error *error);

#endif
