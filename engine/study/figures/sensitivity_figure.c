/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Indices as bars with whiskers, or over an axis of the study. */
#include <math.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/figures/table_figure.h"
#include "engine/study/sensitivity/sensitivity.h"

static const double ROW = 26.0, FRAME = 40.0; /* of a parameter; around the frame [pt] */
static const double BAR = 0.32, CAP = 0.08;   /* a bar, half a whisker's end, of a row */
static const double LEAST = -0.1, MOST = 1.2;

/* The next result with indices at or after row i, in *first; how many parameters it has. */
static size_t find_result(const strut_sensitivity_result *result, size_t i, size_t *first) {
  const strut_sensitivity_row *rows = result->rows;
  size_t parameters = 0;
  while (i < result->count && rows[i].measure != STRUT_SENSITIVITY_FIRST_ORDER) i++;
  *first = i;
  for (; i + 1 < result->count && rows[i].of == rows[*first].of &&
         rows[i].measure == STRUT_SENSITIVITY_FIRST_ORDER;
       i += 2) /* the total follows each */
    parameters++;
  return parameters;
}

static void add_point(strut_series *series, double x, double y) {
  ((double *)series->x)[series->count] = fmin(MOST, fmax(LEAST, x));
  if (isnan(x)) ((double *)series->x)[series->count] = x;
  ((double *)series->y)[series->count++] = y;
}

static void add_line(strut_series *series, double x1, double y1, double x2, double y2) {
  add_point(series, x1, y1);
  add_point(series, x2, y2);
  add_point(series, (double)NAN, (double)NAN);
}

/* Bars of the first order and of the whole, the first parameter at the top, and their whiskers. */
static void add_bars(strut_series *series, const strut_sensitivity_row *row, double place) {
  for (int k = 0; k < 2; k++) {
    const strut_estimate *estimate = &row[k].estimate;
    double y = place + (k ? -0.5 : 0.5) * BAR;
    if (!isfinite(estimate->value)) continue;
    add_line(&series[k], 0, y, estimate->value, y);
    if (!isfinite(estimate->low) || !isfinite(estimate->high)) continue;
    add_line(&series[2], estimate->low, y, estimate->high, y);
    add_line(&series[2], estimate->low, y - CAP, estimate->low, y + CAP);
    add_line(&series[2], estimate->high, y - CAP, estimate->high, y + CAP);
  }
}

/* A panel of (count) parameters, from row `first` on. False: out of memory. */
static bool fill_bars(const strut_sensitivity_result *result, size_t first, size_t count,
                      strut_arena *arena, strut_panel *panel) {
  static const strut_pen pens[] = {{.colour = {0.16, 0.38, 0.62, 1.0}, .width = 8, .butt = true},
                                   {.colour = {0.65, 0.76, 0.87, 1.0}, .width = 8, .butt = true},
                                   {.colour = {0.15, 0.15, 0.15, 1.0}, .width = 0.7, .butt = true}};
  static const char *const labels[] = {"first order",
                                       "total, parts of the variance; whiskers: 95 %", NULL};
  strut_series *series = strut_arena_allocate(arena, 3, sizeof *series);
  const char **names = strut_arena_allocate(arena, count, sizeof *names);
  if (!series || !names) return false;
  for (int i = 0; i < 3; i++) {
    series[i] = (strut_series){.label = labels[i],
                               .x = strut_arena_allocate(arena, 18 * count, sizeof(double)),
                               .y = strut_arena_allocate(arena, 18 * count, sizeof(double)),
                               .pen = &pens[i]};
    if (!series[i].x || !series[i].y) return false;
  }
  for (size_t k = 0; k < count; k++) {
    const strut_sensitivity_row *row = &result->rows[first + 2 * k];
    names[count - 1 - k] = row->parameter;
    add_bars(series, row, (double)(count - 1 - k));
  }
  *panel = (strut_panel){.title = result->rows[first].of,
                         .x = {.high = MOST},
                         .y = {"", "", false, -0.6, (double)count - 0.4, names, count},
                         .series_count = 3,
                         .series = series,
                         .height = FRAME + ROW * (double)count};
  return true;
}

static strut_status draw_bars(const strut_plot *plot, const strut_sensitivity_result *result,
                              bool *drawn, strut_error *error) {
  strut_arena arena = {0};
  strut_panel *panels = strut_arena_allocate(&arena, result->count, sizeof *panels);
  strut_figure figure = {.panels = panels, .one_legend = true};
  bool fine = panels != NULL;
  size_t first = 0, count = 0;
  for (size_t i = 0; fine && (count = find_result(result, i, &first)); i = first + 2 * count)
    if (isfinite(result->rows[first].estimate.value))
      fine = fill_bars(result, first, count, &arena, &panels[figure.panel_count++]);
  *drawn = figure.panel_count > 0;
  strut_status status = fine ? STRUT_OK : strut_no_memory(error, "while drawing");
  if (!status && *drawn) status = strut_figure_draw(plot, &figure, error);
  strut_arena_free(&arena);
  return status;
}

/* ---- over an axis ---- */

enum { X, OF, PARAMETER, VALUE, COLUMNS };

/* The numbers of the axis that changes fastest, of those before the analysis; NULL: it has texts. */
static const strut_study_column *last_numbers(const strut_study *study, size_t *column) {
  size_t count = 0, last = study->sensitivity.axis;
  for (size_t i = 0; i < last; i++) count += study->axes[i].column_count;
  if (!count || study->axes[last - 1].columns[0].word) return NULL;
  *column = count - study->axes[last - 1].column_count;
  return &study->axes[last - 1].columns[0];
}

static double axis_value(strut_slots *slots, int64_t point, size_t column) {
  const strut_slots_description *plan = strut_slots_description_of(slots);
  strut_result_slot row;
  size_t at = 0;
  for (size_t i = 0; i < column; i++) at += !plan->columns[i].word;
  return strut_slots_get(slots, point, &row) ? row.numbers[at] : (double)NAN;
}

static strut_status draw_over(const strut_plot *plot, const strut_study *study, strut_slots *slots,
                              const strut_sensitivity_result *result, bool *drawn,
                              strut_error *error) {
  strut_table t = {.column_count = COLUMNS};
  size_t column = 0;
  const strut_study_column *study_column = last_numbers(study, &column);
  *drawn = false;
  if (!study_column) return STRUT_OK;
  double *value[2];
  const char **text[2];
  bool fine = true;
  for (int i = 0; i < 2; i++) {
    value[i] = strut_arena_allocate(&t.arena, result->count + 1, sizeof **value);
    text[i] = strut_arena_allocate(&t.arena, result->count + 1, sizeof **text);
    fine = fine && value[i] && text[i];
  }
  strut_table_column columns[COLUMNS] = {
      [X] = {.name = study_column->name,
             .unit = strcmp(study_column->unit, "1") ? study_column->unit : "",
             .value = value[0]},
      [OF] = {.name = "of", .unit = "", .text = text[0]},
      [PARAMETER] = {.name = "parameter", .unit = "", .text = text[1]},
      [VALUE] = {.name = "total index", .unit = "", .value = value[1]}};
  for (size_t i = 0; i < result->count && fine; i++) {
    const strut_sensitivity_row *row = &result->rows[i];
    if (row->measure != STRUT_SENSITIVITY_TOTAL && row->measure != STRUT_SENSITIVITY_SHARE)
      continue;
    value[0][t.row_count] = axis_value(slots, row->point, column);
    value[1][t.row_count] = row->estimate.value;
    text[0][t.row_count] = row->of;
    text[1][t.row_count++] = row->parameter ? row->parameter : "share";
  }
  *drawn = t.row_count > 0;
  t.columns = columns;
  strut_table_figure figure = STRUT_TABLE_FIGURE;
  figure.x = X, figure.y[0] = VALUE, figure.by = PARAMETER, figure.panels = OF;
  strut_status status = fine ? STRUT_OK : strut_no_memory(error, "while drawing");
  if (!status && *drawn) status = strut_table_draw(plot, &figure, &t, error);
  strut_arena_free(&t.arena);
  return status;
}

strut_status strut_sensitivity_figure(const strut_plot *plot, const strut_study *study,
                                      strut_slots *slots, const strut_sensitivity_result *result,
                                      bool *drawn, strut_error *error) {
  bool one = result->count && result->rows[0].point == result->rows[result->count - 1].point;
  return one ? draw_bars(plot, result, drawn, error)
             : draw_over(plot, study, slots, result, drawn, error);
}
