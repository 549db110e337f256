/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/sketch.h"

#include <math.h>
#include <stdlib.h>

#include "engine/output/quantity_text.h"
#include "engine/output/report/sketch_names.h"

enum { MARGIN_ROWS = 3, DIGITS = 4, CROWD = 6, MOST_NAMED = 2000 };

static const double NEAR = 0.5; /* of the structure's size: a ground farther away is not shown */

/* Where the plane is in the grid, in dots: x runs right, y down. */
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
    strut_sketch_name name =
        strut_sketch_name_of(v->model->scene->nodes[i].name, (size_t)i, unicode);
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

/* Whether there was a ground to be seen. */
static bool draw_ground(const view *v, strut_sketch_grid *grid) {
  const strut_ground *ground = &v->model->scene->ground;
  if (!ground->present) return false;
  if (ground->slope == 0) {
    double at[2] = {v->low[0], ground->height}, dot[2];
    place(v, at, dot);
    if (!(dot[1] >= 0 && dot[1] < 4 * v->rows)) return false;
    int row = (int)lround(dot[1]) / 4 + 1;
    for (int i = 0; strut_sketch_inside(grid, i, row) && i < grid->columns; i++)
      strut_sketch_letter(grid, i, row, STRUT_SKETCH_GROUND, 1);
    return row < v->rows;
  }
  bool seen = false;
  for (int i = 0; i < 2 * v->columns && v->scale > 0; i++) {
    double x = v->low[0] + (i - v->zero[0]) / v->scale;
    double at[2] = {x, ground_height(v, x)}, dot[2];
    place(v, at, dot);
    if (!(dot[1] >= 0 && dot[1] < 4 * v->rows)) continue;
    seen = true;
    if (i % 4 < 2) strut_sketch_dot(grid, i, (int)lround(dot[1]));
  }
  return seen;
}

static void draw_members(const view *v, strut_sketch_grid *grid) {
  const strut_scene *scene = v->model->scene;
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *member = &scene->members[i];
    double from[2], to[2];
    place(v, v->q + 2 * member->node[0], from);
    place(v, v->q + 2 * member->node[1], to);
    strut_sketch_line(grid, from, to, 1, member->kind == STRUT_BAR ? 0 : 1);
  }
}

static uint32_t mark_of(const strut_node *node) {
  if (node->fixed[0] && node->fixed[1]) return STRUT_SKETCH_HELD;
  if (node->fixed[1]) return STRUT_SKETCH_HELD_IN_Y;
  return node->fixed[0] ? STRUT_SKETCH_HELD_IN_X : STRUT_SKETCH_NODE;
}

/* Nodes in every cell. */
static void count_nodes(const view *v, const strut_sketch_grid *grid, int32_t *there) {
  for (int32_t i = 0; i < v->model->node_count; i++) {
    int column, row;
    cell_of(v, i, &column, &row);
    if (strut_sketch_inside(grid, column, row)) there[row * grid->columns + column]++;
  }
}

/* Where there are more nodes than a sixth of the cells, marks and names would hide the lines: only
 * nodes with no other around have them. */
static bool crowded(const view *v) { return v->model->node_count > v->columns * v->rows / CROWD; }

static bool stands_out(const view *v, const strut_sketch_grid *grid, const int32_t *there,
                       int column, int row) {
  int32_t count = 0;
  if (!crowded(v)) return true;
  for (int i = row - 1; i <= row + 1; i++)
    for (int j = column - 1; j <= column + 1; j++)
      if (strut_sketch_inside(grid, j, i)) count += there[i * grid->columns + j];
  return count == 1;
}

static void draw_nodes(const view *v, strut_sketch_grid *grid, const int32_t *there) {
  for (int32_t i = 0; i < v->model->node_count; i++) {
    double dot[2];
    int column, row;
    uint32_t mark = mark_of(&v->model->scene->nodes[i]);
    place(v, v->q + 2 * i, dot);
    strut_sketch_dot(grid, (int)lround(dot[0]), (int)lround(dot[1]));
    cell_of(v, i, &column, &row);
    if (!strut_sketch_inside(grid, column, row)) continue;
    if (mark == STRUT_SKETCH_NODE && !stands_out(v, grid, there, column, row)) continue;
    uint32_t old = grid->letter[row * grid->columns + column];
    bool support = old >= STRUT_SKETCH_HELD && old < STRUT_SKETCH_NODE;
    if (!support) strut_sketch_letter(grid, column, row, mark, 1);
  }
}

/* Nodes alone in their cell first: those are what one looks for. */
static void draw_names(const view *v, strut_sketch_grid *grid, int32_t *there, bool unicode) {
  for (int pass = 0; pass < 2; pass++) {
    for (int32_t i = 0; i < v->model->node_count; i++) {
      int column, row;
      cell_of(v, i, &column, &row);
      if (!strut_sketch_inside(grid, column, row)) continue;
      int32_t *count = &there[row * grid->columns + column];
      if (*count == 0 || (pass == 0) != (*count == 1)) continue;
      if (!stands_out(v, grid, there, column, row)) continue;
      strut_sketch_name name =
          strut_sketch_name_of(v->model->scene->nodes[i].name, (size_t)i, unicode);
      if (*count > 1) strut_sketch_name_more(&name, (size_t)*count - 1);
      if (!crowded(v)) *count = 0; /* said */
      strut_sketch_name_place(grid, column, row, &name);
    }
  }
}

static void write_mark(strut_buffer *buffer, uint32_t mark, const char *meaning, bool unicode) {
  strut_buffer_add(buffer, ",  ");
  strut_sketch_put(buffer, mark, unicode);
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
  if (scene->ground.present && !ground_seen && v->scale > 0)
    strut_buffer_add(buffer, ",  the ground is far away");
  strut_buffer_add(buffer, "\n");
}

static int within(int value, int least) {
  return value < least ? least : value > STRUT_SKETCH_MOST ? STRUT_SKETCH_MOST : value;
}

char *strut_sketch(const strut_model *model, const double *q, int columns, int rows, bool unicode) {
  strut_buffer buffer = {0};
  strut_sketch_grid grid = {0};
  view v = {.model = model, .q = q};
  columns = within(columns, STRUT_SKETCH_LEAST_COLUMNS);
  rows = within(rows, STRUT_SKETCH_LEAST_ROWS);
  measure(&v);
  if (!isfinite(v.high[0] - v.low[0]) || !isfinite(v.high[1] - v.low[1]))
    return strut_allocate(1, 1);               /* no nodes, or the plane is too small for them */
  lay_out(&v, columns - 2, rows - 1, unicode); /* without the indent and the extent */
  bool taken = strut_sketch_grid_create(&grid, v.columns, v.rows);
  int32_t *there = strut_allocate((size_t)v.columns * (size_t)v.rows, sizeof *there);
  if (taken && there) {
    bool ground = draw_ground(&v, &grid);
    draw_members(&v, &grid);
    count_nodes(&v, &grid, there);
    draw_nodes(&v, &grid, there);
    draw_names(&v, &grid, there, unicode);
    strut_sketch_grid_write(&grid, unicode, "  ", &buffer);
    write_extent(&v, ground, unicode, &buffer);
  }
  strut_release(there);
  strut_sketch_grid_free(&grid);
  return strut_buffer_take(&buffer);
}
