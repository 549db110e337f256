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
    {STRUT_FILLS(drawn.x), "x", "COLUMN", "column of the x axis (default: the first)"},
    {STRUT_FILLS(drawn.y), "y", "COLUMN,...", "columns of the y axis (default: the second)"},
    {STRUT_FILLS(drawn.series), "by", "COLUMN", "one curve for each value of the column"},
    {STRUT_FILLS(drawn.panels), "panels", "COLUMN", "one panel for each value of the column"},
    {STRUT_FILLS(drawn.band), "band", "COLUMN=TEXT", "grey background where COLUMN is TEXT"},
    {STRUT_FILLS(drawn.only), "only", "COLUMN=TEXT", "only rows in which COLUMN is TEXT"},
    {STRUT_FILLS(drawn.difference), "difference", "COLUMN",
     "draw the column's second text minus its first; hatch maps where they differ"},
    {STRUT_FILLS(drawn.color), "label", "COLUMN", "values of a map"},
    {STRUT_FILLS(drawn.doubt), "doubt", "COLUMN", "hatch a map where COLUMN is not 0"},
    {STRUT_FILLS(log), "log", "AXES", "logarithmic axes: x, y or xy", .words = "x|y|xy"},
    {STRUT_FILLS(labels), "labels", "TEXT,...", "what the legend calls the curves, in their order"},
    {STRUT_FILLS(title), "title", "TEXT", "title above the figure", .of_figure = true},
    {.table = strut_axis_options},
    {STRUT_FILLS(colors), "colors", "SCALE",
     "colour scale of a map: auto (default), sequential, diverging or grey",
     .words = "auto|sequential|diverging|grey"},
    {.name = NULL},
};

static const char *column_name_at(const void *context, size_t i) {
  const strut_table *table = context;
  return i < table->column_count ? table->columns[i].name : NULL;
}

/* Some row has the text of COLUMN=TEXT. */
static void judge_text(const void *context, size_t i, const strut_figure_key *key, const char *text,
                       char fault[STRUT_MESSAGE_MOST]) {
  const strut_table *table = context;
  const strut_table_column *column = &table->columns[i];
  for (size_t k = 0; k < table->row_count && *key->ends == '='; k++)
    if (strcmp(column->text[k], text) == 0) return;
  if (*key->ends == '=')
    snprintf(fault, STRUT_MESSAGE_MOST, "no row of the table has '%.60s' in column '%.60s'", text,
             column->name);
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
  const strut_figure_columns names = {"the table", column_name_at, judge_text, table};
  const strut_given_word *log = &arguments->log;
  char fault[STRUT_MESSAGE_MOST];
  bool map = arguments->kind.index == 1;
  *figure = arguments->drawn;
  figure->kind = map ? STRUT_FIGURE_MAP : STRUT_FIGURE_LINES;
  figure->log_x = log->text && log->index != 1, figure->log_y = log->text && log->index != 0;
  figure->colours = (strut_study_colours)arguments->colors.index;
  if (!figure->x) figure->x = columns[0].name;
  if (!figure->y) figure->y = columns[table->column_count > 1 ? 1 : 0].name;
  if (!figure->color && map && table->column_count > 2) figure->color = columns[2].name;
  const strut_figure_key *wrong = strut_figure_fault(figure, &names, fault);
  if (wrong) return strut_usage_error(arguments, "--%s: %s", wrong->option, fault);
  if (map && !figure->color) return strut_usage_error(arguments, "a map needs a third column");
  return read_labels(arguments, table, figure);
}

/* Refuses options that belong to the other kind of diagram. */
static strut_status check_kind(const strut_arguments *arguments) {
  const bool map = arguments->kind.index == 1;
  const strut_study_figure *drawn = &arguments->drawn;
  const struct {
    const char *option, *text;
    bool map;
  } own[] = {{"by", drawn->series, false},
             {"band", drawn->band, false},
             {"labels", arguments->labels, false},
             {"log", arguments->log.text, false},
             {"label", drawn->color, true},
             {"doubt", drawn->doubt, true},
             {"colors", arguments->colors.text, true}};
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    if (own[i].text && own[i].map != map)
      return strut_usage_error(arguments, "--kind %s has no option --%s", map ? "map" : "curves",
                               own[i].option);
  return STRUT_OK;
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
