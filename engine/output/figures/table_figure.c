/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/table_figure.h"

#include <assert.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/output/figures/table_choice.h"

static const double CURVES_WIDTH = 165, MAP_WIDTH = 200; /* panels at least [pt] */
enum { NAME = 48, MOST_NAMES = 3 }; /* bytes and columns of an axis label; more are in the legend */
enum { MOST_CELLS = 4000000 };

/* A figure being filled in. */
typedef struct maker {
  const strut_table_figure *figure;
  const strut_table *table;
  strut_table_groups panels, curves; /* curves, or categories of a map */
  const char *y_name;
  double *at[2]; /* of a map: the grid's positions */
  size_t count[2];
  strut_arena arena;
  strut_error *error;
} maker;

static const strut_table_column *column_of(const maker *self, int column) {
  return column == STRUT_NO_COLUMN ? NULL : &self->table->columns[column];
}

/* "a) friction = 0.1" */
static const char *panel_title(maker *self, size_t panel) {
  const strut_table_column *column = column_of(self, self->figure->panels);
  return strut_arena_format(&self->arena, "%c) %s = %s%s%s", (char)('a' + (int)(panel % 26)),
                            column->name, self->panels.name[panel], *column->unit ? " " : "",
                            column->unit);
}

/* ---- curves ---- */

/* Rows of one curve in one panel. Returns how many. */
static size_t rows_of(const maker *self, size_t panel, size_t curve, size_t *rows) {
  const strut_table_figure *figure = self->figure;
  size_t count = 0;
  for (size_t i = 0; i < self->table->row_count; i++)
    if (strut_table_belongs(self->table, figure->panels, self->panels.name[panel], i) &&
        strut_table_belongs(self->table, figure->by, self->curves.name[curve], i))
      rows[count++] = i;
  return count;
}

/* Grey areas over stretches of matching rows. */
static bool add_bands(maker *self, const size_t *rows, size_t count, strut_panel *panel) {
  const strut_table_column *band = column_of(self, self->figure->band);
  const double *x = column_of(self, self->figure->x)->value;
  strut_band *bands = (strut_band *)panel->bands;
  const char *wanted = self->figure->band_value;
  for (size_t i = 0; band && i < count; i++) {
    if (strcmp(band->text[rows[i]], wanted) != 0) continue;
    size_t last = i;
    while (last + 1 < count && strcmp(band->text[rows[last + 1]], wanted) == 0) last++;
    double low = x[rows[i]], high = x[rows[last]];
    if (i > 0) low = 0.5 * (low + x[rows[i - 1]]);
    if (last + 1 < count) high = 0.5 * (high + x[rows[last + 1]]);
    bands[panel->band_count++] =
        (strut_band){.low = fmin(low, high),
                     .high = fmax(low, high),
                     .label = strut_arena_format(&self->arena, "%s %s", band->name, wanted)};
    if (!bands[panel->band_count - 1].label) return false;
    i = last;
  }
  return true;
}

/* What the legend says of y column k of a curve; NULL: there is one curve only, or no memory. */
static const char *curve_name(maker *self, size_t curve, int k) {
  const strut_table_figure *figure = self->figure;
  const char *column = column_of(self, figure->y[k])->name, *group = self->curves.name[curve];
  const strut_table_column *by = column_of(self, figure->by);
  bool several = figure->y_count > 1;
  if (self->curves.count * (size_t)figure->y_count < 2) return NULL;
  if (!group) return column;
  return strut_arena_format(&self->arena, "%s%s%s %s%s%s", several ? column : "",
                            several ? ", " : "", by->name, group, by->value && *by->unit ? " " : "",
                            by->value ? by->unit : "");
}

static bool add_curve(maker *self, const size_t *rows, size_t count, size_t curve, int k,
                      strut_panel *panel) {
  double *x = strut_arena_allocate(&self->arena, count, sizeof *x);
  double *y = strut_arena_allocate(&self->arena, count, sizeof *y);
  for (size_t i = 0; x && y && i < count; i++) {
    x[i] = column_of(self, self->figure->x)->value[rows[i]];
    y[i] = column_of(self, self->figure->y[k])->value[rows[i]];
  }
  ((strut_series *)panel->series)[panel->series_count++] = (strut_series){
      .label = curve_name(self, curve, k), .count = count, .x = x, .y = y, .look = -1};
  return x && y;
}

static bool fill_curves(maker *self, size_t number, strut_panel *panel) {
  const strut_table_figure *figure = self->figure;
  size_t most = self->curves.count * (size_t)figure->y_count, rows = self->table->row_count;
  size_t *row = strut_arena_allocate(&self->arena, rows, sizeof *row);
  panel->series = strut_arena_allocate(&self->arena, most, sizeof *panel->series);
  panel->bands =
      strut_arena_allocate(&self->arena, rows * self->curves.count, sizeof *panel->bands);
  panel->outliers = true;
  bool fine = row && panel->series && panel->bands;
  for (size_t c = 0; c < self->curves.count && fine; c++) {
    size_t count = rows_of(self, number, c, row);
    fine = add_bands(self, row, count, panel);
    for (int k = 0; k < figure->y_count && fine; k++)
      fine = add_curve(self, row, count, c, k, panel);
  }
  return fine;
}

/* ---- points ---- */

/* A cloud of the points that are marked, or of the others. */
static bool fill_cloud(maker *self, bool marked, strut_series *cloud) {
  const strut_table_figure *figure = self->figure;
  const int columns[] = {figure->x, figure->y[0], figure->value};
  double *to[3];
  for (int d = 0; d < 3; d++) {
    to[d] = strut_arena_allocate(&self->arena, self->table->row_count + 1, sizeof *to[d]);
    if (!to[d]) return false;
  }
  for (size_t i = 0; i < self->table->row_count; i++) {
    if (!figure->shown[i] || figure->marked[i] != marked) continue;
    for (int d = 0; d < 3; d++)
      to[d][cloud->count] = columns[d] >= 0 ? column_of(self, columns[d])->value[i] : (double)NAN;
    cloud->count++;
  }
  cloud->cloud = true;
  cloud->x = to[0], cloud->y = to[1], cloud->value = figure->value >= 0 ? to[2] : NULL;
  return true;
}

static bool fill_points(maker *self, strut_panel *panel) {
  strut_series *clouds = strut_arena_allocate(&self->arena, 2, sizeof *clouds);
  if (!clouds || !fill_cloud(self, false, &clouds[0]) || !fill_cloud(self, true, &clouds[1]))
    return false;
  strut_mark *marks = strut_arena_allocate(&self->arena, clouds[1].count + 1, sizeof *marks);
  for (size_t i = 0; marks && i < clouds[1].count; i++)
    marks[i] = (strut_mark){.at = {clouds[1].x[i], clouds[1].y[i]}, .ring = true};
  panel->series = clouds, panel->series_count = 2;
  panel->marks = marks, panel->mark_count = clouds[1].count;
  panel->room = 0.04;
  return marks != NULL;
}

/* ---- maps ---- */

/* The different finite values of a column, ascending. False: out of memory. */
static bool find_positions(maker *self, int column, int d) {
  const double *value = column_of(self, column)->value;
  double *all = strut_arena_allocate(&self->arena, self->table->row_count, sizeof *all);
  size_t used = 0, *kept = &self->count[d];
  for (size_t i = 0; all && i < self->table->row_count; i++)
    if (isfinite(value[i])) all[used++] = value[i];
  if (all && used) gsl_sort(all, 1, used);
  double grain = used ? 1e-9 * (all[used - 1] - all[0]) : 0; /* 0.1 + 0.2 equals 0.3 */
  for (size_t i = 0; i < used; i++)
    if (!*kept || all[i] - all[*kept - 1] > grain) all[(*kept)++] = all[i];
  self->at[d] = all;
  return all != NULL;
}

/* Index of the nearest of (count) ascending positions. */
static size_t nearest_index(const double *at, size_t count, double value) {
  assert(count > 0);
  size_t low = 0, high = count - 1;
  while (low < high) {
    size_t middle = (low + high) / 2;
    bool right = 0.5 * (at[middle] + at[middle + 1]) < value;
    *(right ? &low : &high) = middle + right;
  }
  return low;
}

static bool is_doubtful(const char *text) {
  static const char *const none[] = {"", "0", "false", "no", "nan", "null"};
  for (size_t i = 0; i < sizeof none / sizeof *none; i++)
    if (strcmp(text, none[i]) == 0) return false;
  return true;
}

static int by_text(const void *first, const void *second) {
  return strcmp(*(const char *const *)first, *(const char *const *)second);
}

/* Finds the grid's positions and the categories. */
static strut_status prepare_grid(maker *self) {
  const strut_table_figure *figure = self->figure;
  strut_table_groups *names = &self->curves;
  strut_status status = STRUT_OK;
  names->count = 0;
  if (!column_of(self, figure->value)->value)
    status = strut_table_groups_find(self->table, figure->value, STRUT_MOST_TABLE_GROUPS,
                                     "categories", names, self->error);
  if (status) return status;
  qsort(names->name, names->count, sizeof *names->name, by_text);
  if (names->count && !*names->name[0]) { /* an empty text is no category */
    names->count--;
    memmove(names->name, names->name + 1, names->count * sizeof *names->name);
  }
  if (!find_positions(self, figure->x, 0) || !find_positions(self, figure->y[0], 1))
    return strut_no_memory(self->error, "while drawing");
  if (!self->count[0] || !self->count[1] || self->count[1] > MOST_CELLS / self->count[0])
    return strut_fail(self->error, STRUT_USAGE,
                      "the map would have %zu by %zu cells: its x and y have to form a grid",
                      self->count[0], self->count[1]);
  return STRUT_OK;
}

/* Puts row i of the table into its cell. */
static void fill_cell(const maker *self, size_t i, int *category, double *value, bool *doubtful) {
  const strut_table_figure *figure = self->figure;
  const strut_table_column *of = column_of(self, figure->value),
                           *doubt = column_of(self, figure->doubt);
  double x = column_of(self, figure->x)->value[i], y = column_of(self, figure->y[0])->value[i];
  if (!isfinite(x) || !isfinite(y)) return;
  size_t k = nearest_index(self->at[1], self->count[1], y) * self->count[0] +
             nearest_index(self->at[0], self->count[0], x);
  if (of->value) value[k] = of->value[i];
  for (size_t g = 0; g < self->curves.count; g++)
    if (strcmp(self->curves.name[g], of->text[i]) == 0) category[k] = (int)g;
  if (doubt) doubtful[k] = is_doubtful(doubt->text[i]);
}

static bool fill_map(maker *self, size_t number, strut_panel *panel) {
  const strut_table_figure *figure = self->figure;
  const strut_table_column *of = column_of(self, figure->value),
                           *doubt = column_of(self, figure->doubt);
  size_t count = self->count[0] * self->count[1];
  strut_map *map = strut_arena_allocate(&self->arena, 1, sizeof *map);
  int *category = strut_arena_allocate(&self->arena, count, sizeof *category);
  double *value = strut_arena_allocate(&self->arena, count, sizeof *value);
  bool *doubtful = strut_arena_allocate(&self->arena, count, sizeof *doubtful);
  if (!map || !category || !value || !doubtful) return false;
  for (size_t k = 0; k < count; k++) value[k] = (double)NAN, category[k] = -1;
  for (size_t i = 0; i < self->table->row_count; i++)
    if (strut_table_belongs(self->table, figure->panels, self->panels.name[number], i))
      fill_cell(self, i, category, value, doubtful);
  *map = (strut_map){.columns = self->count[0],
                     .rows = self->count[1],
                     .xs = self->at[0],
                     .ys = self->at[1],
                     .category = of->value ? NULL : category,
                     .category_count = self->curves.count,
                     .names = self->curves.name,
                     .value = value,
                     .doubtful = doubt ? doubtful : NULL,
                     .doubt = doubt ? doubt->name : NULL};
  panel->map = map;
  return true;
}

/* ---- the whole ---- */

/* The label of the y axis: the names of its columns, or "" where they are too long or too many. */
static const char *name_y_axis(maker *self) {
  const strut_table_figure *figure = self->figure;
  char text[NAME] = "";
  size_t used = 0;
  for (int k = 0; k < figure->y_count && figure->y_count > 1; k++) {
    const char *column = column_of(self, figure->y[k])->name;
    if (k == MOST_NAMES || used + strlen(column) + 3 > NAME) return "";
    used += (size_t)snprintf(text + used, NAME - used, "%s%s", k ? ", " : "", column);
  }
  return figure->y_count > 1 ? strut_arena_format(&self->arena, "%s", text)
                             : column_of(self, figure->y[0])->name;
}

static strut_status check_column(const maker *self, int column) {
  const strut_table_column *table_column = column_of(self, column),
                           *first = column_of(self, self->figure->y[0]);
  if (!table_column || !table_column->value)
    return strut_fail(self->error, STRUT_USAGE, "column '%s' does not hold numbers",
                      table_column ? table_column->name : "");
  if (column == self->figure->x || strcmp(table_column->unit, first->unit) == 0) return STRUT_OK;
  return strut_fail(self->error, STRUT_USAGE,
                    "columns '%.60s' and '%.60s' have different units (%s, %s): draw them in "
                    "separate figures",
                    first->name, table_column->name, *first->unit ? first->unit : "none",
                    *table_column->unit ? table_column->unit : "none");
}

/* Checks the columns and finds the groups of rows. */
static strut_status prepare(maker *self) {
  const strut_table_figure *figure = self->figure;
  strut_status status = check_column(self, figure->x);
  for (int k = 0; k < figure->y_count && !status; k++) status = check_column(self, figure->y[k]);
  if (!status && figure->kind == STRUT_TABLE_POINTS && figure->value >= 0 &&
      !column_of(self, figure->value)->value)
    status = strut_fail(self->error, STRUT_USAGE, "points are drawn over columns of numbers");
  if (!status)
    status = strut_table_groups_find(self->table, figure->panels, STRUT_MOST_PANELS, "panels",
                                     &self->panels, self->error);
  if (!status && figure->kind == STRUT_TABLE_CURVES)
    status = strut_table_groups_find(self->table, figure->by, STRUT_MOST_TABLE_GROUPS, "curves",
                                     &self->curves, self->error);
  if (!status && figure->kind == STRUT_TABLE_MAP) status = prepare_grid(self);
  if (!status && !(self->y_name = name_y_axis(self)))
    status = strut_no_memory(self->error, "while drawing");
  return status;
}

static bool fill_panel(maker *self, size_t i, strut_panel *panel) {
  const strut_table_figure *figure = self->figure;
  const strut_table_column *column = column_of(self, figure->x), *y = column_of(self, figure->y[0]);
  const strut_table_column *value = column_of(self, figure->value);
  *panel = (strut_panel){.x = strut_axis_of(column->name, column->unit),
                         .y = strut_axis_of(self->y_name, y->unit)};
  panel->x.logarithmic = figure->log_x, panel->y.logarithmic = figure->log_y;
  if (value && value->value)
    panel->scale =
        (strut_colour_scale){.name = value->name, .unit = value->unit, .colours = figure->colours};
  if (figure->panels != STRUT_NO_COLUMN && !(panel->title = panel_title(self, i))) return false;
  return figure->kind == STRUT_TABLE_CURVES ? fill_curves(self, i, panel)
         : figure->kind == STRUT_TABLE_MAP  ? fill_map(self, i, panel)
                                            : fill_points(self, panel);
}

static strut_status draw(maker *self, const strut_plot *plot) {
  strut_panel *panels = strut_arena_allocate(&self->arena, self->panels.count, sizeof *panels);
  bool fine = panels != NULL, map = self->figure->kind == STRUT_TABLE_MAP;
  for (size_t i = 0; i < self->panels.count && fine; i++) fine = fill_panel(self, i, &panels[i]);
  const strut_figure figure = {.panel_count = self->panels.count,
                               .panels = panels,
                               .least_width = map ? MAP_WIDTH : CURVES_WIDTH,
                               .aspect = map ? 0.8 : 0.62,
                               .shared_axes = true,
                               .one_legend = true};
  return fine ? strut_figure_draw(plot, &figure, self->error)
              : strut_no_memory(self->error, "while drawing");
}

/* The rows that are compared are equal in these columns. */
static strut_table_pairing pair_rows(const strut_table_figure *figure) {
  bool map = figure->kind == STRUT_TABLE_MAP;
  return (strut_table_pairing){.keys = {map ? figure->y[0] : figure->by, figure->panels, figure->x},
                               .key_count = 3,
                               .between = figure->between,
                               .values = map ? &figure->value : figure->y,
                               .value_count = map ? 1 : (size_t)figure->y_count};
}

strut_status strut_table_draw(const strut_plot *plot, const strut_table_figure *figure,
                              const strut_table *table, strut_error *error) {
  strut_table_chosen chosen = {0};
  strut_table_figure drawn = *figure;
  maker m = {.figure = &drawn, .error = error};
  assert(figure->y_count > 0 && figure->y_count <= STRUT_MOST_Y);
  strut_status status =
      strut_table_choose(table, &figure->choice, pair_rows(figure), &chosen, error);
  m.table = chosen.table;
  if (figure->kind == STRUT_TABLE_MAP && figure->choice.difference != STRUT_NO_COLUMN && !status) {
    if (!table->columns[figure->value].value) drawn.doubt = (int)chosen.table->column_count - 1;
    if (drawn.colours == STRUT_COLOURS_AUTO) drawn.colours = STRUT_COLOURS_DIVERGING;
  }
  if (!status) status = prepare(&m);
  if (!status) status = draw(&m, plot);
  strut_arena_free(&m.arena);
  strut_table_chosen_free(&chosen);
  return status;
}
