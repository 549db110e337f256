/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Names beside the nodes of a sketch: how wide they print, and where they hide least.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_SKETCH_NAMES_H
#define STRUT_ENGINE_OUTPUT_REPORT_SKETCH_NAMES_H

#include "engine/output/report/sketch_grid.h"

enum { STRUT_SKETCH_NAME = 14 };

/** A short text of known width. */
typedef struct strut_sketch_name {
  uint32_t code[STRUT_SKETCH_NAME];
  uint8_t width[STRUT_SKETCH_NAME]; /* columns of each: 1 or 2 */
  int count, columns;
} strut_sketch_name;

/**
 * Node `node`'s name (UTF-8), cut where it is long; or #1, #2, ... where a terminal may print it in
 * an unknown width or from right to left, and where it is not ASCII unless `unicode`.
 */
strut_sketch_name strut_sketch_name_of(const char *text, size_t node, bool unicode);
/** Appends " +3": so many more nodes are in the same place. */
void strut_sketch_name_more(strut_sketch_name *name, size_t more);
/** Writes it beside a cell, on empty cells, hiding one with dots at most; or nowhere. */
void strut_sketch_name_place(strut_sketch_grid *grid, int column, int row,
                             const strut_sketch_name *name);

#endif
