/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/table_figure.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/figures/table_parts.h"

static const double EDGE = 5, LOWEST = 165, HIGHEST = 260;

strut_status strut_table_groups_find(const strut_table *table, int column, size_t most,
                                     const char *what, strut_table_groups *g, strut_error *error) {
  g->count = 1;
  g->name[0] = NULL;
  if (column == STRUT_NO_COLUMN) return STRUT_OK;
  g->count = 0;
  for (size_t i = 0; i < table->row_count; i++) {
    const char *text = table->columns[column].text[i];
    size_t k = 0;
    while (k < g->count && strcmp(g->name[k], text) != 0) k++;
    if (k < g->count) continue;
    if (g->count == most)
      return strut_fail(error, STRUT_USAGE, "column '%s' makes more than %zu %s",
                        table->columns[column].name, most, what);
    g->name[g->count++] = text;
  }
  return STRUT_OK;
}

bool strut_table_belongs(const strut_table *table, int column, const char *name, size_t row) {
  return column == STRUT_NO_COLUMN || strcmp(table->columns[column].text[row], name) == 0;
}

strut_status strut_table_numbers(const strut_table *table, int column, strut_error *error) {
  if (table->columns[column].value) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE, "column '%s' does not hold numbers",
                    table->columns[column].name);
}

void strut_table_panel_title(const strut_table *table, int column, const char *name, size_t panel,
                             char title[300]) {
  title[0] = '\0';
  if (column == STRUT_NO_COLUMN) return;
  const strut_table_column *c = &table->columns[column];
  snprintf(title, 300, "%c) %s = %s%s%s", (char)('a' + (int)(panel % 26)), c->name, name,
           *c->unit ? " " : "", c->unit);
}

strut_status strut_panel_page_draw(const char *path, const char *title,
                                   const strut_panel_page *page,
                                   void (*head)(void *context, strut_canvas *canvas, strut_box box),
                                   strut_panel_draw panel, void *context, strut_error *error) {
  double inner = page->width - 2 * EDGE, top = 0.0;
  const strut_heading heading = {.width = page->width, .edge = EDGE, .title = title};
  size_t columns = (size_t)fmax(1, fmin(3, floor(inner / page->least_width)));
  if (columns > page->panels) columns = page->panels;
  size_t rows = (page->panels + columns - 1) / columns;
  double wide = inner / (double)columns;
  double high = fmax(LOWEST, fmin(page->aspect * wide, HIGHEST));
  strut_canvas *canvas = NULL;
  strut_status status = strut_heading_measure(&heading, &top, error);
  top += EDGE;
  if (status == STRUT_OK)
    status = strut_canvas_open(path, page->width, top + page->head + (double)rows * high + EDGE,
                               title ? title : "", &canvas, error);
  if (status != STRUT_OK) return status;
  strut_heading_draw(canvas, &heading);
  if (head) head(context, canvas, (strut_box){EDGE, top, inner, page->head});
  for (size_t k = 0; k < page->panels && status == STRUT_OK; k++)
    status = panel(context, canvas,
                   (strut_box){EDGE + (double)(k % columns) * wide,
                               top + page->head + (double)(k / columns) * high, wide, high},
                   k);
  if (status != STRUT_OK) strut_fail(error, status, "out of memory while drawing");
  if (status == STRUT_OK) status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  return status;
}

static const double PANEL_WIDTH = 165, ASPECT = 0.62, INDENT = 30;
enum { NAME = 48, MOST_NAMES = 3 }; /* bytes and columns of an axis label; more are in the legend */
enum { MOST_ENTRIES = STRUT_MOST_TABLE_GROUPS * STRUT_MOST_Y + 1 };

typedef struct maker {
  const strut_table_figure *figure;
  const strut_table *table;
  strut_table_groups panels, curves;
  strut_axis x, y;
  char y_name[NAME];
  strut_legend_entry *entries;
  size_t entry_count;
  strut_arena arena;
} maker;

strut_axis strut_table_axis_of(const strut_axis_choice *wanted, const char *name, const char *unit,
                               bool logarithmic) {
  strut_axis axis = {wanted->label ? wanted->label : name, unit, logarithmic, (double)NAN,
                     (double)NAN};
  if (wanted->limited) axis.low = wanted->low, axis.high = wanted->high;
  return axis;
}

/* Rows of one curve in one panel. Returns how many. */
static size_t rows_of(const maker *m, size_t panel, size_t curve, size_t *rows) {
  const strut_table_figure *f = m->figure;
  size_t count = 0;
  for (size_t i = 0; i < m->table->row_count; i++)
    if (strut_table_belongs(m->table, f->panels, m->panels.name[panel], i) &&
        strut_table_belongs(m->table, f->by, m->curves.name[curve], i))
      rows[count++] = i;
  return count;
}

/* Finds the runs of rows with the band's text; bands end midway to the neighbouring rows. */
static size_t find_bands(const maker *m, const size_t *rows, size_t count, strut_band *bands) {
  const strut_table_column *band = &m->table->columns[m->figure->band];
  const double *x = m->table->columns[m->figure->x].value;
  size_t found = 0;
  for (size_t i = 0; i < count; i++) {
    if (strcmp(band->text[rows[i]], m->figure->band_value) != 0) continue;
    size_t last = i;
    while (last + 1 < count && strcmp(band->text[rows[last + 1]], m->figure->band_value) == 0)
      last++;
    double low = x[rows[i]], high = x[rows[last]];
    if (i > 0) low = 0.5 * (low + x[rows[i - 1]]);
    if (last + 1 < count) high = 0.5 * (high + x[rows[last + 1]]);
    bands[found++] = (strut_band){.low = fmin(low, high), .high = fmax(low, high)};
    i = last;
  }
  return found;
}

static bool make_series(maker *m, const size_t *rows, size_t count, int k, size_t look,
                        strut_series *series) {
  int column = m->figure->y[k];
  double *x = strut_arena_allocate(&m->arena, count, sizeof *x);
  double *y = strut_arena_allocate(&m->arena, count, sizeof *y);
  if (!x || !y) return false;
  for (size_t i = 0; i < count; i++) {
    x[i] = m->table->columns[m->figure->x].value[rows[i]];
    y[i] = m->table->columns[column].value[rows[i]];
  }
  *series = (strut_series){.count = count, .x = x, .y = y, .look = (int)look};
  return true;
}

static const char *axis_name(const strut_table *table, int column) {
  return column == STRUT_NO_COLUMN ? "" : table->columns[column].name;
}

static strut_status draw_panel(void *context, strut_canvas *canvas, strut_box box, size_t panel) {
  maker *m = context;
  const strut_table_figure *f = m->figure;
  size_t most = m->curves.count * (size_t)f->y_count, used = 0, bands = 0;
  size_t *rows = strut_arena_allocate(&m->arena, m->table->row_count, sizeof *rows);
  strut_series *series = strut_arena_allocate(&m->arena, most, sizeof *series);
  strut_band *band =
      strut_arena_allocate(&m->arena, m->table->row_count * m->curves.count, sizeof *band);
  char title[300];
  if (!rows || !series || !band) return STRUT_NO_MEMORY;
  for (size_t c = 0; c < m->curves.count; c++) {
    size_t count = rows_of(m, panel, c, rows);
    if (f->band != STRUT_NO_COLUMN) bands += find_bands(m, rows, count, band + bands);
    for (int k = 0; k < f->y_count; k++, used++)
      if (!make_series(m, rows, count, k, used, &series[used])) return STRUT_NO_MEMORY;
  }
  strut_table_panel_title(m->table, f->panels, m->panels.name[panel], panel, title);
  const strut_curves curves = {.title = title[0] ? title : NULL,
                               .x = m->x,
                               .y = m->y,
                               .series_count = used,
                               .series = series,
                               .band_count = bands,
                               .bands = band,
                               .mark_beyond = !f->y_axis.limited};
  return strut_draw_curves(canvas, box, &curves);
}

/* The label of the y axis: the names of its columns, or "" where they are too long or too many. */
static const char *name_y_axis(maker *m) {
  const strut_table_figure *f = m->figure;
  size_t used = 0;
  if (f->y_count == 1) return m->table->columns[f->y[0]].name;
  for (int k = 0; k < f->y_count; k++) {
    const char *column = m->table->columns[f->y[k]].name;
    if (k == MOST_NAMES || used + strlen(column) + 3 > NAME) return "";
    used += (size_t)snprintf(m->y_name + used, NAME - used, "%s%s", k ? ", " : "", column);
  }
  return m->y_name;
}

/* Narrows the y axis to its values but for a few far away. False: out of memory. */
static bool omit_outliers(maker *m) {
  const strut_table_figure *f = m->figure;
  size_t rows = m->table->row_count, known = 0;
  strut_beyond beyond;
  double *values = strut_arena_allocate(&m->arena, rows * (size_t)f->y_count + 1, sizeof *values);
  for (int k = 0; k < f->y_count && values; k++)
    for (size_t i = 0; i < rows; i++) values[known++] = m->table->columns[f->y[k]].value[i];
  if (values) strut_range_without_outliers(values, known, &m->y.low, &m->y.high, &beyond);
  return values != NULL;
}

/* Finds the axes, which all panels share. False: out of memory. */
static bool find_axes(maker *m) {
  const strut_table_figure *f = m->figure;
  const strut_table_column *columns = m->table->columns, *x = &columns[f->x];
  m->x = strut_table_axis_of(&f->x_axis, x->name, x->unit, f->log_x);
  m->y = strut_table_axis_of(&f->y_axis, name_y_axis(m), columns[f->y[0]].unit, f->log_y);
  for (size_t i = 0; i < m->table->row_count; i++)
    for (int k = 0; k < f->y_count; k++) {
      double value = columns[f->y[k]].value[i];
      if (!isfinite(value) || !isfinite(x->value[i])) continue;
      if (!f->x_axis.limited) strut_axis_include(&m->x, x->value[i]);
      if (!f->y_axis.limited) strut_axis_include(&m->y, value);
    }
  bool fine = f->log_y || f->y_axis.limited || omit_outliers(m);
  strut_axis_settle(&m->x, 0);
  strut_axis_settle(&m->y, f->y_axis.limited ? 0 : 0.06);
  return fine;
}

/* All y have the unit of the axis. */
static strut_status check_units(const strut_table *table, const strut_table_figure *f,
                                strut_error *error) {
  const strut_table_column *first = &table->columns[f->y[0]];
  for (int k = 1; k < f->y_count; k++) {
    const strut_table_column *y = &table->columns[f->y[k]];
    if (strcmp(y->unit, first->unit) == 0) continue;
    return strut_fail(error, STRUT_USAGE,
                      "columns '%.60s' and '%.60s' have different units (%s, %s): draw them in "
                      "separate figures",
                      first->name, y->name, *first->unit ? first->unit : "none",
                      *y->unit ? y->unit : "none");
  }
  return STRUT_OK;
}

/* The legend of all panels. Returns how many rows it has. */
static size_t name_entries(maker *m, char (*text)[200]) {
  strut_legend_entry *entries = m->entries;
  const strut_table_figure *f = m->figure;
  size_t used = 0;
  for (size_t c = 0; c < m->curves.count; c++)
    for (int k = 0; k < f->y_count; k++) {
      const char *column = m->table->columns[f->y[k]].name, *group = m->curves.name[c];
      if (m->curves.count * (size_t)f->y_count < 2) continue;
      if (!group) {
        snprintf(text[used], sizeof *text, "%s", column);
      } else {
        const strut_table_column *by = &m->table->columns[f->by];
        snprintf(text[used], sizeof *text, "%s%s%s %s%s%s", f->y_count > 1 ? column : "",
                 f->y_count > 1 ? ", " : "", by->name, group, by->value && *by->unit ? " " : "",
                 by->value ? by->unit : "");
      }
      entries[used] = (strut_legend_entry){.label = text[used],
                                           .look = c * (size_t)f->y_count + (size_t)k,
                                           .line = true,
                                           .marker = true};
      used++;
    }
  if (f->band != STRUT_NO_COLUMN) {
    snprintf(text[used], sizeof *text, "%s %s", axis_name(m->table, f->band), f->band_value);
    entries[used] =
        (strut_legend_entry){.label = text[used], .area = true, .fill = strut_band_fill()};
    used++;
  }
  return used;
}

static void draw_legend(void *context, strut_canvas *canvas, strut_box box) {
  maker *m = context;
  strut_draw_legend(canvas, m->entries, m->entry_count, box.width - INDENT, box.x + INDENT, box.y,
                    false);
}

static strut_status draw_page(maker *m, const char *path, strut_error *error) {
  strut_canvas *ruler = NULL;
  double size[2] = {0, 0};
  m->entries = strut_arena_allocate(&m->arena, MOST_ENTRIES, sizeof *m->entries);
  char(*text)[200] = strut_arena_allocate(&m->arena, MOST_ENTRIES, sizeof *text);
  if (!m->entries || !text) return strut_no_memory(error, "while drawing");
  m->entry_count = name_entries(m, text);
  strut_status status = strut_canvas_open_pixels(1, 1, 1, &ruler, error);
  if (status != STRUT_OK) return status;
  if (m->entry_count)
    strut_legend_size(ruler, m->entries, m->entry_count, m->figure->width - 10 - INDENT, size);
  strut_canvas_free(ruler);
  const strut_panel_page page = {.width = m->figure->width,
                                 .head = size[1],
                                 .least_width = PANEL_WIDTH,
                                 .aspect = ASPECT,
                                 .panels = m->panels.count};
  return strut_panel_page_draw(path, m->figure->title, &page, m->entry_count ? draw_legend : NULL,
                               draw_panel, m, error);
}

static strut_status draw_table(const char *path, const strut_table_figure *figure,
                               const strut_table *table, strut_error *error) {
  assert(figure->y_count > 0 && figure->y_count <= STRUT_MOST_Y);
  assert(figure->x >= 0 && (size_t)figure->x < table->column_count);
  maker m = {.figure = figure, .table = table};
  strut_status status = strut_table_numbers(table, figure->x, error);
  for (int k = 0; k < figure->y_count && status == STRUT_OK; k++)
    status = strut_table_numbers(table, figure->y[k], error);
  if (status == STRUT_OK) status = check_units(table, figure, error);
  if (status == STRUT_OK)
    status = strut_table_groups_find(table, figure->panels, STRUT_MOST_PANELS, "panels", &m.panels,
                                     error);
  if (status == STRUT_OK)
    status = strut_table_groups_find(table, figure->by, STRUT_MOST_TABLE_GROUPS, "curves",
                                     &m.curves, error);
  if (status == STRUT_OK) {
    status = find_axes(&m) ? draw_page(&m, path, error) : strut_no_memory(error, "while drawing");
  }
  strut_arena_free(&m.arena);
  return status;
}

strut_status strut_table_curves(const char *path, const strut_table_figure *figure,
                                const strut_table *table, strut_error *error) {
  strut_table_chosen chosen = {0};
  const strut_table_pairing pairing = {.keys = {figure->by, figure->panels, figure->x},
                                       .key_count = 3,
                                       .between = figure->between,
                                       .values = figure->y,
                                       .value_count = (size_t)figure->y_count};
  strut_status status = strut_table_choose(table, &figure->choice, pairing, &chosen, error);
  if (status == STRUT_OK) status = draw_table(path, figure, chosen.table, error);
  strut_table_chosen_free(&chosen);
  return status;
}

static const double SCATTER_ASPECT = 0.62, SCALE_WIDTH = 60, RADIUS = 2.6, RING = 5.0;

typedef struct scatter {
  const strut_scatter_figure *figure;
  const strut_table *table;
  strut_canvas *canvas;
  strut_axes axes;
  double low, high; /* of the colours */
  strut_beyond beyond;
} scatter;

static const double *values_of(const strut_table *table, int column) {
  return column >= 0 ? table->columns[column].value : NULL;
}

static strut_axis axis_of(const scatter *s, int column, const strut_axis_choice *choice) {
  const strut_table_column *c = &s->table->columns[column];
  strut_axis axis = {.name = c->name, .unit = c->unit, .low = (double)NAN, .high = (double)NAN};
  for (size_t i = 0; i < s->table->row_count; i++)
    if (s->figure->shown[i]) strut_axis_include(&axis, c->value[i]);
  strut_axis_settle(&axis, 0.04);
  strut_axis_choose(&axis, choice);
  return axis;
}

/* False: out of memory. */
static bool find_colours(scatter *s) {
  const double *value = values_of(s->table, s->figure->value);
  size_t known = 0;
  double *sorted = strut_allocate(s->table->row_count + 1, sizeof *sorted);
  if (!sorted) return false;
  s->low = HUGE_VAL, s->high = -HUGE_VAL;
  for (size_t i = 0; value && i < s->table->row_count; i++) {
    if (!s->figure->shown[i] || !isfinite(value[i])) continue;
    s->low = fmin(s->low, value[i]);
    s->high = fmax(s->high, value[i]);
    sorted[known++] = value[i];
  }
  strut_range_without_outliers(sorted, known, &s->low, &s->high, &s->beyond);
  strut_release(sorted);
  if (!(s->low < s->high)) s->high = s->low = 0.0;
  return true;
}

static strut_colours colours_of(const scatter *s) {
  return s->figure->colours == STRUT_COLOURS_AUTO ? STRUT_COLOURS_SEQUENTIAL : s->figure->colours;
}

static void draw_point(const scatter *s, size_t row, bool ring) {
  const double *x = values_of(s->table, s->figure->x), *y = values_of(s->table, s->figure->y);
  const double *value = values_of(s->table, s->figure->value);
  double at[2];
  if (!s->figure->shown[row] || !isfinite(x[row]) || !isfinite(y[row])) return;
  strut_axes_point(&s->axes, x[row], y[row], at);
  strut_fill fill = {.colour = strut_grey(0.75)}; /* without a value */
  if (!value)
    fill.colour = strut_palette_thing(0);
  else if (isfinite(value[row]))
    fill.colour = s->high > s->low ? strut_palette_at(colours_of(s), value[row], s->low, s->high)
                                   : strut_palette_thing(0);
  if (ring) {
    const strut_pen pen = {.colour = strut_grey(0), .width = 1.2};
    strut_draw_circle(s->canvas, at[0], at[1], RING, NULL, &pen);
  }
  strut_draw_circle(s->canvas, at[0], at[1], RADIUS, &fill, NULL);
}

static void draw(scatter *s) {
  const strut_scatter_figure *f = s->figure;
  strut_box box = strut_canvas_box(s->canvas);
  bool scale = s->high > s->low;
  strut_box left = {box.x, box.y, box.width - (scale ? SCALE_WIDTH : 0), box.height};
  s->axes = strut_axes_place(s->canvas, left, axis_of(s, f->x, &f->x_axis),
                             axis_of(s, f->y, &f->y_axis), f->title);
  strut_draw_axes(s->canvas, &s->axes, f->title);
  for (size_t i = 0; i < s->table->row_count; i++)
    if (!f->marked[i]) draw_point(s, i, false);
  for (size_t i = 0; i < s->table->row_count; i++)
    if (f->marked[i]) draw_point(s, i, true);
  if (!scale) return;
  const strut_table_column *c = &s->table->columns[f->value];
  const strut_box frame = s->axes.frame;
  strut_box right = {left.x + left.width + 8, frame.y, SCALE_WIDTH - 8, frame.height};
  strut_draw_colour_scale(
      s->canvas, right,
      &(strut_colour_scale){c->name, c->unit, s->low, s->high, colours_of(s), s->beyond});
}

strut_status strut_table_scatter(const char *path, const strut_scatter_figure *f,
                                 const strut_table *table, strut_error *error) {
  scatter s = {.figure = f, .table = table};
  if (f->x < 0 || f->y < 0 || !values_of(table, f->x) || !values_of(table, f->y) ||
      (f->value >= 0 && !values_of(table, f->value)))
    return strut_fail(error, STRUT_USAGE, "points are drawn over columns of numbers");
  strut_status status = strut_canvas_open(path, f->width, f->width * SCATTER_ASPECT,
                                          f->title ? f->title : "points", &s.canvas, error);
  if (status) return status;
  if (!find_colours(&s)) status = strut_no_memory(error, "while drawing");
  if (!status) draw(&s);
  if (!status) status = strut_canvas_commit(s.canvas, error);
  strut_canvas_free(s.canvas);
  return status;
}
