/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A grid of character cells to draw on: dots, eight to a cell, and letters over them.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_SKETCH_GRID_H
#define STRUT_ENGINE_OUTPUT_REPORT_SKETCH_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/output/buffer.h"

/** Letters that are marks; in ASCII others stand for them. In the order of their codes. */
enum {
  STRUT_SKETCH_GROUND = 0x2594, /* a line at the upper edge of its cell */
  STRUT_SKETCH_HELD = 0x25b2,
  STRUT_SKETCH_HELD_IN_Y = 0x25b3,
  STRUT_SKETCH_HELD_IN_X = 0x25b7,
  STRUT_SKETCH_NODE = 0x25cf
};

/** Dots are counted from the upper left: two columns and four rows of them in every cell. */
typedef struct strut_sketch_grid {
  int columns, rows;
  uint8_t *dots;    /* (rows, columns) which of the eight are set, as in U+2800 + dots */
  uint32_t *letter; /* (rows, columns) code point over the dots; 0: none; 1: right half of one */
} strut_sketch_grid;

/** Takes its memory; false when there is none. */
bool strut_sketch_grid_create(strut_sketch_grid *grid, int columns, int rows);
void strut_sketch_grid_free(strut_sketch_grid *grid);
/** Sets a dot; none outside. */
void strut_sketch_dot(strut_sketch_grid *grid, int x, int y);
/** Dots from one place to another: `ink` of them, then `gap` left out; gap 0 is solid. */
void strut_sketch_line(strut_sketch_grid *grid, const double from[2], const double to[2], int ink,
                       int gap);
/** Whether a cell is in the grid. */
bool strut_sketch_inside(const strut_sketch_grid *grid, int column, int row);
/** Puts a letter of one or two columns into a cell that is inside. */
void strut_sketch_letter(strut_sketch_grid *grid, int column, int row, uint32_t code, int width);
/** Appends the lines, without blank ones above and below: Braille, or what ASCII comes near it. */
void strut_sketch_grid_write(const strut_sketch_grid *grid, bool unicode, const char *indent,
                             strut_buffer *buffer);
/** Appends one letter: in UTF-8, or in ASCII where it is a mark and not `unicode`. */
void strut_sketch_put(strut_buffer *buffer, uint32_t code, bool unicode);

#endif
