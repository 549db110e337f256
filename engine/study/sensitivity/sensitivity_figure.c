/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Indices as bars with whiskers, or over an axis of the study. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/draw/canvas.h"
#include "engine/output/draw/chart.h"
#include "engine/output/figures/table_figure.h"
#include "engine/study/sensitivity/sensitivity.h"

/* [pt] */
static const double EDGE = 6.0, ROW = 26.0, BAR = 8.0, HEAD = 34.0, FOOT = 34.0, WHISKER = 2.5;
static const strut_colour FIRST = {0.16, 0.38, 0.62, 1.0}, WHOLE = {0.65, 0.76, 0.87, 1.0};
static const strut_colour INK = {0.15, 0.15, 0.15, 1.0}, GRID = {0.85, 0.85, 0.85, 1.0};

typedef struct panel {
  const strut_sensitivity_result *result;
  const char *of;
  size_t first, parameters; /* its first row of indices; how many parameters */
} panel;

/* The next result with indices at or after row i; NULL of: none. */
static panel find_panel(const strut_sensitivity_result *result, size_t i) {
  panel p = {.result = result};
  while (i < result->count && result->rows[i].measure != STRUT_SENSITIVITY_FIRST_ORDER) i++;
  if (i == result->count) return p;
  p.of = result->rows[i].of;
  p.first = i;
  while (i + 1 < result->count && result->rows[i].of == p.of &&
         result->rows[i].measure == STRUT_SENSITIVITY_FIRST_ORDER) {
    p.parameters++;
    i += 2; /* the total follows each */
  }
  return p;
}

static bool is_known(const panel *p) { return isfinite(p->result->rows[p->first].estimate.value); }

static double place(double left, double width, double value) {
  return left + width * fmin(1.2, fmax(-0.1, value)) / 1.2;
}

static void draw_bar(strut_canvas *canvas, double left, double width, double y, strut_colour colour,
                     const strut_estimate *e) {
  const strut_fill fill = {.colour = colour};
  const strut_pen pen = {.colour = INK, .width = 0.7};
  if (!isfinite(e->value)) return;
  double from = place(left, width, 0.0), to = place(left, width, e->value);
  strut_draw_box(canvas, (strut_box){fmin(from, to), y, fabs(to - from), BAR}, &fill, NULL);
  if (!isfinite(e->low) || !isfinite(e->high)) return;
  double low = place(left, width, e->low), high = place(left, width, e->high), m = y + BAR / 2.0;
  strut_draw_segment(canvas, low, m, high, m, pen);
  strut_draw_segment(canvas, low, m - WHISKER, low, m + WHISKER, pen);
  strut_draw_segment(canvas, high, m - WHISKER, high, m + WHISKER, pen);
}

static double label_width(strut_canvas *canvas, const strut_sensitivity_result *result) {
  double most = 30.0, width, height;
  for (size_t i = 0; i < result->count; i++) {
    if (!result->rows[i].parameter) continue;
    strut_text_size(canvas, result->rows[i].parameter, (strut_font){0}, &width, &height);
    most = fmax(most, width);
  }
  return most;
}

static double draw_panel(strut_canvas *canvas, const panel *p, double left, double width,
                         double top) {
  double bottom = top + HEAD + ROW * (double)p->parameters;
  const strut_pen grid = {.colour = GRID, .width = 0.5};
  strut_draw_text(canvas, left, top + 6.0, p->of, (strut_font){.bold = true});
  for (int i = 0; i <= 5; i++) {
    char text[16];
    double x = place(left, width, 0.2 * i);
    snprintf(text, sizeof text, "%.1f", 0.2 * i);
    strut_draw_segment(canvas, x, top + HEAD - 8.0, x, bottom, grid);
    strut_draw_text(canvas, x, bottom + 3.0, text, (strut_font){.across = 0.5});
  }
  for (size_t k = 0; k < p->parameters; k++) {
    const strut_sensitivity_row *row = &p->result->rows[p->first + 2 * k];
    double y = top + HEAD + ROW * (double)k;
    strut_draw_text(canvas, left - 6.0, y + BAR, row->parameter,
                    (strut_font){.across = 1.0, .down = 0.5});
    draw_bar(canvas, left, width, y, FIRST, &row[0].estimate);
    draw_bar(canvas, left, width, y + BAR, WHOLE, &row[1].estimate);
  }
  return bottom + FOOT - 14.0;
}

static void draw_legend(strut_canvas *canvas, double left, double y) {
  const strut_fill fills[] = {{.colour = FIRST}, {.colour = WHOLE}};
  const char *const texts[] = {"first order", "total, parts of the variance; whiskers: 95 %"};
  for (int i = 0; i < 2; i++) {
    double x = left + 70.0 * i;
    strut_draw_box(canvas, (strut_box){x, y, 10.0, BAR}, &fills[i], NULL);
    strut_draw_text(canvas, x + 14.0, y + BAR / 2.0, texts[i], (strut_font){.down = 0.5});
  }
}

static strut_status draw_bars(const strut_study *study, const strut_sensitivity_result *result,
                              const char *path, double width, bool *drawn, strut_error *error) {
  strut_canvas *canvas = NULL;
  double height = 2.0 * EDGE + 14.0;
  *drawn = false;
  for (panel p = find_panel(result, 0); p.of; p = find_panel(result, p.first + 2 * p.parameters)) {
    if (!is_known(&p)) continue;
    height += HEAD + FOOT - 14.0 + ROW * (double)p.parameters;
    *drawn = true;
  }
  if (!*drawn) return STRUT_OK;
  strut_status status = strut_canvas_open(path, width, height, study->name, &canvas, error);
  if (status) return status;
  double left = EDGE + label_width(canvas, result) + 8.0, y = EDGE + 14.0;
  draw_legend(canvas, left, EDGE);
  for (panel p = find_panel(result, 0); p.of; p = find_panel(result, p.first + 2 * p.parameters))
    if (is_known(&p)) y = draw_panel(canvas, &p, left, width - left - EDGE, y);
  status = strut_canvas_commit(canvas, error);
  strut_canvas_free(canvas);
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

static strut_status draw_over(const strut_study *study, strut_slots *slots,
                              const strut_sensitivity_result *result, const char *path,
                              double width, bool *drawn, strut_error *error) {
  strut_table t = {.column_count = COLUMNS};
  size_t column = 0;
  const strut_study_column *x = last_numbers(study, &column);
  strut_table_column columns[COLUMNS] = {
      [X] = {.name = x ? x->name : "", .unit = x && strcmp(x->unit, "1") != 0 ? x->unit : ""},
      [OF] = {.name = "of", .unit = ""},
      [PARAMETER] = {.name = "parameter", .unit = ""},
      [VALUE] = {.name = "total index", .unit = ""}};
  *drawn = false;
  if (!x) return STRUT_OK;
  double *numbers[2] = {strut_arena_allocate(&t.arena, result->count + 1, sizeof(double)),
                        strut_arena_allocate(&t.arena, result->count + 1, sizeof(double))};
  const char **texts[2] = {strut_arena_allocate(&t.arena, result->count + 1, sizeof(char *)),
                           strut_arena_allocate(&t.arena, result->count + 1, sizeof(char *))};
  strut_status status = numbers[0] && numbers[1] && texts[0] && texts[1]
                            ? STRUT_OK
                            : strut_no_memory(error, "while drawing");
  for (size_t i = 0; i < result->count && !status; i++) {
    const strut_sensitivity_row *r = &result->rows[i];
    if (r->measure != STRUT_SENSITIVITY_TOTAL && r->measure != STRUT_SENSITIVITY_SHARE) continue;
    numbers[0][t.row_count] = axis_value(slots, r->point, column);
    numbers[1][t.row_count] = r->estimate.value;
    texts[0][t.row_count] = r->of;
    texts[1][t.row_count++] = r->parameter ? r->parameter : "share";
    *drawn = true;
  }
  columns[X].value = numbers[0], columns[VALUE].value = numbers[1];
  columns[OF].text = texts[0], columns[PARAMETER].text = texts[1];
  t.columns = columns;
  const strut_table_figure figure = {
      .width = width,
      .x = X,
      .y = {VALUE},
      .y_count = 1,
      .by = PARAMETER,
      .panels = OF,
      .band = STRUT_NO_COLUMN,
      .choice = {.only = STRUT_NO_COLUMN, .difference = STRUT_NO_COLUMN}};
  if (!status && *drawn) status = strut_table_curves(path, &figure, &t, error);
  strut_arena_free(&t.arena);
  return status;
}

strut_status strut_sensitivity_figure(const strut_study *study, strut_slots *slots,
                                      const strut_sensitivity_result *result, const char *path,
                                      double width, bool *drawn, strut_error *error) {
  strut_c_locale locale = strut_c_locale_enter();
  bool one = result->count && result->rows[0].point == result->rows[result->count - 1].point;
  strut_status status = one ? draw_bars(study, result, path, width, drawn, error)
                            : draw_over(study, slots, result, path, width, drawn, error);
  strut_c_locale_leave(locale);
  return status;
}
