/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/table_figure.h"

#include <assert.h>
#include <gsl/gsl_interp.h>
#include <gsl/gsl_sort_double.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/vec.h"

static const double CURVES_WIDTH = 165, MAP_WIDTH = 200; /* panels at least [pt] */
static const double BARS = 0.7,
                    WIDTH = 1.4; /* of a place; of lines of which some are dashed [pt] */
enum {
  DIGITS = 9 /* of a group's number */,
  NAME = 46,
  MOST_NAMES = 3 /* bytes and columns of an axis label; more are in the legend */,
  MOST_CELLS = 4000000,
  MOST_MARKS = 40 /* with texts */
};

/* A figure being filled in. Columns by number. */
typedef struct maker {
  const strut_plot *plot;
  const strut_study_figure *wanted;
  bool spread;
  int x, y[STRUT_MOST_Y], y_count, panel;
  int by, band, low, high, stable, line, mark, thing; /* of curves */
  int value, doubt;                                   /* of maps and points */
  int kept, broken; /* 0 where the accuracy is not kept; above 0 where a condition does not hold */
  const char *band_text;
  strut_table table;                 /* what is shown of the given one */
  strut_table_groups panels, curves; /* curves, or categories of a map */
  strut_table_groups places;         /* along x, of bars; else none */
  strut_table_groups kinds;          /* of marks */
  double *at[2];                     /* of a map: the grid's positions */
  size_t count[2];
  strut_figure page;
  strut_error *error;
} maker;

/* COLUMN=TEXT, or a column alone. */
static int find_column(const strut_table *table, const char *name, const char **text) {
  size_t length = name ? strcspn(name, text ? "=" : "") : 0;
  if (name && text) *text = name + length + 1;
  return strut_table_column_of(table, name, length);
}

static bool is_map(const maker *self) { return self->wanted->kind == STRUT_FIGURE_MAP; }

static const strut_table_column *column_of(const maker *self, int column) {
  return column == STRUT_NO_COLUMN ? NULL : &self->table.columns[column];
}

static double value_of(const maker *self, int column, size_t row) {
  const strut_table_column *of = column_of(self, column);
  return of && of->value ? of->value[row] : (double)NAN;
}

static bool is_of(const maker *self, int column, const char *text, size_t row) {
  return column == STRUT_NO_COLUMN || strcmp(column_of(self, column)->text[row], text) == 0;
}

/* The index of a text; NAN without one. */
static double index_of(const strut_table_groups *groups, const char *text) {
  for (size_t i = 0; i < groups->count; i++)
    if (strcmp(groups->name[i], text) == 0) return (double)i;
  return (double)NAN;
}

static size_t group_of(const maker *self, int column, const strut_table_groups *groups,
                       size_t row) {
  return column == STRUT_NO_COLUMN ? 0
                                   : (size_t)index_of(groups, column_of(self, column)->text[row]);
}

/* "stiffness 3 kN/m" of a group's first row, with `between` after the name; numbers without unit as they are written. */
static const char *group_text(maker *self, int column, const strut_table_groups *groups, size_t i,
                              const char *between) {
  const strut_table_column *of = column_of(self, column);
  double value = of->value ? of->value[groups->row[i]] : (double)NAN;
  bool unit = isfinite(value) && (*of->unit || of->shown.name);
  bool named = *of->name > ' '; /* else the texts say all */
  return strut_figure_text(
      &self->page, "%s%s%s", named ? of->name : "", named ? between : "",
      unit ? strut_quantity_shown(value, DIGITS, *of->unit ? of->unit : "1", of->shown).text
           : groups->name[i]);
}

/* Has the row's point not kept the accuracy, or a condition of the search? */
static bool is_doubted(const maker *self, size_t row) {
  return value_of(self, self->kept, row) == 0 || value_of(self, self->broken, row) > 0;
}

static bool is_in_panel(const maker *self, size_t panel, size_t row) {
  return is_of(self, self->panel, self->panels.name[panel], row);
}

/* ---- curves and bars ---- */

/* Rows of one curve in one panel. Returns how many. */
static size_t rows_of(const maker *self, size_t panel, size_t curve, size_t *rows) {
  size_t count = 0;
  for (size_t i = 0; i < self->table.row_count; i++)
    if (is_in_panel(self, panel, i) && is_of(self, self->by, self->curves.name[curve], i))
      rows[count++] = i;
  return count;
}

/* A grey area, which the legend names after the text that rows have there. */
static void add_band(maker *self, strut_panel *panel, double low, double high) {
  bool several = self->by != STRUT_NO_COLUMN && self->curves.count > 1;
  strut_add_band(&self->page, panel, fmin(low, high), fmax(low, high),
                 strut_figure_text(&self->page, "%s %s%s%s", column_of(self, self->band)->name,
                                   self->band_text, several ? " of at least one " : "",
                                   several ? column_of(self, self->by)->name : ""));
}

static bool is_in_band(const maker *self, size_t row) {
  const strut_table_column *band = column_of(self, self->band);
  return band && strcmp(band->text[row], self->band_text) == 0;
}

/* Grey areas over stretches of matching rows. */
static void add_bands(maker *self, const size_t *rows, size_t count, strut_panel *panel) {
  for (size_t i = 0; i < count; i++) {
    if (!is_in_band(self, rows[i])) continue;
    size_t last = i;
    while (last + 1 < count && is_in_band(self, rows[last + 1])) last++;
    double low = value_of(self, self->x, rows[i]), high = value_of(self, self->x, rows[last]);
    if (i > 0) low = 0.5 * (low + value_of(self, self->x, rows[i - 1]));
    if (last + 1 < count) high = 0.5 * (high + value_of(self, self->x, rows[last + 1]));
    add_band(self, panel, low, high);
    i = last;
  }
}

/* What the legend says of y column k of a curve; NULL: there is one curve only. */
static const char *curve_name(maker *self, size_t curve, int k) {
  const char *column = column_of(self, self->y[k])->name;
  bool several = self->y_count > 1;
  if (self->wanted->label_count)
    return self->wanted->labels[curve * (size_t)self->y_count + (size_t)k];
  bool kind = self->mark != STRUT_NO_COLUMN && self->by != STRUT_NO_COLUMN &&
              !column_of(self, self->by)->value;
  if (self->curves.count * (size_t)self->y_count < 2 && !kind) return NULL;
  if (self->by == STRUT_NO_COLUMN) return column;
  return strut_figure_text(&self->page, "%s%s%s", several ? column : "", several ? ", " : "",
                           group_text(self, self->by, &self->curves, curve, " "));
}

/* A dot in the colour of its kind, or a text alone. */
static void add_kind(maker *self, strut_panel *panel, size_t row, const strut_point *at) {
  const strut_table_column *mark = column_of(self, self->mark), *of = column_of(self, self->thing);
  const char *kind = mark ? mark->text[row] : "", *thing = of ? of->text[row] : "";
  if (mark ? !*kind : !*thing) return;
  strut_label *label = strut_add_mark(
      &self->page, panel, at->x, at->y,
      strut_figure_text(&self->page, "%s%s%.60s", kind, *kind && *thing ? " " : "", thing));
  label->dot = mark != NULL;
  if (mark) label->colour = strut_palette_thing((size_t)index_of(&self->kinds, kind));
  label->angle = (mark ? 0.25 : 1.25) * STRUT_PI;
}

static void add_row(maker *self, strut_panel *panel, strut_series *series, int y, size_t row,
                    double x) {
  const strut_table_column *stable = column_of(self, self->stable);
  strut_point *point = strut_add_point(&self->page, series, x, value_of(self, y, row));
  point->low = value_of(self, self->low, row), point->high = value_of(self, self->high, row);
  point->unstable = stable && strcmp(stable->text[row], "no") == 0;
  if (is_doubted(self, row) && isfinite(point->x + point->y))
    strut_add_mark(&self->page, panel, point->x, point->y, NULL)->ring = true;
  add_kind(self, panel, row, point);
}

/* True if a line ends between two rows. */
static bool is_gap(const maker *self, size_t row, size_t next) {
  for (int i = 0; i <= self->line; i++)
    if (strcmp(column_of(self, i)->text[row], column_of(self, i)->text[next]) != 0) return true;
  return false;
}

/* A bar for each row at the place of its text: series n beside the others, rows of one text beside each other. */
static void add_bars(maker *self, strut_panel *panel, strut_series *series, size_t n,
                     const size_t *rows, size_t count) {
  size_t used[STRUT_MOST_TABLE_GROUPS] = {0}, drawn[STRUT_MOST_TABLE_GROUPS] = {0}, deepest = 1;
  double width = BARS / (double)(self->curves.count * (size_t)self->y_count);
  for (size_t i = 0; i < count; i++) {
    size_t place = group_of(self, self->x, &self->places, rows[i]);
    if (++used[place] > deepest) deepest = used[place];
  }
  series->bar = width / (double)deepest;
  for (size_t i = 0; i < count; i++) {
    size_t place = group_of(self, self->x, &self->places, rows[i]);
    double beside = (double)drawn[place]++ - 0.5 * ((double)used[place] - 1);
    double x = (double)place - 0.5 * BARS + ((double)n + 0.5) * width + beside * series->bar;
    if (is_in_band(self, rows[i]))
      add_band(self, panel, x - 0.5 * series->bar, x + 0.5 * series->bar);
    add_row(self, panel, series, self->y[n % (size_t)self->y_count], rows[i], x);
  }
}

static void add_curves(maker *self, size_t number, strut_panel *panel) {
  size_t all = self->curves.count * (size_t)self->y_count, places = self->places.count;
  size_t *row = strut_arena_allocate(&self->page.arena, self->table.row_count + 1, sizeof *row);
  panel->outliers = self->stable == STRUT_NO_COLUMN;
  self->page.failed |= !row;
  for (size_t n = 0, count = 0; n < all && row; n++) {
    size_t curve = n / (size_t)self->y_count, k = n % (size_t)self->y_count;
    if (k == 0) count = rows_of(self, number, curve, row);
    if (k == 0 && !places) add_bands(self, row, count, panel);
    strut_series *series = strut_add_series(&self->page, panel, curve_name(self, curve, (int)k));
    if (places) add_bars(self, panel, series, n, row, count);
    if (self->stable != STRUT_NO_COLUMN)
      series->pen = (strut_pen){.colour = strut_palette_thing(n), .width = WIDTH};
    for (size_t i = 0; i < count && !places; i++) {
      if (i && is_gap(self, row[i - 1], row[i]))
        strut_add_point(&self->page, series, (double)NAN, (double)NAN);
      add_row(self, panel, series, self->y[k], row[i], value_of(self, self->x, row[i]));
    }
  }
  if (!places) return;
  panel->x.names = self->places.name, panel->x.name_count = places;
  panel->x.low = -0.5, panel->x.high = (double)places - 0.5;
  panel->zero = true;
}

/* What rings, empty dots and hatching mean; NULL: no row has them. */
static const char *doubt_of(const maker *self) {
  for (size_t i = 0; i < self->table.row_count; i++)
    if (is_doubted(self, i))
      return value_of(self, self->kept, i) == 0 ? "accuracy not kept" : "conditions not met";
  return NULL;
}

/* Explains dashes and marks; of very many marks there are no texts. */
static void add_keys(maker *self) {
  const bool points = self->wanted->kind == STRUT_FIGURE_POINTS;
  const strut_pen ring = {strut_grey(points ? 0.45 : 0.1), points ? 0.7 : 0.9, {0}, false};
  if (!is_map(self)) strut_add_key(&self->page, STRUT_KEY_DOT, ring, doubt_of(self));
  const strut_table_column *stable = column_of(self, self->stable);
  static const char *const words[] = {"stable", "unstable"};
  for (int k = 0; k < 2 && stable; k++) {
    bool some = false;
    for (size_t i = 0; i < self->table.row_count; i++)
      some = some || (strcmp(stable->text[i], "no") == 0) == k;
    strut_pen pen = {.colour = strut_grey(0.2), .width = WIDTH, .dash = {k ? 3 : 0, 2}, .butt = k};
    if (some) strut_add_key(&self->page, STRUT_KEY_LINE, pen, words[k]);
  }
  for (size_t i = 0; i < self->kinds.count; i++)
    if (*self->kinds.name[i])
      strut_add_key(&self->page, STRUT_KEY_DOT, (strut_pen){strut_grey(0.1), 0.6, {0}, false},
                    self->kinds.name[i])
          ->fill.colour = strut_palette_thing(i);
  for (size_t i = 0; i < self->page.panel_count; i++)
    for (size_t k = 0; k < self->page.panels[i].mark_count; k++)
      if (self->page.panels[i].mark_count > MOST_MARKS) self->page.panels[i].marks[k].text = NULL;
}

/* ---- points ---- */

/* A cloud of the points that are marked, with a ring around each, over one of the others. */
static void add_points(maker *self, size_t number, strut_panel *panel) {
  for (int marked = 0; marked < 2; marked++) {
    strut_series *cloud = strut_add_series(&self->page, panel, NULL);
    cloud->kind = STRUT_SERIES_DOTS;
    cloud->look = 0;
    for (size_t i = 0; i < self->table.row_count; i++) {
      if (!is_in_panel(self, number, i) || (*column_of(self, self->mark)->text[i] != 0) != marked)
        continue;
      double x = value_of(self, self->x, i), y = value_of(self, self->y[0], i);
      strut_add_point(&self->page, cloud, x, y)->value =
          is_doubted(self, i) ? (double)NAN : value_of(self, self->value, i);
      if (marked) strut_add_mark(&self->page, panel, x, y, NULL)->ring = true;
    }
  }
  if (panel->mark_count && !self->page.key_count)
    strut_add_key(&self->page, STRUT_KEY_DOT, (strut_pen){.colour = strut_grey(0.1), .width = 0.9},
                  "best");
  panel->room = 0.04;
}

/* ---- maps ---- */

/* The different finite values of a column, ascending. */
static void find_positions(maker *self, int column, int d) {
  double *all = strut_figure_numbers(&self->page, NULL, self->table.row_count);
  size_t used = 0, *kept = &self->count[d];
  for (size_t i = 0; all && i < self->table.row_count; i++)
    if (isfinite(value_of(self, column, i))) all[used++] = value_of(self, column, i);
  if (used) gsl_sort(all, 1, used);
  double grain = used ? 1e-9 * (all[used - 1] - all[0]) : 0; /* 0.1 + 0.2 equals 0.3 */
  for (size_t i = 0; i < used; i++)
    if (!*kept || all[i] - all[*kept - 1] > grain) all[(*kept)++] = all[i];
  self->at[d] = all;
}

/* Index of the nearest of the positions. */
static size_t nearest_index(const maker *self, int d, double value) {
  const double *at = self->at[d];
  size_t i = gsl_interp_bsearch(at, value, 0, self->count[d] - 1);
  return i + 1 < self->count[d] && 0.5 * (at[i] + at[i + 1]) < value ? i + 1 : i;
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
  strut_table_groups *names = &self->curves;
  strut_status status = STRUT_OK;
  if (!column_of(self, self->value)->value)
    status = strut_table_groups_find(&self->table, self->value, STRUT_MOST_TABLE_GROUPS,
                                     "categories", names, self->error);
  if (status) return status;
  qsort(names->name, names->count, sizeof *names->name, by_text);
  if (names->count && !*names->name[0]) { /* an empty text is no category */
    names->count--;
    memmove(names->name, names->name + 1, names->count * sizeof *names->name);
  }
  find_positions(self, self->x, 0);
  find_positions(self, self->y[0], 1);
  if (self->page.failed) return strut_no_memory(self->error, "while drawing");
  if (self->count[0] && self->count[1] && self->count[1] <= MOST_CELLS / self->count[0])
    return STRUT_OK;
  return strut_fail(self->error, STRUT_USAGE,
                    "the map would have %zu by %zu cells: its x and y have to form a grid",
                    self->count[0], self->count[1]);
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
  for (size_t i = 0; row && i < self->table.row_count; i++) {
    double x = value_of(self, self->x, i), y = value_of(self, self->y[0], i);
    if (is_in_panel(self, number, i) && isfinite(x) && isfinite(y))
      row[nearest_index(self, 1, y) * self->count[0] + nearest_index(self, 0, x)] = (uint32_t)i + 1;
  }
  if (row && self->spread)
    spread(self, row, strut_arena_allocate(&self->page.arena, cells, sizeof *row));
  return row;
}

static void add_map(maker *self, size_t number, strut_panel *panel) {
  const strut_table_column *of = column_of(self, self->value),
                           *doubt = column_of(self, self->doubt);
  size_t count = self->count[0] * self->count[1];
  strut_map *map = strut_arena_allocate(&self->page.arena, 1, sizeof *map);
  double *value = strut_figure_numbers(&self->page, NULL, count);
  bool *doubtful = strut_arena_allocate(&self->page.arena, count, sizeof *doubtful);
  const uint32_t *cells = find_rows(self, number);
  panel->map = map;
  self->page.failed |= !map || !value || !doubtful || !cells;
  if (self->page.failed) return;
  for (size_t k = 0; k < count; k++) {
    size_t row = cells[k] - 1;
    value[k] = !cells[k]   ? (double)NAN
               : of->value ? value_of(self, self->value, row)
                           : index_of(&self->curves, of->text[row]);
    doubtful[k] = cells[k] && ((doubt && is_doubtful(doubt->text[row])) || is_doubted(self, row));
  }
  *map = (strut_map){.columns = self->count[0],
                     .rows = self->count[1],
                     .xs = self->at[0],
                     .ys = self->at[1],
                     .name_count = self->curves.count,
                     .names = of->value ? NULL : self->curves.name,
                     .value = value,
                     .doubtful = doubt || doubt_of(self) ? doubtful : NULL,
                     .doubt = doubt ? doubt->name : doubt_of(self)};
}

/* ---- the whole ---- */

/* What the names of all y columns begin with, "x" of x_n1 and x_n2, or end with, "x" of n1.x and n2.x; "": nothing. */
static const char *shared_word(maker *self) {
  const char *first = column_of(self, self->y[0])->name;
  size_t whole = strlen(first), front = whole, back = whole;
  for (int k = 1; k < self->y_count; k++) {
    const char *name = column_of(self, self->y[k])->name;
    size_t length = strlen(name), same = 0;
    while (same < front && name[same] == first[same]) same++;
    front = same;
    for (same = 0;
         same < back && same < length && name[length - 1 - same] == first[whole - 1 - same];)
      same++;
    back = same;
  }
  while (front && !strchr("_. ", first[front - 1])) front--;
  while (back && !strchr("_. ", first[whole - back])) back--;
  return front > 1 ? strut_figure_text(&self->page, "%.*s", (int)front - 1, first)
         : back    ? first + whole - back + 1
                   : "";
}

/* The label of the y axis: the names of its columns, or what they share where those are too long or too many. */
static const char *name_y_axis(maker *self) {
  const char *text = column_of(self, self->y[0])->name;
  for (int k = 1; k < self->y_count && k < MOST_NAMES; k++)
    text = strut_figure_text(&self->page, "%s, %s", text, column_of(self, self->y[k])->name);
  bool short_enough = self->y_count == 1 || (self->y_count <= MOST_NAMES && strlen(text) <= NAME);
  return short_enough ? text : shared_word(self);
}

/* Numbers, in the unit of `first` unless that is NULL. */
static strut_status check_column(const maker *self, int column, const strut_table_column *first) {
  const strut_table_column *of = column_of(self, column);
  if (!of || !of->value)
    return strut_fail(self->error, STRUT_USAGE, "column '%s' does not hold numbers",
                      of ? of->name : "");
  if (!first || strcmp(of->unit, first->unit) == 0) return STRUT_OK;
  return strut_fail(self->error, STRUT_USAGE,
                    "columns '%.60s' and '%.60s' have different units (%s, %s): draw them in "
                    "separate figures",
                    first->name, of->name, *first->unit ? first->unit : "none",
                    *of->unit ? of->unit : "none");
}

/* Lines over texts are bars, unless a column is not there. */
static bool has_bars(const maker *self) {
  return self->wanted->kind == STRUT_FIGURE_LINES && self->x >= 0 &&
         !column_of(self, self->x)->value;
}

/* Checks the columns and finds the groups of rows. */
static strut_status prepare(maker *self) {
  const strut_table_column *first = column_of(self, self->y[0]);
  bool points = self->wanted->kind == STRUT_FIGURE_POINTS, bars = has_bars(self);
  const struct {
    bool wanted;
    int column;
    const char *what;
    strut_table_groups *groups;
  } groups[] = {{bars, self->x, "places", &self->places},
                {true, self->panel, "panels", &self->panels},
                {!points && self->mark != STRUT_NO_COLUMN, self->mark, "marks", &self->kinds},
                {!is_map(self) && !points, self->by, "curves", &self->curves}};
  strut_status status = bars ? STRUT_OK : check_column(self, self->x, NULL);
  for (int k = 0; k < self->y_count && !status; k++) status = check_column(self, self->y[k], first);
  if (!status && points && self->value >= 0) status = check_column(self, self->value, NULL);
  for (size_t i = 0; i < sizeof groups / sizeof *groups && !status; i++)
    if (groups[i].wanted)
      status = strut_table_groups_find(&self->table, groups[i].column, STRUT_MOST_TABLE_GROUPS,
                                       groups[i].what, groups[i].groups, self->error);
  if (!status && bars && self->plot->x.logarithmic)
    status = strut_fail(self->error, STRUT_USAGE,
                        "column '%.60s' holds texts, which have no logarithmic axis",
                        column_of(self, self->x)->name);
  size_t curves = self->curves.count * (size_t)self->y_count, labels = self->wanted->label_count;
  if (!status && labels && labels != curves)
    status = strut_fail(self->error, STRUT_USAGE, "%zu labels were given for %zu curve%s", labels,
                        curves, curves == 1 ? "" : "s");
  return status || !is_map(self) ? status : prepare_grid(self);
}

static void add_panel(maker *self, size_t i) {
  const strut_table_column *x = column_of(self, self->x), *y = column_of(self, self->y[0]);
  const strut_table_column *value = column_of(self, self->value);
  strut_panel *panel = strut_add_panel(&self->page);
  panel->x = strut_axis_in(x->name, x->unit, x->shown);
  panel->y = strut_axis_in(name_y_axis(self), y->unit, y->shown);
  if (value && value->value)
    panel->scale = (strut_colour_scale){.name = value->name,
                                        .unit = value->unit,
                                        .shown = value->shown,
                                        .colours = (strut_colours)self->wanted->colours};
  if (is_map(self) && self->wanted->difference && panel->scale.colours == STRUT_COLOURS_AUTO)
    panel->scale.colours = STRUT_COLOURS_DIVERGING;
  if (self->panel != STRUT_NO_COLUMN) /* "a) friction = 0.1" */
    panel->title = strut_figure_text(&self->page, "%c) %s", (char)('a' + (int)(i % 26)),
                                     group_text(self, self->panel, &self->panels, i, " = "));
  (is_map(self)                                ? add_map
   : self->wanted->kind == STRUT_FIGURE_POINTS ? add_points
                                               : add_curves)(self, i, panel);
}

/* Finds the columns by their names. */
static void find_columns(maker *self, const strut_table *table) {
  const strut_study_figure *wanted = self->wanted;
  bool map = is_map(self), points = wanted->kind == STRUT_FIGURE_POINTS;
  self->x = find_column(table, wanted->x, NULL);
  self->panel = find_column(table, wanted->panels, NULL);
  self->by = find_column(table, map ? NULL : wanted->series, NULL);
  self->band = find_column(table, map ? NULL : wanted->band, &self->band_text);
  self->low = find_column(table, wanted->low, NULL);
  self->high = find_column(table, wanted->high, NULL);
  self->stable = find_column(table, wanted->stable, NULL);
  self->line = find_column(table, wanted->line, NULL);
  self->mark = find_column(table, wanted->mark, NULL);
  self->thing = find_column(table, wanted->thing, NULL);
  self->kept = find_column(table, "accuracy_kept", NULL);
  if (wanted->kind == STRUT_FIGURE_BEST) self->kept = STRUT_NO_COLUMN; /* of others than the best */
  self->broken = find_column(table, wanted->kind == STRUT_FIGURE_BEST ? NULL : "violation", NULL);
  self->value = find_column(table, map || points ? wanted->color : NULL, NULL);
  self->doubt = find_column(table, wanted->doubt ? wanted->doubt : "flips", NULL);
  for (const char *y = wanted->y, *end; y && self->y_count < STRUT_MOST_Y;
       y = *end ? end + 1 : NULL) {
    end = y + strcspn(y, ",");
    self->y[self->y_count++] = strut_table_column_of(table, y, (size_t)(end - y));
  }
}

/* What is shown: some rows, or differences; of categories, where they differ, which is hatched. */
static strut_status choose_rows(maker *self, const strut_table *table) {
  bool map = is_map(self);
  const char *text = NULL;
  int only = find_column(table, self->wanted->only, &text);
  int between = find_column(table, self->wanted->difference, NULL);
  const strut_table_pairing pairing = {.keys = {map ? self->y[0] : self->by, self->panel, self->x},
                                       .between = self->wanted->kind == STRUT_FIGURE_MOTION,
                                       .values = map ? &self->value : self->y,
                                       .value_count = map ? 1 : (size_t)self->y_count};
  strut_status status = strut_table_choose(table, only, text, NULL, &self->table, self->error);
  if (status || between == STRUT_NO_COLUMN) return status;
  if (map && !column_of(self, self->value)->value) self->doubt = (int)table->column_count;
  return strut_table_subtract(&self->table, between, &pairing, self->error);
}

strut_status strut_table_draw(const strut_plot *plot, const strut_study_figure *figure,
                              const strut_table *table, bool spread, strut_error *error) {
  maker m = {.plot = plot, .wanted = figure, .spread = spread, .error = error};
  m.page = (strut_figure){.least_width = is_map(&m) ? MAP_WIDTH : CURVES_WIDTH,
                          .aspect = is_map(&m) ? 0.8 : 0.62,
                          .shared_axes = true,
                          .one_legend = true};
  find_columns(&m, table);
  assert(m.y_count > 0);
  strut_status status = choose_rows(&m, table);
  if (!status) status = prepare(&m);
  for (size_t i = 0; i < m.panels.count && !status; i++) add_panel(&m, i);
  if (!status) add_keys(&m);
  if (!status) status = strut_figure_draw(plot, &m.page, error);
  strut_arena_free(&m.page.arena);
  strut_arena_free(&m.table.arena);
  return status;
}
