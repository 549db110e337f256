/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/plot_options.h"
#include "parser/program/commands.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/table_figure.h"
#include "parser/language/yaml/diagnostics.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"

/* In the order of `draws`. */
static const char kinds[] = "curves|map";

static const strut_option options[] = {
    {STRUT_FILLS(plot), "plot", "FILE", "write the figure into FILE (.svg, .pdf, .png or .json)"},
    {.table = strut_width_options},
    {STRUT_FILLS(kind), "kind", "KIND", "curves (default) or map", .words = kinds},
    {STRUT_FILLS(x), "x", "COLUMN", "column of the x axis (default: the first)"},
    {STRUT_FILLS(y), "y", "COLUMN,...", "columns of the y axis (default: the second)"},
    {STRUT_FILLS(by), "by", "COLUMN", "one curve for each value of the column"},
    {STRUT_FILLS(panels), "panels", "COLUMN", "one panel for each value of the column"},
    {STRUT_FILLS(band), "band", "COLUMN=TEXT", "grey background where COLUMN is TEXT"},
    {STRUT_FILLS(only), "only", "COLUMN=TEXT", "only rows in which COLUMN is TEXT"},
    {STRUT_FILLS(difference), "difference", "COLUMN",
     "draw the column's second text minus its first; hatch maps where they differ"},
    {STRUT_FILLS(label), "label", "COLUMN", "values of a map"},
    {STRUT_FILLS(doubt), "doubt", "COLUMN", "hatch a map where COLUMN is not 0"},
    {STRUT_FILLS(log), "log", "AXES", "logarithmic axes: x, y or xy", .words = "x|y|xy"},
    {STRUT_FILLS(labels), "labels", "TEXT,...", "what the legend calls the curves, in their order"},
    {STRUT_FILLS(title), "title", "TEXT", "title above the figure", .of_figure = true},
    {.table = strut_axis_options},
    {STRUT_FILLS(colors), "colors", "SCALE",
     "colour scale of a map: auto (default), sequential, diverging or grey",
     .words = "auto|sequential|diverging|grey"},
    {.name = NULL},
};

/* STRUT_USAGE with a message if the table has no column of that name, of `length` bytes. */
static strut_status check_column(const strut_arguments *arguments, const strut_table *table,
                                 const char *option, const char *name, size_t length) {
  char word[200];
  if (strut_table_column_of(table, name, length) != STRUT_NO_COLUMN) return STRUT_OK;
  snprintf(word, sizeof word, "%.*s", (int)length, name);
  const strut_named_rows *columns = STRUT_NAMED(table->columns, table->column_count);
  return strut_usage_error(arguments, "--%s: the table has no column '%s'%s", option, word,
                           strut_near_to(word, strut_row_name, columns).text);
}

/* The same of all that options name. */
static strut_status check_columns(const strut_arguments *arguments, const strut_table *table,
                                  const strut_study_figure *f) {
  const struct {
    const char *option, *text, *before; /* NULL: not given, and what ends a name */
  } names[] = {{"x", f->x, ""},         {"by", f->series, ""},
               {"label", f->color, ""}, {"panels", f->panels, ""},
               {"doubt", f->doubt, ""}, {"band", f->band, "="},
               {"only", f->only, "="},  {"difference", f->difference, ""}};
  strut_status status = STRUT_OK;
  int count = 0;
  for (size_t i = 0; i < sizeof names / sizeof *names && !status; i++) {
    size_t length = names[i].text ? strcspn(names[i].text, names[i].before) : 0;
    if (!names[i].text) continue;
    if (*names[i].before && !names[i].text[length])
      return strut_usage_error(arguments, "--%s expects COLUMN=TEXT, not '%s'", names[i].option,
                               names[i].text);
    status = check_column(arguments, table, names[i].option, names[i].text, length);
  }
  for (const char *y = f->y, *end; y && !status; y = *end ? end + 1 : NULL) {
    end = y + strcspn(y, ",");
    if (count++ == STRUT_MOST_Y)
      return strut_usage_error(arguments, "--y: at most %d columns", STRUT_MOST_Y);
    status = check_column(arguments, table, "y", y, (size_t)(end - y));
  }
  return status;
}

/* Texts with commas between, in the table's arena. */
static strut_status read_labels(const strut_arguments *arguments, strut_table *table,
                                strut_study_figure *figure) {
  const char *at = arguments->labels;
  if (!at) return STRUT_OK;
  figure->labels = strut_arena_allocate(&table->arena, strlen(at) + 1, sizeof *figure->labels);
  for (bool more = figure->labels; more; more = *at++ == ',') {
    const char *label = strut_arena_text(&table->arena, at, strcspn(at, ","));
    if (!label) return strut_print_out_of_memory();
    figure->labels[figure->label_count++] = label;
    at += strlen(label);
  }
  return figure->labels ? STRUT_OK : strut_print_out_of_memory();
}

/* What the options choose of the table. */
static strut_status read_figure(const strut_arguments *arguments, strut_table *table,
                                strut_study_figure *figure) {
  const strut_table_column *columns = table->columns;
  bool map = arguments->kind.index == 1, third = map && table->column_count > 2;
  const char *second = columns[table->column_count > 1 ? 1 : 0].name;
  const strut_given_word *log = &arguments->log;
  *figure =
      (strut_study_figure){.kind = map ? STRUT_FIGURE_MAP : STRUT_FIGURE_LINES,
                           .x = arguments->x ? arguments->x : columns[0].name,
                           .y = arguments->y ? arguments->y : second,
                           .series = arguments->by,
                           .panels = arguments->panels,
                           .color = third && !arguments->label ? columns[2].name : arguments->label,
                           .doubt = arguments->doubt,
                           .band = arguments->band,
                           .only = arguments->only,
                           .difference = arguments->difference,
                           .log_x = log->text && log->index != 1,
                           .log_y = log->text && log->index != 0,
                           .colours = (strut_study_colours)arguments->colors.index};
  strut_status status = check_columns(arguments, table, figure);
  if (!status && map && !figure->color)
    status = strut_usage_error(arguments, "a map needs a third column");
  return status ? status : read_labels(arguments, table, figure);
}

/* Refuses options that belong to the other kind of diagram. */
static strut_status check_kind(const strut_arguments *arguments) {
  const bool map = arguments->kind.index == 1;
  const char *other = map ? (arguments->by         ? "by"
                             : arguments->band     ? "band"
                             : arguments->labels   ? "labels"
                             : arguments->log.text ? "log"
                                                   : NULL)
                          : (arguments->label         ? "label"
                             : arguments->doubt       ? "doubt"
                             : arguments->colors.text ? "colors"
                                                      : NULL);
  if (!other) return STRUT_OK;
  return strut_usage_error(arguments, "--kind %s has no option --%s", map ? "map" : "curves",
                           other);
}

static strut_status run_plot(const strut_arguments *arguments) {
  strut_plot plot;
  strut_table table;
  strut_study_figure figure;
  strut_error error = {0};
  strut_status status = check_kind(arguments);
  if (status == STRUT_OK) status = strut_plot_read(arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  if (!plot.path) return strut_usage_error(arguments, "missing --plot FILE");
  status = strut_table_read(arguments->listener, arguments->model, &table);
  if (status != STRUT_OK) return status;
  status = read_figure(arguments, &table, &figure);
  if (!status) status = strut_axes_read(arguments, figure.log_x, figure.log_y, &plot.x, &plot.y);
  if (!status) status = strut_table_draw(&plot, &figure, &table, (strut_table_marks){0}, &error);
  if (error.message[0]) strut_print_error(&error);
  strut_arena_free(&table.arena);
  return status;
}

const strut_command strut_command_plot = {
    .name = "plot",
    .model = "TABLE",
    .summary = "draws curves or a map from a table",
    .details =
        "\nTABLE is a CSV file with a header such as \"frequency [Hz],velocity [m/s],start\", as\n"
        "strut writes it, or - for the standard input. Units get prefixes, curves differ\n"
        "by colour, dashes and markers, and cells without a number break a curve.\n",
    .options = options,
    .run = run_plot,
};
