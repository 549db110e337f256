/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/plot_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/table_figure.h"
#include "parser/language/read/csv.h"
#include "parser/language/read/read_scene.h"
#include "parser/language/yaml/diagnostics.h"

const strut_option strut_width_options[] = {
    {STRUT_FILLS(width), "width", "WIDTH",
     "width of the figure: page (180 mm, default), column (88 mm) or a length", .of_figure = true,
     .words = "page|column"},
    {STRUT_FILLS(svg_text), "svg-text", NULL, "texts of an SVG can be edited, rather than outlines",
     .of_figure = true},
    {.name = NULL}};

const strut_option strut_plot_setting_options[] = {
    {.table = strut_width_options},
    {STRUT_FILLS(title), "title", "TEXT", "title of the figure (default: the model's name)",
     .of_figure = true},
    {.name = NULL}};

const strut_option strut_run_figure_options[] = {
    {STRUT_FILLS(draw), "draw", "WHAT", "overview (default), period, snapshots or curves",
     .of_figure = true, .words = "overview|period|snapshots|curves"},
    {STRUT_FILLS(scale), "scale", "X,Y", "magnification of the motion in the figure period"},
    {STRUT_FILLS(times), "times", "TIME,...", "instants of the snapshots, such as 0 s,80 ms"},
    {.name = NULL}};

const strut_option strut_axis_options[] = {
    {STRUT_FILLS(x_label), "x-label", "TEXT", "label of the x axis, without unit",
     .of_figure = true},
    {STRUT_FILLS(y_label), "y-label", "TEXT", "label of the (left) y axis, without unit",
     .of_figure = true},
    {STRUT_FILLS(x_limits), "x-limits", "LOW,HIGH", "range of the x axis, in its base unit",
     .of_figure = true},
    {STRUT_FILLS(y_limits), "y-limits", "LOW,HIGH", "range of the (left) y axis, likewise",
     .of_figure = true},
    {.name = NULL}};

static const double POINTS = 72.0 / 0.0254;                                      /* in a metre */
static const double PAGE = 0.18, COLUMN = 0.088, NARROWEST = 0.04, WIDEST = 1.0; /* [m] */

strut_status strut_plot_settings_read(const strut_arguments *arguments, double usual,
                                      strut_plot *plot) {
  const char *text = arguments->width;
  bool column = text && strcmp(text, "column") == 0, page = !text || strcmp(text, "page") == 0;
  double width = column ? COLUMN : PAGE;
  plot->title = arguments->title;
  plot->texts = arguments->svg_text;
  if (!column && !page) {
    strut_status status = strut_quantity_read(arguments, "width", text, STRUT_DIM_LENGTH, &width);
    if (status) return status;
  }
  if (!(width >= NARROWEST && width <= WIDEST))
    return strut_usage_error(arguments, "--width %s: expected a width between 40 mm and 1 m", text);
  plot->width = text || !(usual > 0) ? width * POINTS : usual;
  return strut_axes_read(arguments, false, false, &plot->x, &plot->y);
}

static strut_status read_limits(const strut_arguments *arguments, char letter, bool logarithmic,
                                strut_axis_choice *axis) {
  const char *text = letter == 'x' ? arguments->x_limits : arguments->y_limits;
  double range[2];
  if (!text) return STRUT_OK;
  axis->limited = strut_quantities_read(text, STRUT_DIM_NONE, range, 2) == 2 &&
                  range[0] < range[1] && (!logarithmic || range[0] > 0);
  if (!axis->limited)
    return strut_usage_error(arguments,
                             "--%c-limits expects two ascending numbers%s, such as 1,10; not '%s'",
                             letter, logarithmic ? " above 0" : "", text);
  axis->low = range[0];
  axis->high = range[1];
  return STRUT_OK;
}

strut_status strut_axes_read(const strut_arguments *arguments, bool log_x, bool log_y,
                             strut_axis_choice *choice, strut_axis_choice *other_choice) {
  *choice = (strut_axis_choice){.label = arguments->x_label};
  *other_choice = (strut_axis_choice){.label = arguments->y_label};
  strut_status status = read_limits(arguments, 'x', log_x, choice);
  return status ? status : read_limits(arguments, 'y', log_y, other_choice);
}

/* ---- of runs ---- */

strut_status strut_run_figure_read(const strut_arguments *arguments, strut_run_figure *figure,
                                   double *times) {
  const char *scale = arguments->scale, *text = arguments->times;
  figure->view = (strut_run_view)arguments->draw.index;
  if (scale && !(figure->plot.path && figure->view == STRUT_RUN_PERIOD))
    return strut_usage_error(arguments, "--scale goes with --plot FILE --draw period");
  if (scale && !(strut_quantities_read(scale, STRUT_DIM_NONE, figure->scale, 2) == 2 &&
                 figure->scale[0] > 0 && figure->scale[1] > 0))
    return strut_usage_error(arguments,
                             "--scale expects two numbers above 0, such as 10,2; not '%s'", scale);
  if (!text) return STRUT_OK;
  if (!(figure->plot.path && figure->view == STRUT_RUN_SNAPSHOTS))
    return strut_usage_error(arguments, "--times goes with --plot FILE --draw snapshots");
  figure->time_count = strut_quantities_read(text, STRUT_DIM_TIME, times, STRUT_MOST_TIMES);
  figure->times = times;
  if (figure->time_count > 0) return STRUT_OK;
  return strut_usage_error(
      arguments,
      "--times expects up to %d times with a comma between, such as \"0 s, 80 ms\"; not '%s'",
      STRUT_MOST_TIMES, text);
}

/* ---- of tables ---- */

#define KEY(NAME, OPTION, ...) NAME, OPTION, offsetof(strut_study_figure, __VA_ARGS__)
static const strut_figure_key keys[] = {{KEY("x", "x", x), "", true},
                                        {KEY("y", "y", y), ",", true},
                                        {KEY("series", "by", series), "", false},
                                        {KEY("color", "label", color), "", false},
                                        {KEY("panels", "panels", panels), "", false},
                                        {KEY("doubt", "doubt", doubt), "", false},
                                        {KEY("difference", "difference", difference), "", false},
                                        {KEY("band", "band", band), "=", false},
                                        {KEY("only", "only", only), "=", false}};

/* Judges one name of `length` bytes; what follows it is `text`. */
static void judge_name(const strut_figure_columns *columns, const strut_figure_key *key,
                       const char *name, size_t length, char fault[STRUT_MESSAGE_MOST]) {
  const char *other;
  char word[200];
  for (size_t i = 0; (other = columns->name(columns->context, i)); i++) {
    if (strlen(other) != length || memcmp(other, name, length) != 0) continue;
    columns->judge(columns->context, i, key, name + length + 1, fault);
    return;
  }
  snprintf(word, sizeof word, "%.*s", (int)length, name);
  const char *near = strut_did_you_mean(word, columns->name, columns->context);
  snprintf(fault, STRUT_MESSAGE_MOST, "%s has no column '%s'%s%s%s", columns->of, word,
           near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

const strut_figure_key *strut_figure_fault(const strut_study_figure *figure,
                                           const strut_figure_columns *columns,
                                           char fault[STRUT_MESSAGE_MOST]) {
  fault[0] = '\0';
  for (const strut_figure_key *key = keys; key < keys + sizeof keys / sizeof *keys; key++) {
    const char *name = *(const char *const *)((const char *)figure + key->member), *end;
    for (int count = 1; name && !fault[0]; name = *end == ',' ? end + 1 : NULL, count++) {
      end = name + strcspn(name, key->ends);
      if (*key->ends == '=' && !*end)
        snprintf(fault, STRUT_MESSAGE_MOST, "expects COLUMN=TEXT, not '%.200s'", name);
      else if (count > STRUT_MOST_Y)
        snprintf(fault, STRUT_MESSAGE_MOST, "at most %d columns", STRUT_MOST_Y);
      else
        judge_name(columns, key, name, (size_t)(end - name), fault);
    }
    if (fault[0]) return key;
  }
  return NULL;
}

enum { MOST_MESSAGES = 20 };

static bool fill_column(const strut_csv *csv, strut_table *table, size_t i) {
  const char **text = strut_arena_allocate(&table->arena, table->row_count, sizeof *text);
  double *value = strut_arena_allocate(&table->arena, table->row_count, sizeof *value);
  bool numbers = true, some = false;
  if (!text || !value) return false;
  for (size_t k = 0; k < table->row_count; k++) {
    text[k] = csv->cell[(k + 1) * table->column_count + i];
    numbers = numbers && strut_csv_number(text[k], 0, &value[k]);
    some = some || (numbers && !isnan(value[k]));
  }
  table->columns[i].name = csv->titles[i].name;
  table->columns[i].unit = csv->titles[i].unit;
  table->columns[i].text = text;
  table->columns[i].value = numbers && some ? value : NULL;
  return true;
}

/* The table takes over the cells. */
static bool make_columns(strut_csv *csv, strut_table *table) {
  table->arena = csv->arena;
  csv->arena = (strut_arena){0};
  table->column_count = csv->column_count;
  table->row_count = csv->row_count;
  table->columns = strut_arena_allocate(&table->arena, table->column_count, sizeof *table->columns);
  bool good = table->columns;
  for (size_t i = 0; i < table->column_count && good; i++) good = fill_column(csv, table, i);
  return good;
}

strut_status strut_table_read(const strut_listener *listener, const char *path,
                              strut_table *table) {
  char *text;
  size_t length;
  strut_error error = {0};
  strut_diagnostics diagnostics = {0};
  strut_csv csv;
  *table = (strut_table){0};
  strut_status status = strut_file_read(path, &text, &length, &error);
  if (status) return strut_tell_failure(listener, status, &error);
  strut_diagnostics_source(&diagnostics, strcmp(path, "-") == 0 ? "<stdin>" : path, text, length);
  status = strut_csv_read(text, length, STRUT_CSV_ANY_HEADER, &diagnostics, &csv);
  if (status == STRUT_OK && !make_columns(&csv, table)) status = STRUT_NO_MEMORY;
  if (status == STRUT_BAD_SCENE) {
    const char *messages = strut_diagnostics_render(&diagnostics, MOST_MESSAGES);
    if (strut_tell_lines(listener, messages)) status = STRUT_NO_MEMORY;
  } else {
    strut_tell_failure(listener, status, NULL);
  }
  strut_diagnostics_free(&diagnostics);
  strut_arena_free(&csv.arena);
  strut_release(text);
  if (status != STRUT_OK) strut_arena_free(&table->arena);
  return status;
}
