/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/table_figure.h"

#include <assert.h>
#include <gsl/gsl_interp.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int strut_table_column_of(const strut_table *table, const char *name, size_t length) {
  for (size_t i = 0; name && i < table->column_count; i++)
    if (strlen(table->columns[i].name) == length &&
        memcmp(table->columns[i].name, name, length) == 0)
      return (int)i;
  return STRUT_NO_COLUMN;
}

bool strut_table_belongs(const strut_table_rows *rows, int column, const char *name, size_t row) {
  return rows->shown[row] &&
         (column == STRUT_NO_COLUMN || strcmp(rows->table->columns[column].text[row], name) == 0);
}

strut_status strut_table_groups_find(const strut_table_rows *rows, int column, size_t most,
                                     const char *what, strut_table_groups *groups,
                                     strut_error *error) {
  groups->count = column == STRUT_NO_COLUMN;
  groups->name[0] = NULL;
  for (size_t i = 0; i < rows->table->row_count && column != STRUT_NO_COLUMN; i++) {
    const strut_table_column *of = &rows->table->columns[column];
    size_t k = 0;
    while (k < groups->count && strcmp(groups->name[k], of->text[i]) != 0) k++;
    if (!rows->shown[i] || k < groups->count) continue;
    if (groups->count == most)
      return strut_fail(error, STRUT_USAGE, "column '%s' makes more than %zu %s", of->name, most,
                        what);
    groups->row[groups->count] = i;
    groups->name[groups->count++] = of->text[i];
  }
  return STRUT_OK;
}

/* ---- the difference of two sides ---- */

/* A row that knows where its keys are, to be sorted. */
typedef struct keyed {
  const strut_table_rows *rows;
  size_t row, keys; /* that count */
} keyed;

/* Numbers by value, NAN first; texts alphabetically. */
static int compare_keys(const void *first, const void *second) {
  const keyed *one = first, *two = second;
  for (size_t i = 0; i < one->keys; i++) {
    int column = one->rows->pairing.keys[i];
    if (column == STRUT_NO_COLUMN) continue;
    const strut_table_column *of = &one->rows->table->columns[column];
    int order;
    if (of->value) {
      double x = of->value[one->row], y = of->value[two->row];
      order = isnan(x) || isnan(y) ? isnan(y) - isnan(x) : (x > y) - (x < y);
    } else {
      order = strcmp(of->text[one->row], of->text[two->row]);
    }
    if (order) return order;
  }
  return 0;
}

/* True if all keys but the last are equal. */
static bool alongside(keyed first, keyed second) {
  first.keys--;
  return compare_keys(&first, &second) == 0;
}

/* Among (count) sorted rows. */
static strut_table_partner find_partner(const keyed *first, size_t count, const keyed *wanted) {
  const strut_table_pairing *pairing = &wanted->rows->pairing;
  size_t low = 0, high = count;
  while (low < high) { /* the first not before `wanted` */
    size_t middle = (low + high) / 2;
    bool before = compare_keys(&first[middle], wanted) < 0;
    *(before ? &low : &high) = middle + before;
  }
  if (low < count && compare_keys(&first[low], wanted) == 0)
    return (strut_table_partner){first[low].row, first[low].row, 0};
  if (!pairing->between || low == 0 || low == count || !alongside(first[low - 1], *wanted) ||
      !alongside(first[low], *wanted))
    return (strut_table_partner){SIZE_MAX, SIZE_MAX, 0};
  const double *x = wanted->rows->table->columns[pairing->keys[pairing->key_count - 1]].value;
  size_t before = first[low - 1].row, after = first[low].row;
  return (strut_table_partner){before, after,
                               (x[wanted->row] - x[before]) / (x[after] - x[before])};
}

/* Hides the rows of the first side and finds the partners of the others. */
static strut_status pair_sides(strut_table_rows *rows, int of, strut_arena *arena,
                               strut_error *error) {
  strut_table_groups sides;
  size_t count = 0, all = rows->table->row_count;
  strut_status status = strut_table_groups_find(rows, of, 2, "sides to compare", &sides, error);
  if (status) return status;
  if (sides.count < 2)
    return strut_fail(error, STRUT_USAGE,
                      "column '%.60s' has only the text '%.60s', so there is nothing to compare",
                      rows->table->columns[of].name, sides.name[0]);
  keyed *first = strut_arena_allocate(arena, all, sizeof *first);
  rows->partner = strut_arena_allocate(arena, all, sizeof *rows->partner);
  if (!first || !rows->partner) return strut_no_memory(error, "while drawing");
  memcpy(rows->side, sides.name, sizeof rows->side);
  for (size_t i = 0; i < all; i++) {
    if (!strut_table_belongs(rows, of, rows->side[0], i)) continue;
    first[count++] = (keyed){rows, i, rows->pairing.key_count};
    rows->shown[i] = false;
  }
  qsort(first, count, sizeof *first, compare_keys);
  for (size_t i = 0; i < all; i++)
    if (rows->shown[i])
      rows->partner[i] = find_partner(first, count, &(keyed){rows, i, rows->pairing.key_count});
  return STRUT_OK;
}

bool strut_table_compares(const strut_table_rows *rows, int column) {
  for (size_t i = 0; i < rows->pairing.value_count && rows->partner; i++)
    if (rows->pairing.values[i] == column) return true;
  return false;
}

double strut_table_number(const strut_table_rows *rows, int column, size_t row) {
  const double *value = column >= 0 ? rows->table->columns[column].value : NULL;
  if (!value) return (double)NAN;
  if (!strut_table_compares(rows, column)) return value[row];
  const strut_table_partner *partner = &rows->partner[row];
  if (partner->row == SIZE_MAX) return (double)NAN;
  double less = value[row] - value[partner->row];
  if (partner->weight > 0) less -= partner->weight * (value[partner->next] - value[partner->row]);
  return less;
}

bool strut_table_differs(const strut_table_rows *rows, int column, size_t row) {
  const char *const *text = rows->table->columns[column].text;
  size_t other = rows->partner[row].row;
  return other == SIZE_MAX || strcmp(text[other], text[row]) != 0;
}

strut_status strut_table_rows_choose(const strut_table *table, const strut_table_choice *choice,
                                     const strut_table_pairing *pairing, strut_arena *arena,
                                     strut_table_rows *rows, strut_error *error) {
  bool any = choice->only == STRUT_NO_COLUMN;
  *rows = (strut_table_rows){.table = table,
                             .pairing = *pairing,
                             .shown = strut_arena_allocate(arena, table->row_count + 1, 1)};
  if (!rows->shown) return strut_no_memory(error, "while drawing");
  memset(rows->shown, true, table->row_count);
  for (size_t i = 0; i < table->row_count && choice->only != STRUT_NO_COLUMN; i++) {
    rows->shown[i] = strut_table_belongs(rows, choice->only, choice->only_value, i);
    any = any || rows->shown[i];
  }
  if (!any)
    return strut_fail(error, STRUT_USAGE, "no row of the table has '%.60s' in column '%.60s'",
                      choice->only_value, table->columns[choice->only].name);
  return choice->difference == STRUT_NO_COLUMN ? STRUT_OK
                                               : pair_sides(rows, choice->difference, arena, error);
}

static const double CURVES_WIDTH = 165, MAP_WIDTH = 200; /* panels at least [pt] */
enum {
  DIGITS = 9 /* of a group's number */,
  NAME = 46,
  MOST_NAMES = 3
}; /* bytes and columns of an axis label; more are in the legend */
enum { MOST_CELLS = 4000000 };

/* The columns that a figure names, by number. */
typedef struct resolved {
  strut_study_figure_kind kind;
  int x, y[STRUT_MOST_Y], y_count, panels;
  strut_table_choice choice;
  int by, band; /* of curves */
  const char *band_value;
  int value, doubt; /* of maps and points */
  strut_colours colours;
  strut_table_marks marks;
} resolved;

/* A figure being filled in. */
typedef struct maker {
  const strut_study_figure *wanted;
  resolved *figure;
  strut_table_rows rows;
  strut_table_groups panels, curves; /* curves, or categories of a map */
  double *at[2];                     /* of a map: the grid's positions */
  size_t count[2];
  strut_figure page;
  strut_error *error;
} maker;

static const strut_table_column *column_of(const maker *self, int column) {
  return column == STRUT_NO_COLUMN ? NULL : &self->rows.table->columns[column];
}

static double value_of(const maker *self, int column, size_t row) {
  return strut_table_number(&self->rows, column, row);
}

/* "stiffness 3 kN/m" of a group's first row, with `between` after the name; numbers without unit as they are written. */
static const char *group_text(maker *self, int column, const strut_table_groups *groups, size_t i,
                              const char *between) {
  const strut_table_column *of = column_of(self, column);
  double value = of->value ? of->value[groups->row[i]] : (double)NAN;
  bool unit = isfinite(value) && (*of->unit || of->shown.name);
  return strut_figure_text(
      &self->page, "%s%s%s", of->name, between,
      unit ? strut_quantity_shown(value, DIGITS, *of->unit ? of->unit : "1", of->shown).text
           : groups->name[i]);
}

/* "velocity", or "velocity, b less a". */
static const char *name_of(maker *self, int column) {
  const strut_table_column *of = column_of(self, column);
  if (!of->value || !strut_table_compares(&self->rows, column)) return of->name;
  return strut_figure_text(&self->page, "%s, %s less %s", of->name, self->rows.side[1],
                           self->rows.side[0]);
}

static bool is_in_panel(const maker *self, size_t panel, size_t row) {
  return strut_table_belongs(&self->rows, self->figure->panels, self->panels.name[panel], row);
}

/* ---- curves ---- */

/* Rows of one curve in one panel. Returns how many. */
static size_t rows_of(const maker *self, size_t panel, size_t curve, size_t *rows) {
  size_t count = 0;
  for (size_t i = 0; i < self->rows.table->row_count; i++)
    if (is_in_panel(self, panel, i) &&
        strut_table_belongs(&self->rows, self->figure->by, self->curves.name[curve], i))
      rows[count++] = i;
  return count;
}

/* Grey areas over stretches of matching rows. */
static void add_bands(maker *self, const size_t *rows, size_t count, strut_panel *panel) {
  const strut_table_column *band = column_of(self, self->figure->band);
  const double *x = column_of(self, self->figure->x)->value;
  const char *wanted = self->figure->band_value;
  for (size_t i = 0; band && i < count; i++) {
    if (strcmp(band->text[rows[i]], wanted) != 0) continue;
    size_t last = i;
    while (last + 1 < count && strcmp(band->text[rows[last + 1]], wanted) == 0) last++;
    double low = x[rows[i]], high = x[rows[last]];
    if (i > 0) low = 0.5 * (low + x[rows[i - 1]]);
    if (last + 1 < count) high = 0.5 * (high + x[rows[last + 1]]);
    strut_add_band(&self->page, panel, fmin(low, high), fmax(low, high),
                   strut_figure_text(&self->page, "%s %s", band->name, wanted));
    i = last;
  }
}

/* What the legend says of y column k of a curve; NULL: there is one curve only. */
static const char *curve_name(maker *self, size_t curve, int k) {
  const resolved *figure = self->figure;
  const char *column = name_of(self, figure->y[k]);
  bool several = figure->y_count > 1;
  if (self->wanted->label_count)
    return self->wanted->labels[curve * (size_t)figure->y_count + (size_t)k];
  if (self->curves.count * (size_t)figure->y_count < 2) return NULL;
  if (figure->by == STRUT_NO_COLUMN) return column;
  return strut_figure_text(&self->page, "%s%s%s", several ? column : "", several ? ", " : "",
                           group_text(self, figure->by, &self->curves, curve, " "));
}

static void add_curves(maker *self, size_t number, strut_panel *panel) {
  const resolved *figure = self->figure;
  size_t *row =
      strut_arena_allocate(&self->page.arena, self->rows.table->row_count + 1, sizeof *row);
  panel->outliers = true;
  self->page.failed = self->page.failed || !row;
  for (size_t c = 0; c < self->curves.count && row; c++) {
    size_t count = rows_of(self, number, c, row);
    add_bands(self, row, count, panel);
    for (int k = 0; k < figure->y_count; k++) {
      strut_series *series = strut_add_series(&self->page, panel, curve_name(self, c, k));
      for (size_t i = 0; i < count; i++)
        strut_add_point(&self->page, series, value_of(self, figure->x, row[i]),
                        value_of(self, figure->y[k], row[i]));
    }
  }
}

/* ---- points ---- */

/* A cloud of the points that are marked, with a ring around each, over one of the others. */
static void add_points(maker *self, size_t number, strut_panel *panel) {
  const resolved *figure = self->figure;
  for (int marked = 0; marked < 2; marked++) {
    strut_series *cloud = strut_add_series(&self->page, panel, NULL);
    cloud->cloud = true;
    cloud->look = 0;
    for (size_t i = 0; i < self->rows.table->row_count; i++) {
      if (!is_in_panel(self, number, i) || figure->marks.marked[i] != marked) continue;
      double x = value_of(self, figure->x, i), y = value_of(self, figure->y[0], i);
      strut_add_point(&self->page, cloud, x, y)->value = value_of(self, figure->value, i);
      if (marked) strut_add_mark(&self->page, panel, x, y, NULL)->ring = true;
    }
  }
  if (panel->mark_count && !self->page.key_count)
    strut_add_key(&self->page, STRUT_KEY_DOT, (strut_pen){.colour = strut_grey(0.1), .width = 0.9},
                  "best");
  panel->room = 0.04;
}

/* ---- maps ---- */

/* The different finite values of a column, ascending. False: out of memory. */
static bool find_positions(maker *self, int column, int d) {
  double *all = strut_figure_numbers(&self->page, self->rows.table->row_count);
  size_t used = 0, *kept = &self->count[d];
  for (size_t i = 0; all && i < self->rows.table->row_count; i++)
    if (self->rows.shown[i] && isfinite(value_of(self, column, i)))
      all[used++] = value_of(self, column, i);
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
  size_t i = gsl_interp_bsearch(at, value, 0, count - 1);
  return i + 1 < count && 0.5 * (at[i] + at[i + 1]) < value ? i + 1 : i;
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
  const resolved *figure = self->figure;
  strut_table_groups *names = &self->curves;
  strut_status status = STRUT_OK;
  names->count = 0;
  if (!column_of(self, figure->value)->value)
    status = strut_table_groups_find(&self->rows, figure->value, STRUT_MOST_TABLE_GROUPS,
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

/* Cells without a row (+ 1) get that of a neighbour, again and again: of a grid that is refined in places. */
static void spread(const maker *self, uint32_t *row, uint32_t *before) {
  size_t wide = self->count[0], cells = wide * self->count[1];
  for (bool changed = before != NULL; changed;) {
    changed = false;
    memcpy(before, row, cells * sizeof *row);
    for (size_t k = 0; k < cells; k++) {
      const size_t near[] = {k % wide ? k - 1 : k, k % wide + 1 < wide ? k + 1 : k,
                             k >= wide ? k - wide : k, k + wide < cells ? k + wide : k};
      for (int n = 0; n < 4 && !row[k]; n++) row[k] = before[near[n]];
      changed = changed || row[k] != before[k];
    }
  }
}

/* The row of the table in each cell of a panel, + 1; 0: none. NULL: out of memory. */
static uint32_t *find_rows(maker *self, size_t number) {
  size_t cells = self->count[0] * self->count[1];
  uint32_t *row = strut_arena_allocate(&self->page.arena, cells, sizeof *row);
  for (size_t i = 0; row && i < self->rows.table->row_count; i++) {
    double x = value_of(self, self->figure->x, i), y = value_of(self, self->figure->y[0], i);
    if (!is_in_panel(self, number, i) || !isfinite(x) || !isfinite(y)) continue;
    row[nearest_index(self->at[1], self->count[1], y) * self->count[0] +
        nearest_index(self->at[0], self->count[0], x)] = (uint32_t)i + 1;
  }
  if (row && self->figure->marks.spread)
    spread(self, row, strut_arena_allocate(&self->page.arena, cells, sizeof *row));
  return row;
}

static void add_map(maker *self, size_t number, strut_panel *panel) {
  const strut_table_column *of = column_of(self, self->figure->value),
                           *doubt = column_of(self, self->figure->doubt);
  size_t count = self->count[0] * self->count[1];
  bool other = self->rows.partner && !of->value; /* of categories */
  strut_arena *arena = &self->page.arena;
  strut_map *map = strut_arena_allocate(arena, 1, sizeof *map);
  int *category = strut_arena_allocate(arena, count, sizeof *category);
  double *value = strut_arena_allocate(arena, count, sizeof *value);
  bool *doubtful = strut_arena_allocate(arena, count, sizeof *doubtful);
  const uint32_t *row = find_rows(self, number);
  panel->map = map;
  self->page.failed |= !map || !category || !value || !doubtful || !row;
  if (self->page.failed) return;
  for (size_t k = 0; k < count; k++) {
    value[k] = (double)NAN, category[k] = -1;
    if (!row[k]) continue;
    value[k] = value_of(self, self->figure->value, row[k] - 1);
    for (size_t g = 0; g < self->curves.count; g++)
      if (strcmp(self->curves.name[g], of->text[row[k] - 1]) == 0) category[k] = (int)g;
    doubtful[k] = other   ? strut_table_differs(&self->rows, self->figure->value, row[k] - 1)
                  : doubt ? is_doubtful(doubt->text[row[k] - 1])
                          : false;
  }
  *map = (strut_map){.columns = self->count[0],
                     .rows = self->count[1],
                     .xs = self->at[0],
                     .ys = self->at[1],
                     .category = of->value ? NULL : category,
                     .category_count = self->curves.count,
                     .names = self->curves.name,
                     .value = value,
                     .doubtful = doubt || other ? doubtful : NULL,
                     .doubt = doubt ? doubt->name : NULL};
  if (other) map->doubt = strut_figure_text(&self->page, "%s: other", self->rows.side[0]);
}

/* ---- the whole ---- */

/* The label of the y axis: the names of its columns, or "" where they are too long or too many. */
static const char *name_y_axis(maker *self) {
  const resolved *figure = self->figure;
  const char *text = name_of(self, figure->y[0]);
  if (figure->y_count > MOST_NAMES) return "";
  for (int k = 1; k < figure->y_count; k++)
    text = strut_figure_text(&self->page, "%s, %s", text, name_of(self, figure->y[k]));
  return figure->y_count > 1 && strlen(text) > NAME ? "" : text;
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
  const resolved *figure = self->figure;
  strut_status status = check_column(self, figure->x);
  for (int k = 0; k < figure->y_count && !status; k++) status = check_column(self, figure->y[k]);
  if (!status && figure->kind == STRUT_FIGURE_POINTS && figure->value >= 0 &&
      !column_of(self, figure->value)->value)
    status = strut_fail(self->error, STRUT_USAGE, "points are drawn over columns of numbers");
  if (!status)
    status = strut_table_groups_find(&self->rows, figure->panels, STRUT_MOST_PANELS, "panels",
                                     &self->panels, self->error);
  if (!status && figure->kind == STRUT_FIGURE_LINES)
    status = strut_table_groups_find(&self->rows, figure->by, STRUT_MOST_TABLE_GROUPS, "curves",
                                     &self->curves, self->error);
  size_t curves = self->curves.count * (size_t)figure->y_count;
  if (!status && self->wanted->label_count && self->wanted->label_count != curves)
    status = strut_fail(self->error, STRUT_USAGE, "%zu labels were given for %zu curve%s",
                        self->wanted->label_count, curves, curves == 1 ? "" : "s");
  if (!status && figure->kind == STRUT_FIGURE_MAP) status = prepare_grid(self);
  return status;
}

static void add_panel(maker *self, size_t i) {
  const resolved *figure = self->figure;
  const strut_table_column *x = column_of(self, figure->x), *y = column_of(self, figure->y[0]);
  const strut_table_column *value = column_of(self, figure->value);
  strut_panel *panel = strut_add_panel(&self->page);
  panel->x = strut_axis_of(x->name, x->unit);
  panel->y = strut_axis_of(name_y_axis(self), y->unit);
  panel->x.shown = x->shown, panel->y.shown = y->shown;
  panel->x.logarithmic = self->wanted->log_x, panel->y.logarithmic = self->wanted->log_y;
  if (value && value->value)
    panel->scale = (strut_colour_scale){.name = name_of(self, figure->value),
                                        .unit = value->unit,
                                        .shown = value->shown,
                                        .colours = figure->colours};
  if (figure->panels != STRUT_NO_COLUMN) /* "a) friction = 0.1" */
    panel->title = strut_figure_text(&self->page, "%c) %s", (char)('a' + (int)(i % 26)),
                                     group_text(self, figure->panels, &self->panels, i, " = "));
  (figure->kind == STRUT_FIGURE_MAP      ? add_map
   : figure->kind == STRUT_FIGURE_POINTS ? add_points
                                         : add_curves)(self, i, panel);
}

/* The rows that are compared are equal in these columns. */
static strut_table_pairing pair_rows(const resolved *figure, bool between) {
  bool map = figure->kind == STRUT_FIGURE_MAP;
  return (strut_table_pairing){.keys = {map ? figure->y[0] : figure->by, figure->panels, figure->x},
                               .key_count = 3,
                               .between = between,
                               .values = map ? &figure->value : figure->y,
                               .value_count = map ? 1 : (size_t)figure->y_count};
}

/* COLUMN=TEXT, or a column alone. */
static int find_column(const strut_table *table, const char *name, const char **text) {
  size_t length = name ? strcspn(name, text ? "=" : "") : 0;
  if (name && text) *text = name + length + 1;
  return strut_table_column_of(table, name, length);
}

static resolved resolve(const strut_study_figure *wanted, const strut_table *table,
                        strut_table_marks marks) {
  bool map = wanted->kind == STRUT_FIGURE_MAP, points = wanted->kind == STRUT_FIGURE_POINTS;
  resolved r = {.kind = map || points ? wanted->kind : STRUT_FIGURE_LINES,
                .x = find_column(table, wanted->x, NULL),
                .panels = find_column(table, wanted->panels, NULL),
                .choice.difference = find_column(table, wanted->difference, NULL),
                .by = find_column(table, map ? NULL : wanted->series, NULL),
                .value = find_column(table, map || points ? wanted->color : NULL, NULL),
                .doubt = find_column(table, wanted->doubt ? wanted->doubt : "flips", NULL),
                .colours = (strut_colours)wanted->colours,
                .marks = marks};
  r.choice.only = find_column(table, wanted->only, &r.choice.only_value);
  r.band = find_column(table, map ? NULL : wanted->band, &r.band_value);
  for (const char *y = wanted->y, *end; y && r.y_count < STRUT_MOST_Y; y = *end ? end + 1 : NULL) {
    end = y + strcspn(y, ",");
    r.y[r.y_count++] = strut_table_column_of(table, y, (size_t)(end - y));
  }
  return r;
}

strut_status strut_table_draw(const strut_plot *plot, const strut_study_figure *figure,
                              const strut_table *table, strut_table_marks marks,
                              strut_error *error) {
  resolved drawn = resolve(figure, table, marks);
  const strut_table_pairing pairing = pair_rows(&drawn, figure->kind == STRUT_FIGURE_MOTION);
  bool map = figure->kind == STRUT_FIGURE_MAP;
  maker m = {.wanted = figure,
             .figure = &drawn,
             .error = error,
             .page = {.least_width = map ? MAP_WIDTH : CURVES_WIDTH,
                      .aspect = map ? 0.8 : 0.62,
                      .shared_axes = true,
                      .one_legend = true}};
  assert(drawn.y_count > 0);
  strut_status status =
      strut_table_rows_choose(table, &drawn.choice, &pairing, &m.page.arena, &m.rows, error);
  for (size_t i = 0; i < table->row_count && marks.shown && !status; i++)
    m.rows.shown[i] = m.rows.shown[i] && marks.shown[i];
  if (map && m.rows.partner && drawn.colours == STRUT_COLOURS_AUTO)
    drawn.colours = STRUT_COLOURS_DIVERGING;
  if (!status) status = prepare(&m);
  for (size_t i = 0; i < m.panels.count && !status; i++) add_panel(&m, i);
  if (!status) status = strut_figure_draw(plot, &m.page, error);
  strut_arena_free(&m.page.arena);
  return status;
}
