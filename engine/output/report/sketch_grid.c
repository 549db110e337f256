/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/sketch_grid.h"

#include <math.h>

#include "engine/base/memory.h"

enum { ACROSS = 2, DOWN = 4, RIGHT_HALF = 1 };

/* Braille's bits: row by row in each of the two columns. */
static const uint8_t bits[DOWN][ACROSS] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};

bool strut_sketch_grid_create(strut_sketch_grid *grid, int columns, int rows) {
  size_t cells = (size_t)columns * (size_t)rows;
  *grid = (strut_sketch_grid){.columns = columns, .rows = rows};
  grid->dots = strut_allocate(cells, sizeof *grid->dots);
  grid->letter = strut_allocate(cells, sizeof *grid->letter);
  return grid->dots && grid->letter;
}

void strut_sketch_grid_free(strut_sketch_grid *grid) {
  strut_release(grid->dots);
  strut_release(grid->letter);
  *grid = (strut_sketch_grid){0};
}

static size_t cell_at(const strut_sketch_grid *grid, int column, int row) {
  return (size_t)row * (size_t)grid->columns + (size_t)column;
}

bool strut_sketch_inside(const strut_sketch_grid *grid, int column, int row) {
  return column >= 0 && column < grid->columns && row >= 0 && row < grid->rows;
}

void strut_sketch_dot(strut_sketch_grid *grid, int x, int y) {
  if (x < 0 || y < 0 || !strut_sketch_inside(grid, x / ACROSS, y / DOWN)) return;
  grid->dots[cell_at(grid, x / ACROSS, y / DOWN)] |= bits[y % DOWN][x % ACROSS];
}

void strut_sketch_line(strut_sketch_grid *grid, const double from[2], const double to[2], int ink,
                       int gap) {
  double width = to[0] - from[0], height = to[1] - from[1];
  int steps = (int)ceil(fmax(fabs(width), fabs(height)));
  for (int i = 0; i <= steps; i++) {
    double part = steps > 0 ? (double)i / steps : 0;
    if (i % (ink + gap) < ink)
      strut_sketch_dot(grid, (int)lround(from[0] + part * width),
                       (int)lround(from[1] + part * height));
  }
}

void strut_sketch_letter(strut_sketch_grid *grid, int column, int row, uint32_t code, int width) {
  size_t cell = cell_at(grid, column, row);
  grid->letter[cell] = code;
  if (width == 2) grid->letter[cell + 1] = RIGHT_HALF;
}

static uint32_t in_ascii(uint32_t code) {
  switch (code) {
    case STRUT_SKETCH_GROUND: return '=';
    case STRUT_SKETCH_HELD: return '#';
    case STRUT_SKETCH_HELD_IN_Y: return '^';
    case STRUT_SKETCH_HELD_IN_X: return '>';
    case STRUT_SKETCH_NODE: return 'o';
    default: return code;
  }
}

void strut_sketch_put(strut_buffer *buffer, uint32_t code, bool unicode) {
  if (!unicode) code = in_ascii(code);
  if (code < 0x80) {
    strut_buffer_add(buffer, "%c", (int)code);
  } else if (code < 0x800) {
    strut_buffer_add(buffer, "%c%c", (int)(0xc0 | code >> 6), (int)(0x80 | (code & 0x3f)));
  } else if (code < 0x10000) {
    strut_buffer_add(buffer, "%c%c%c", (int)(0xe0 | code >> 12), (int)(0x80 | (code >> 6 & 0x3f)),
                     (int)(0x80 | (code & 0x3f)));
  } else {
    strut_buffer_add(buffer, "%c%c%c%c", (int)(0xf0 | code >> 18),
                     (int)(0x80 | (code >> 12 & 0x3f)), (int)(0x80 | (code >> 6 & 0x3f)),
                     (int)(0x80 | (code & 0x3f)));
  }
}

/* The character nearest to some of eight dots: by how far they spread and which way they lean. */
static char nearest_character(uint8_t dots) {
  static const char levels[] = "'--_";
  int count = 0, left = ACROSS, right = -1, top = DOWN, bottom = -1, x = 0, y = 0, xy = 0;
  for (int i = 0; i < DOWN; i++) {
    for (int j = 0; j < ACROSS; j++) {
      if (!(dots & bits[i][j])) continue;
      count++;
      if (j < left) left = j;
      if (j > right) right = j;
      if (i < top) top = i;
      bottom = i;
      x += j;
      y += i;
      xy += i * j;
    }
  }
  int leaning = count * xy - x * y;
  if (top == bottom) return left == right ? (top < 2 ? '\'' : '.') : levels[top];
  if (left == right) return bottom - top > 1 ? '|' : (top < 2 ? '\'' : '.');
  if (bottom - top == 1) return top < 2 ? '-' : '_';
  if (leaning == 0) return count > 4 ? 'X' : '+';
  return leaning > 0 ? '\\' : '/';
}

static bool blank(const strut_sketch_grid *grid, int column, int row) {
  size_t cell = cell_at(grid, column, row);
  return (!grid->dots[cell] && !grid->letter[cell]) || grid->letter[cell] == ' ';
}

/* Columns of a row up to its last that is not blank. */
static int used(const strut_sketch_grid *grid, int row) {
  int columns = grid->columns;
  while (columns > 0 && blank(grid, columns - 1, row)) columns--;
  return columns;
}

static void write_row(const strut_sketch_grid *grid, int row, bool unicode, strut_buffer *buffer) {
  int columns = used(grid, row);
  for (int i = 0; i < columns; i++) {
    size_t cell = cell_at(grid, i, row);
    if (grid->letter[cell] == RIGHT_HALF) continue;
    if (grid->letter[cell]) {
      strut_sketch_put(buffer, grid->letter[cell], unicode);
    } else if (!grid->dots[cell]) {
      strut_sketch_put(buffer, ' ', unicode);
    } else if (unicode) {
      strut_sketch_put(buffer, 0x2800u + grid->dots[cell], unicode);
    } else {
      strut_sketch_put(buffer, (uint32_t)nearest_character(grid->dots[cell]), unicode);
    }
  }
}

void strut_sketch_grid_write(const strut_sketch_grid *grid, bool unicode, const char *indent,
                             strut_buffer *buffer) {
  int first = 0, end = grid->rows;
  while (first < end && used(grid, first) == 0) first++;
  while (end > first && used(grid, end - 1) == 0) end--;
  for (int row = first; row < end; row++) {
    if (used(grid, row) > 0) strut_buffer_add(buffer, "%s", indent);
    write_row(grid, row, unicode, buffer);
    strut_buffer_add(buffer, "\n");
  }
}
