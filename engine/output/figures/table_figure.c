/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/figures/table_figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/draw/curves.h"
#include "engine/output/draw/curves_parts.h"
#include "engine/output/draw/key.h"
#include "engine/output/draw/palette.h"

static const double EDGE = 5, PANEL_WIDTH = 165, PANEL_HEIGHT = 165, TITLE = 15;
enum { MOST_GROUPS = 40 };

/* The different texts of a column, in their order. */
typedef struct groups {
  size_t count;
  const char *name[MOST_GROUPS];
} groups;

typedef struct maker {
  const strut_table_figure *figure;
  const strut_table *table;
  groups panels, curves;
  strut_axis x, y;
  size_t columns;
  strut_arena arena;
} maker;

static bool find_groups(const strut_table *table, int column, size_t most, groups *g) {
  g->count = 1;
  g->name[0] = NULL;
  if (column == STRUT_NO_COLUMN) return true;
  g->count = 0;
  for (size_t i = 0; i < table->row_count; i++) {
    const char *text = table->columns[column].text[i];
    size_t k = 0;
    while (k < g->count && strcmp(g->name[k], text) != 0) k++;
    if (k < g->count) continue;
    if (g->count == most) return false;
    g->name[g->count++] = text;
  }
  return true;
}

static bool belongs(const strut_table *table, int column, const char *name, size_t row) {
  return column == STRUT_NO_COLUMN || strcmp(table->columns[column].text[row], name) == 0;
}

/* Rows of one curve in one panel. Returns how many. */
static size_t rows_of(const maker *m, size_t panel, size_t curve, size_t *rows) {
  const strut_table_figure *f = m->figure;
  size_t count = 0;
  for (size_t i = 0; i < m->table->row_count; i++)
    if (belongs(m->table, f->panels, m->panels.name[panel], i) &&
        belongs(m->table, f->by, m->curves.name[curve], i))
      rows[count++] = i;
  return count;
}

/* Stretches of the rows that carry the band's text, reaching half way to their neighbours. */
static size_t find_bands(const maker *m, const size_t *rows, size_t count, strut_band *bands) {
  const strut_table_column *band = &m->table->columns[m->figure->band];
  const double *x = m->table->columns[m->figure->x].value;
  size_t found = 0;
  for (size_t i = 0; i < count; i++) {
    if (strcmp(band->text[rows[i]], m->figure->band_value) != 0) continue;
    size_t last = i;
    while (last + 1 < count && strcmp(band->text[rows[last + 1]], m->figure->band_value) == 0) last++;
    double low = x[rows[i]], high = x[rows[last]];
    if (i > 0) low = 0.5 * (low + x[rows[i - 1]]);
    if (last + 1 < count) high = 0.5 * (high + x[rows[last + 1]]);
    bands[found++] = (strut_band){.low = fmin(low, high), .high = fmax(low, high)};
    i = last;
  }
  return found;
}

static bool make_series(maker *m, const size_t *rows, size_t count, int column, size_t look,
                        strut_series *series) {
  double *x = strut_arena_allocate(&m->arena, count, sizeof *x);
  double *y = strut_arena_allocate(&m->arena, count, sizeof *y);
  if (!x || !y) return false;
  for (size_t k = 0; k < count; k++) {
    x[k] = m->table->columns[m->figure->x].value[rows[k]];
    y[k] = m->table->columns[column].value[rows[k]];
  }
  *series = (strut_series){.count = count, .x = x, .y = y, .look = (int)look};
  return true;
}

static const char *axis_name(const strut_table *table, int column) {
  return column == STRUT_NO_COLUMN ? "" : table->columns[column].name;
}

static strut_status draw_panel(maker *m, strut_canvas *canvas, strut_box box, size_t panel) {
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
      if (!make_series(m, rows, count, f->y[k], used, &series[used])) return STRUT_NO_MEMORY;
  }
  title[0] = '\0';
  if (f->panels != STRUT_NO_COLUMN)
    snprintf(title, sizeof title, "%c) %s = %s%s%s", (char)('a' + (int)(panel % 26)),
             m->table->columns[f->panels].name, m->panels.name[panel],
             *m->table->columns[f->panels].unit ? " " : "", m->table->columns[f->panels].unit);
  const strut_curves curves = {.title = title[0] ? title : NULL,
                               .x = m->x,
                               .y = m->y,
                               .series_count = used,
                               .series = series,
                               .band_count = bands,
                               .bands = band,
                               .cursor = NAN};
  return strut_draw_curves(canvas, box, &curves);
}

/* All panels share their axes. */
static void settle_axes(maker *m) {
  const strut_table_figure *f = m->figure;
  const strut_table_column *x = &m->table->columns[f->x], *y = &m->table->columns[f->y[0]];
  m->x = (strut_axis){x->name, x->unit, f->log_x, NAN, NAN};
  m->y = (strut_axis){f->y_count == 1 ? y->name : "", y->unit, f->log_y, NAN, NAN};
  for (size_t i = 0; i < m->table->row_count; i++)
    for (int k = 0; k < f->y_count; k++) {
      double value = m->table->columns[f->y[k]].value[i];
      if (!isfinite(value) || !isfinite(x->value[i])) continue;
      strut_axis_include(&m->x, x->value[i]);
      strut_axis_include(&m->y, value);
    }
  strut_axis_settle(&m->x, 0);
  strut_axis_settle(&m->y, 0.06);
}

/* The legend of all panels. Returns how many rows it has. */
static size_t name_entries(maker *m, strut_legend_entry *entries, char (*text)[200]) {
  const strut_table_figure *f = m->figure;
  size_t used = 0;
  for (size_t c = 0; c < m->curves.count; c++)
    for (int k = 0; k < f->y_count; k++) {
      const char *column = m->table->columns[f->y[k]].name, *group = m->curves.name[c];
      if (m->curves.count * (size_t)f->y_count < 2) continue;
      if (!group) {
        snprintf(text[used], sizeof *text, "%s", column);
      } else {
        snprintf(text[used], sizeof *text, "%s%s%s %s", f->y_count > 1 ? column : "",
                 f->y_count > 1 ? ", " : "", axis_name(m->table, f->by), group);
      }
      entries[used] = (strut_legend_entry){
          .label = text[used], .look = c * (size_t)f->y_count + (size_t)k, .line = true,
          .marker = true};
      used++;
    }
  if (f->band != STRUT_NO_COLUMN) {
    snprintf(text[used], sizeof *text, "%s %s", axis_name(m->table, f->band), f->band_value);
    entries[used] = (strut_legend_entry){
        .label = text[used], .area = true, .fill = strut_band_fill(0)};
    used++;
  }
  return used;
}

static strut_status draw(maker *m, const char *path, strut_error *error) {
  const strut_table_figure *f = m->figure;
  enum { MOST_ENTRIES = MOST_GROUPS * STRUT_MOST_Y + 1 };
  strut_legend_entry *entries = strut_arena_allocate(&m->arena, MOST_ENTRIES, sizeof *entries);
  char(*text)[200] = strut_arena_allocate(&m->arena, MOST_ENTRIES, sizeof *text);
  double inner = f->width - 2 * EDGE, legend[2] = {0, 0};
  strut_canvas *canvas = NULL, *ruler = NULL;
  if (!entries || !text) return strut_fail(error, STRUT_NO_MEMORY, "out of memory while drawing");
  size_t count = name_entries(m, entries, text);
  strut_status status = strut_canvas_open_pixels(1, 1, 1, &ruler, error);
  if (status != STRUT_OK) return status;
  if (count) strut_legend_size(ruler, entries, count, inner, legend);
  strut_canvas_free(ruler);
  m->columns = (size_t)fmax(1, fmin(3, floor(inner / PANEL_WIDTH)));
  if (m->columns > m->panels.count) m->columns = m->panels.count;
  size_t rows = (m->panels.count + m->columns - 1) / m->columns;
  double wide = inner / (double)m->columns, high = fmax(PANEL_HEIGHT, fmin(0.62 * wide, 260));
  double top = EDGE + (f->title ? TITLE : 0);
  status = strut_canvas_open(path, f->width, top + legend[1] + (double)rows * high + EDGE,
                             f->title ? f->title : "", &canvas, error);
  if (status != STRUT_OK) return status;
  strut_font font = {.size = 9, .bold = true};
  char fitted[STRUT_FITTED_TEXT];
  if (f->title)
    strut_draw_text(canvas, EDGE, EDGE, strut_text_fit(canvas, f->title, font, inner, 0, fitted), font);
  if (count) strut_draw_legend(canvas, entries, count, inner, EDGE + 30, top, false);
  for (size_t k = 0; k < m->panels.count && status == STRUT_OK; k++)
    status = draw_panel(m, canvas,
                        (strut_box){EDGE + (double)(k % m->columns) * wide,
                                    top + legend[1] + (double)(k / m->columns) * high, wide, high},
                        k);
  if (status != STRUT_OK) strut_fail(error, status, "out of memory while drawing");
  if (status == STRUT_OK) status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
  return status;
}

static strut_status check_numbers(const strut_table *table, int column, strut_error *error) {
  if (table->columns[column].value) return STRUT_OK;
  return strut_fail(error, STRUT_USAGE, "column '%s' does not hold numbers",
                    table->columns[column].name);
}

strut_status strut_table_curves(const char *path, const strut_table_figure *figure,
                                const strut_table *table, strut_error *error) {
  maker m = {.figure = figure, .table = table};
  strut_status status = check_numbers(table, figure->x, error);
  for (int k = 0; k < figure->y_count && status == STRUT_OK; k++)
    status = check_numbers(table, figure->y[k], error);
  if (status != STRUT_OK) return status;
  if (!find_groups(table, figure->panels, STRUT_MOST_PANELS, &m.panels))
    return strut_fail(error, STRUT_USAGE, "column '%s' makes more than %d panels",
                      table->columns[figure->panels].name, STRUT_MOST_PANELS);
  if (!find_groups(table, figure->by, MOST_GROUPS, &m.curves))
    return strut_fail(error, STRUT_USAGE, "column '%s' makes more than %d curves",
                      table->columns[figure->by].name, MOST_GROUPS);
  settle_axes(&m);
  status = draw(&m, path, error);
  strut_arena_free(&m.arena);
  return status;
}
