/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/reports.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "engine/scene/profile.h"

/* Code points of marks, in ascending order; ASCII output substitutes others. */
enum {
  STRUT_SKETCH_GROUND = 0x2594, /* a line at the upper edge of its cell */
  STRUT_SKETCH_HELD = 0x25b2,
  STRUT_SKETCH_HELD_IN_Y = 0x25b3,
  STRUT_SKETCH_HELD_IN_X = 0x25b7,
  STRUT_SKETCH_NODE = 0x25cf
};

/* Dots are counted from the upper left, in two columns and four rows per cell. */
typedef struct sketch_grid {
  int columns, rows;
  uint8_t *dots;    /* (rows, columns) which of the eight are set, as in U+2800 + dots */
  uint32_t *letter; /* (rows, columns) code point over the dots; 0: none; 1: right half of one */
} sketch_grid;

enum { STRUT_SKETCH_NAME = 14 };

/* A short text of known width. */
typedef struct sketch_name {
  uint32_t code[STRUT_SKETCH_NAME];
  uint8_t width[STRUT_SKETCH_NAME]; /* columns of each: 1 or 2 */
  int count, columns;
} sketch_name;

/* ---- the grid of character cells ---- */

enum { ACROSS = 2, DOWN = 4, RIGHT_HALF = 1 };

/* Braille's bits: row by row in each of the two columns. */
static const uint8_t bits[DOWN][ACROSS] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};

static bool sketch_grid_create(sketch_grid *grid, int columns, int rows) {
  size_t cells = (size_t)columns * (size_t)rows;
  *grid = (sketch_grid){.columns = columns, .rows = rows};
  grid->dots = strut_allocate(cells, sizeof *grid->dots);
  grid->letter = strut_allocate(cells, sizeof *grid->letter);
  return grid->dots && grid->letter;
}

static void sketch_grid_free(sketch_grid *grid) {
  strut_release(grid->dots);
  strut_release(grid->letter);
  *grid = (sketch_grid){0};
}

static size_t cell_at(const sketch_grid *grid, int column, int row) {
  return (size_t)row * (size_t)grid->columns + (size_t)column;
}

static bool sketch_inside(const sketch_grid *grid, int column, int row) {
  return column >= 0 && column < grid->columns && row >= 0 && row < grid->rows;
}

static void sketch_dot(sketch_grid *grid, int x, int y) {
  if (x < 0 || y < 0 || !sketch_inside(grid, x / ACROSS, y / DOWN)) return;
  grid->dots[cell_at(grid, x / ACROSS, y / DOWN)] |= bits[y % DOWN][x % ACROSS];
}

static void sketch_line(sketch_grid *grid, const double from[2], const double to[2], int ink,
                        int gap) {
  double width = to[0] - from[0], height = to[1] - from[1];
  int steps = (int)ceil(fmax(fabs(width), fabs(height)));
  for (int i = 0; i <= steps; i++) {
    double part = steps > 0 ? (double)i / steps : 0;
    if (i % (ink + gap) < ink)
      sketch_dot(grid, (int)lround(from[0] + part * width), (int)lround(from[1] + part * height));
  }
}

static void sketch_letter(sketch_grid *grid, int column, int row, uint32_t code, int width) {
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

static void sketch_put(strut_buffer *buffer, uint32_t code, bool unicode) {
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

static bool blank(const sketch_grid *grid, int column, int row) {
  size_t cell = cell_at(grid, column, row);
  return (!grid->dots[cell] && !grid->letter[cell]) || grid->letter[cell] == ' ';
}

/* Columns of a row up to its last that is not blank. */
static int used(const sketch_grid *grid, int row) {
  int columns = grid->columns;
  while (columns > 0 && blank(grid, columns - 1, row)) columns--;
  return columns;
}

static void write_row(const sketch_grid *grid, int row, bool unicode, strut_buffer *buffer) {
  int columns = used(grid, row);
  for (int i = 0; i < columns; i++) {
    size_t cell = cell_at(grid, i, row);
    if (grid->letter[cell] == RIGHT_HALF) continue;
    if (grid->letter[cell]) {
      sketch_put(buffer, grid->letter[cell], unicode);
    } else if (!grid->dots[cell]) {
      sketch_put(buffer, ' ', unicode);
    } else if (unicode) {
      sketch_put(buffer, 0x2800u + grid->dots[cell], unicode);
    } else {
      sketch_put(buffer, (uint32_t)nearest_character(grid->dots[cell]), unicode);
    }
  }
}

static void sketch_grid_write(const sketch_grid *grid, bool unicode, const char *indent,
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

/* ---- names beside nodes ---- */

enum { MOST_HIDDEN = 1, ELLIPSIS = 0x2026, ROOM_FOR_MORE = 6 };

/* Letters that every terminal prints from left to right in the same width; all others may do what
 * they like: they combine, turn the direction, or are as wide as the font says. */
static const struct {
  uint32_t first, last;
  uint8_t width;
} plain[] = {
    {0x20, 0x7e, 1},     {0xa1, 0xac, 1},     {0xae, 0x2ff, 1},    {0x370, 0x377, 1},
    {0x37a, 0x37f, 1},   {0x384, 0x38a, 1},   {0x38c, 0x38c, 1},   {0x38e, 0x3a1, 1},
    {0x3a3, 0x482, 1},   {0x48a, 0x52f, 1},   {0x1e00, 0x1eff, 1}, {0x2010, 0x2015, 1},
    {0x2018, 0x2022, 1}, {0x2032, 0x2034, 1}, {0x2070, 0x2071, 1}, {0x2074, 0x208e, 1},
    {0x2190, 0x2193, 1}, {0x3041, 0x3096, 2}, {0x30a1, 0x30ff, 2}, {0x3400, 0x4dbf, 2},
    {0x4e00, 0x9fff, 2}, {0xac00, 0xd7a3, 2}, {0xff01, 0xff60, 2},
};

static int width_of(uint32_t code, bool unicode) {
  if (!unicode && code > 0x7e) return 0;
  for (size_t i = 0; i < sizeof plain / sizeof plain[0]; i++)
    if (code >= plain[i].first && code <= plain[i].last) return plain[i].width;
  return 0;
}

/* One code point of valid UTF-8, as every name is; 0 for anything else. */
static size_t decode(const char *text, uint32_t *code) {
  unsigned char lead = (unsigned char)*text;
  size_t count = lead < 0x80 ? 1 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  static const unsigned char masks[] = {0, 0x7f, 0x1f, 0x0f, 0x07};
  *code = lead & masks[count];
  for (size_t i = 1; i < count; i++) {
    unsigned char next = (unsigned char)text[i];
    if ((next & 0xc0) != 0x80) {
      *code = 0;
      return i;
    }
    *code = *code << 6 | (next & 0x3f);
  }
  return count;
}

static bool append(sketch_name *name, uint32_t code, int width) {
  if (name->count >= STRUT_SKETCH_NAME || name->columns + width > STRUT_SKETCH_NAME) return false;
  name->code[name->count] = code;
  name->width[name->count++] = (uint8_t)width;
  name->columns += width;
  return true;
}

/* Shortens the name by some columns, with a mark for the omission. */
static void cut(sketch_name *name, int columns, bool unicode) {
  int sign = unicode ? 1 : 2;
  while (name->count > 0 && name->columns + sign + columns > STRUT_SKETCH_NAME)
    name->columns -= name->width[--name->count];
  for (int i = 0; i < sign; i++) append(name, unicode ? ELLIPSIS : '.', 1);
}

static sketch_name number_of(size_t node) {
  sketch_name name = {0};
  char digits[24];
  snprintf(digits, sizeof digits, "#%zu", node + 1);
  for (const char *c = digits; *c; c++) append(&name, (uint32_t)*c, 1);
  return name;
}

static sketch_name sketch_name_of(const char *text, size_t node, bool unicode) {
  sketch_name name = {0};
  bool whole = true;
  while (*text) {
    uint32_t code;
    text += decode(text, &code);
    int width = width_of(code, unicode);
    if (width == 0) return number_of(node);
    whole = whole && append(&name, code, width);
  }
  if (!whole) cut(&name, 0, unicode);
  return name;
}

static void sketch_name_more(sketch_name *name, size_t more) {
  char text[24];
  int length = snprintf(text, sizeof text, " +%zu", more);
  bool unicode = true;
  for (int i = 0; i < name->count; i++) unicode = unicode && name->code[i] != '.';
  if (length > STRUT_SKETCH_NAME) return;
  if (name->columns + length > STRUT_SKETCH_NAME) cut(name, length, unicode);
  for (const char *c = text; *c; c++) append(name, (uint32_t)*c, 1);
}

/* Cells with dots that the name would hide there, or INT_MAX where it does not fit. */
static int hidden(const sketch_grid *grid, int column, int row, const sketch_name *name) {
  int count = 0;
  for (int i = column - 1; i <= column + name->columns; i++) {
    bool beside = i < column || i == column + name->columns; /* no two names touch */
    if (!sketch_inside(grid, i, row)) {
      if (beside) continue;
      return INT_MAX;
    }
    size_t cell = (size_t)row * (size_t)grid->columns + (size_t)i;
    uint32_t letter = grid->letter[cell];
    bool mark = letter >= STRUT_SKETCH_GROUND && letter <= STRUT_SKETCH_NODE;
    if (letter && !(beside && mark)) return INT_MAX;
    if (!beside && grid->dots[cell]) count++;
  }
  return count;
}

static void sketch_name_place(sketch_grid *grid, int column, int row, const sketch_name *name) {
  int width = name->columns, best = MOST_HIDDEN + 1, at = 0, line = 0;
  const int places[][2] = {{column + 1, row},
                           {column - width, row},
                           {column - width / 2, row - 1},
                           {column - width / 2, row + 1},
                           {column + 1, row - 1},
                           {column - width, row - 1},
                           {column + 1, row + 1},
                           {column - width, row + 1}};
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    int count = hidden(grid, places[i][0], places[i][1], name);
    if (count >= best) continue;
    best = count;
    at = places[i][0];
    line = places[i][1];
  }
  if (best > MOST_HIDDEN) return;
  for (int i = 0; i < name->count; i++) {
    sketch_letter(grid, at, line, name->code[i], name->width[i]);
    at += name->width[i];
  }
}

/* ---- the sketch ---- */

enum { MARGIN_ROWS = 3, DIGITS = 4, CROWD = 6, MOST_NAMED = 2000 };

static const double NEAR = 0.5; /* of the structure's size: a ground farther away is not shown */

/* Map from the plane to the grid, in dots: x runs right, y down. */
typedef struct view {
  const strut_model *model;
  const double *q;
  double low[2], high[2]; /* of the nodes [m] */
  double bottom;          /* of what is shown: the ground may be lower [m] */
  double scale;           /* [1/m] dots */
  double zero[2];         /* where x = low[0] and y = bottom are */
  int columns, rows;
} view;

static void measure(view *v) {
  for (int k = 0; k < 2; k++) {
    v->low[k] = (double)INFINITY;
    v->high[k] = -(double)INFINITY;
  }
  for (int32_t i = 0; i < v->model->node_count; i++) {
    for (int k = 0; k < 2; k++) {
      v->low[k] = fmin(v->low[k], v->q[2 * i + k]);
      v->high[k] = fmax(v->high[k], v->q[2 * i + k]);
    }
  }
}

static double ground_height(const view *v, double x) {
  const strut_ground *ground = &v->model->scene->ground;
  return ground->height + x * tan(ground->slope);
}

/* Widest name among the nodes at the left or right end. */
static int margin_for_names(const view *v, int columns, bool unicode) {
  int widest = 0;
  for (int32_t i = 0; i < v->model->node_count && i < MOST_NAMED; i++) {
    sketch_name name = sketch_name_of(v->model->scene->nodes[i].name, (size_t)i, unicode);
    if (name.columns > widest) widest = name.columns;
  }
  return widest + 1 < columns / 4 ? widest + 1 : columns / 4;
}

/* Chooses the largest scale that fits, and then as few cells as it needs. */
static void lay_out(view *v, int columns, int rows, bool unicode) {
  const strut_ground *ground = &v->model->scene->ground;
  double width = v->high[0] - v->low[0], height = v->high[1] - v->low[1];
  v->bottom = v->low[1];
  if (ground->present && ground->slope == 0) {
    double reach = fmax(width, height) > 0 ? NEAR * fmax(width, height) : (double)INFINITY;
    bool near = ground->height <= v->high[1] && v->low[1] - ground->height <= reach;
    if (near && ground->height < v->low[1] && isfinite(reach)) v->bottom = ground->height;
  }
  height = v->high[1] - v->bottom;
  int margin = margin_for_names(v, columns, unicode);
  double across = 2 * (columns - 2 * margin) - 1, down = 4 * (rows - MARGIN_ROWS) - 1;
  v->scale = fmin(width > 0 ? across / width : (double)INFINITY,
                  height > 0 ? down / height : (double)INFINITY);
  if (!isfinite(v->scale)) v->scale = 0;
  v->columns = 2 * margin + (int)ceil((width * v->scale + 1) / 2);
  v->zero[0] = 2 * margin;
  /* A level ground is the lower edge of a cell: what stands on it has its dots just above. */
  bool level = ground->present && ground->slope == 0;
  double above = level && ground->height > v->bottom && ground->height < v->high[1]
                     ? (v->high[1] - ground->height) * v->scale
                     : height * v->scale;
  double edge = 4 * ceil((4 + above - 3) / 4) + 3;
  v->zero[1] = edge + (height * v->scale - above);
  v->rows = (int)floor(v->zero[1] / 4) + 2;
}

static void place(const view *v, const double position[2], double dot[2]) {
  dot[0] = v->zero[0] + (position[0] - v->low[0]) * v->scale;
  dot[1] = v->zero[1] - (position[1] - v->bottom) * v->scale;
}

static void cell_of(const view *v, int32_t node, int *column, int *row) {
  double dot[2];
  place(v, v->q + 2 * node, dot);
  *column = (int)lround(dot[0]) / 2;
  *row = (int)lround(dot[1]) / 4;
}

/* The part of a segment between dots a and b that the grid may show; false: none. */
static bool clip_to_grid(const view *v, double a[2], double b[2]) {
  double low = 0.0, high = 1.0;
  const double most[2] = {2.0 * v->columns, 4.0 * v->rows};
  for (int k = 0; k < 2; k++) {
    double d = b[k] - a[k];
    if (d == 0.0) {
      if (!(a[k] >= 0.0 && a[k] < most[k])) return false;
      continue;
    }
    double p = -a[k] / d, q = (most[k] - 1.0 - a[k]) / d;
    low = fmax(low, fmin(p, q)), high = fmin(high, fmax(p, q));
  }
  if (!(low < high)) return false;
  double x = a[0], y = a[1], dx = b[0] - a[0], dy = b[1] - a[1];
  a[0] = x + low * dx, a[1] = y + low * dy;
  b[0] = x + high * dx, b[1] = y + high * dy;
  return true;
}

/* Outlines of several grounds, dashed; is one of them visible? */
static bool draw_surfaces(const view *v, sketch_grid *grid) {
  const strut_scene *scene = v->model->scene;
  const double middle[2] = {0.5 * (v->low[0] + v->high[0]), 0.5 * (v->low[1] + v->high[1])};
  double far = v->scale > 0 ? 4.0 * (v->columns + v->rows) / v->scale : 1.0;
  bool seen = false;
  for (size_t g = 0; g < scene->ground_count && v->scale > 0; g++) {
    strut_arena arena = {0};
    double(*points)[2] =
        strut_arena_allocate(&arena, strut_outline_most(&scene->grounds[g]), sizeof *points);
    size_t count = points ? strut_outline_of(&scene->grounds[g], NULL, middle, far, points) : 0;
    for (size_t k = 0; k + 1 < count; k++) {
      double a[2], b[2];
      place(v, points[k], a);
      place(v, points[k + 1], b);
      if (!clip_to_grid(v, a, b)) continue;
      sketch_line(grid, a, b, 2, 2);
      seen = true;
    }
    strut_arena_free(&arena);
  }
  return seen;
}

/* Is the ground visible? */
static bool draw_ground(const view *v, sketch_grid *grid) {
  const strut_ground *ground = &v->model->scene->ground;
  if (v->model->scene->ground_count) return draw_surfaces(v, grid);
  if (!ground->present) return false;
  if (ground->slope == 0) {
    double at[2] = {v->low[0], ground->height}, dot[2];
    place(v, at, dot);
    if (!(dot[1] >= 0 && dot[1] < 4 * v->rows)) return false;
    int row = (int)lround(dot[1]) / 4 + 1;
    for (int i = 0; sketch_inside(grid, i, row) && i < grid->columns; i++)
      sketch_letter(grid, i, row, STRUT_SKETCH_GROUND, 1);
    return row < v->rows;
  }
  bool seen = false;
  for (int i = 0; i < 2 * v->columns && v->scale > 0; i++) {
    double x = v->low[0] + (i - v->zero[0]) / v->scale;
    double at[2] = {x, ground_height(v, x)}, dot[2];
    place(v, at, dot);
    if (!(dot[1] >= 0 && dot[1] < 4 * v->rows)) continue;
    seen = true;
    if (i % 4 < 2) sketch_dot(grid, i, (int)lround(dot[1]));
  }
  return seen;
}

static void draw_members(const view *v, sketch_grid *grid) {
  const strut_scene *scene = v->model->scene;
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *member = &scene->members[i];
    double from[2], to[2];
    for (size_t k = 0; k <= member->guide_count; k++) {
      place(v, v->q + 2 * strut_member_node(member, k), from);
      place(v, v->q + 2 * strut_member_node(member, k + 1), to);
      sketch_line(grid, from, to, 1, member->kind == STRUT_BAR ? 0 : 1);
    }
  }
}

/* The sides of a cell, dotted. */
static void draw_cells(const view *v, sketch_grid *grid) {
  const strut_scene *scene = v->model->scene;
  for (size_t i = 0; i < scene->cell_count; i++) {
    const strut_cell *cell = &scene->cells[i];
    double from[2], to[2];
    for (size_t k = 0; k < cell->node_count; k++) {
      place(v, v->q + 2 * cell->node[k], from);
      place(v, v->q + 2 * cell->node[(k + 1) % cell->node_count], to);
      sketch_line(grid, from, to, 1, 3);
    }
  }
}

static uint32_t mark_of(const strut_node *node) {
  if (node->fixed[0] && node->fixed[1]) return STRUT_SKETCH_HELD;
  if (node->fixed[1]) return STRUT_SKETCH_HELD_IN_Y;
  return node->fixed[0] ? STRUT_SKETCH_HELD_IN_X : STRUT_SKETCH_NODE;
}

/* Nodes in every cell. */
static void count_nodes(const view *v, const sketch_grid *grid, int32_t *there) {
  for (int32_t i = 0; i < v->model->node_count; i++) {
    int column, row;
    cell_of(v, i, &column, &row);
    if (sketch_inside(grid, column, row)) there[row * grid->columns + column]++;
  }
}

/* Where there are more nodes than a sixth of the cells, marks and names would hide the lines: only
 * nodes with no other around have them. */
static bool crowded(const view *v) { return v->model->node_count > v->columns * v->rows / CROWD; }

static bool stands_out(const view *v, const sketch_grid *grid, const int32_t *there, int column,
                       int row) {
  int32_t count = 0;
  if (!crowded(v)) return true;
  for (int i = row - 1; i <= row + 1; i++)
    for (int j = column - 1; j <= column + 1; j++)
      if (sketch_inside(grid, j, i)) count += there[i * grid->columns + j];
  return count == 1;
}

static void draw_nodes(const view *v, sketch_grid *grid, const int32_t *there) {
  for (int32_t i = 0; i < v->model->node_count; i++) {
    double dot[2];
    int column, row;
    uint32_t mark = mark_of(&v->model->scene->nodes[i]);
    place(v, v->q + 2 * i, dot);
    sketch_dot(grid, (int)lround(dot[0]), (int)lround(dot[1]));
    cell_of(v, i, &column, &row);
    if (!sketch_inside(grid, column, row)) continue;
    if (mark == STRUT_SKETCH_NODE && !stands_out(v, grid, there, column, row)) continue;
    uint32_t old = grid->letter[row * grid->columns + column];
    bool support = old >= STRUT_SKETCH_HELD && old < STRUT_SKETCH_NODE;
    if (!support) sketch_letter(grid, column, row, mark, 1);
  }
}

/* Names nodes that are alone in their cell first. */
static void draw_names(const view *v, sketch_grid *grid, int32_t *there, bool unicode) {
  for (int pass = 0; pass < 2; pass++) {
    for (int32_t i = 0; i < v->model->node_count; i++) {
      int column, row;
      cell_of(v, i, &column, &row);
      if (!sketch_inside(grid, column, row)) continue;
      int32_t *count = &there[row * grid->columns + column];
      if (*count == 0 || (pass == 0) != (*count == 1)) continue;
      if (!stands_out(v, grid, there, column, row)) continue;
      sketch_name name = sketch_name_of(v->model->scene->nodes[i].name, (size_t)i, unicode);
      if (*count > 1) sketch_name_more(&name, (size_t)*count - 1);
      if (!crowded(v)) *count = 0; /* mentioned already */
      sketch_name_place(grid, column, row, &name);
    }
  }
}

static void write_mark(strut_buffer *buffer, uint32_t mark, const char *meaning, bool unicode) {
  strut_buffer_add(buffer, ",  ");
  sketch_put(buffer, mark, unicode);
  strut_buffer_add(buffer, " %s", meaning);
}

static void write_extent(const view *v, bool ground_seen, bool unicode, strut_buffer *buffer) {
  const strut_scene *scene = v->model->scene;
  bool held[4] = {false};
  strut_buffer_add(buffer, "  %s x %s", strut_quantity_of(v->high[0] - v->low[0], DIGITS, "m").text,
                   strut_quantity_of(v->high[1] - v->low[1], DIGITS, "m").text);
  for (size_t i = 0; i < scene->node_count; i++)
    held[(scene->nodes[i].fixed[0] ? 1 : 0) + (scene->nodes[i].fixed[1] ? 2 : 0)] = true;
  if (held[3]) write_mark(buffer, STRUT_SKETCH_HELD, "held", unicode);
  if (held[2]) write_mark(buffer, STRUT_SKETCH_HELD_IN_Y, "held in y", unicode);
  if (held[1]) write_mark(buffer, STRUT_SKETCH_HELD_IN_X, "held in x", unicode);
  if (strut_scene_has_ground(scene) && !ground_seen && v->scale > 0)
    strut_buffer_add(buffer, ",  the ground is far away");
  strut_buffer_add(buffer, "\n");
}

static int within(int value, int least) {
  return value < least ? least : value > STRUT_SKETCH_MOST ? STRUT_SKETCH_MOST : value;
}

char *strut_sketch(const strut_model *model, const double *q, int columns, int rows, bool unicode) {
  strut_buffer buffer = {0};
  sketch_grid grid = {0};
  view v = {.model = model, .q = q};
  columns = within(columns, STRUT_SKETCH_LEAST_COLUMNS);
  rows = within(rows, STRUT_SKETCH_LEAST_ROWS);
  measure(&v);
  if (!isfinite(v.high[0] - v.low[0]) || !isfinite(v.high[1] - v.low[1]))
    return strut_allocate(1, 1);               /* no nodes, or the plane is too small for them */
  lay_out(&v, columns - 2, rows - 1, unicode); /* without the indent and the extent */
  bool taken = sketch_grid_create(&grid, v.columns, v.rows);
  int32_t *there = strut_allocate((size_t)v.columns * (size_t)v.rows, sizeof *there);
  if (taken && there) {
    bool ground = draw_ground(&v, &grid);
    draw_cells(&v, &grid);
    draw_members(&v, &grid);
    count_nodes(&v, &grid, there);
    draw_nodes(&v, &grid, there);
    draw_names(&v, &grid, there, unicode);
    sketch_grid_write(&grid, unicode, "  ", &buffer);
    write_extent(&v, ground, unicode, &buffer);
  }
  strut_release(there);
  sketch_grid_free(&grid);
  return strut_buffer_take(&buffer);
}
