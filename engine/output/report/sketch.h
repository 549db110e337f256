/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A structure in a few lines of text, true to scale, so that a wrong coordinate is seen at once.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_SKETCH_H
#define STRUT_ENGINE_OUTPUT_REPORT_SKETCH_H

#include "engine/model/model.h"

enum { STRUT_SKETCH_LEAST_COLUMNS = 20, STRUT_SKETCH_LEAST_ROWS = 5, STRUT_SKETCH_MOST = 400 };

/**
 * Draws the shape q (model->length) in at most `columns` by `rows` character cells, each taken to
 * be twice as high as wide, and a line with its extent: bars solid, springs and cables dotted, nodes
 * with their names where these fit, supports, and the ground where it is near. Braille dots in
 * UTF-8 if `unicode`, else ASCII. Names that a terminal may not print from left to right in a known width
 * are replaced by the node's number, #1 for the first. Lines end with '\n' and without blanks. A
 * block of strut_allocate; NULL when memory is out.
 */
STRUT_API char *strut_sketch(const strut_model *model, const double *q, int columns, int rows,
                             bool unicode);

#endif
