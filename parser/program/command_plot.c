/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/table_file.h"
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

static const char *column_name_at(const void *context, size_t i) {
  const strut_table *table = context;
  return i < table->column_count ? table->columns[i].name : NULL;
}

/* The column of that name, of `length` bytes; STRUT_NO_COLUMN with a message. */
static int find_column(const strut_arguments *arguments, const strut_table *table,
                       const char *option, const char *name, size_t length) {
  char word[200];
  int column = strut_table_column_of(table, name, length);
  if (column != STRUT_NO_COLUMN) return column;
  snprintf(word, sizeof word, "%.*s", (int)length, name);
  const char *near = strut_did_you_mean(word, column_name_at, table);
  strut_usage_error(arguments, "--%s: the table has no column '%s'%s%s%s", option, word,
                    near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
  return STRUT_NO_COLUMN;
}

/* Options that name a column, and where it goes. */
typedef struct column_choice {
  const char *option, *text;
  int *column;
  const char **value; /* of COLUMN=TEXT, else NULL */
} column_choice;

/* STRUT_USAGE with a message if the table has no such column. */
static strut_status read_columns(const strut_arguments *arguments, const strut_table *table,
                                 const column_choice *choices, size_t count) {
  for (const column_choice *c = choices; c < choices + count; c++) {
    if (!c->text) continue;
    size_t length = c->value ? strcspn(c->text, "=") : strlen(c->text);
    if (c->value && !c->text[length])
      return strut_usage_error(arguments, "--%s expects COLUMN=TEXT, not '%s'", c->option, c->text);
    if (c->value) *c->value = c->text + length + 1;
    *c->column = find_column(arguments, table, c->option, c->text, length);
    if (*c->column == STRUT_NO_COLUMN) return STRUT_USAGE;
  }
  return STRUT_OK;
}

static strut_status read_y(const strut_arguments *arguments, const strut_table *table,
                           strut_table_figure *figure) {
  figure->y_count = 1;
  figure->y[0] = table->column_count > 1 ? 1 : 0;
  if (!arguments->y) return STRUT_OK;
  figure->y_count = 0;
  for (const char *at = arguments->y;; at++) {
    size_t length = strcspn(at, ",");
    if (figure->y_count == STRUT_MOST_Y)
      return strut_usage_error(arguments, "--y: at most %d columns", STRUT_MOST_Y);
    int column = find_column(arguments, table, "y", at, length);
    if (column == STRUT_NO_COLUMN) return STRUT_USAGE;
    figure->y[figure->y_count++] = column;
    at += length;
    if (!*at) return STRUT_OK;
  }
}

/* Texts with commas between, in the table's arena. */
static strut_status read_labels(const strut_arguments *arguments, strut_table *table,
                                strut_table_figure *figure) {
  const char *at = arguments->labels;
  if (!at) return STRUT_OK;
  const char **labels = strut_arena_allocate(&table->arena, strlen(at) + 1, sizeof *labels);
  for (bool more = labels; more; more = *at++ == ',') {
    size_t length = strcspn(at, ",");
    labels[figure->label_count] = strut_arena_text(&table->arena, at, length);
    if (!labels[figure->label_count++]) return strut_print_out_of_memory();
    at += length;
  }
  figure->labels = labels;
  return labels ? STRUT_OK : strut_print_out_of_memory();
}

/* What the options choose of the table. */
static strut_status read_figure(const strut_arguments *arguments, strut_table *table,
                                strut_table_figure *figure) {
  bool map = arguments->kind.index == 1;
  const column_choice choices[] = {
      {"x", arguments->x, &figure->x, NULL},
      {"by", arguments->by, &figure->by, NULL},
      {"label", arguments->label, &figure->value, NULL},
      {"panels", arguments->panels, &figure->panels, NULL},
      {"doubt", arguments->doubt, &figure->doubt, NULL},
      {"band", arguments->band, &figure->band, &figure->band_value},
      {"only", arguments->only, &figure->choice.only, &figure->choice.only_value},
      {"difference", arguments->difference, &figure->choice.difference, NULL}};
  figure->kind = map ? STRUT_TABLE_MAP : STRUT_TABLE_CURVES;
  figure->log_x = arguments->log.text && arguments->log.index != 1;
  figure->log_y = arguments->log.text && arguments->log.index != 0;
  figure->colours = (strut_colours)arguments->colors.index;
  if (map && table->column_count > 2) figure->value = 2;
  strut_status status = read_columns(arguments, table, choices, sizeof choices / sizeof *choices);
  if (!status) status = read_y(arguments, table, figure);
  if (!status) status = read_labels(arguments, table, figure);
  if (!status && map && figure->value == STRUT_NO_COLUMN)
    status = strut_usage_error(arguments, "a map needs a third column");
  return status;
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
  strut_table_figure figure = STRUT_TABLE_FIGURE;
  strut_error error = {0};
  strut_status status = check_kind(arguments);
  if (status == STRUT_OK) status = strut_plot_read(arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  if (!plot.path) return strut_usage_error(arguments, "missing --plot FILE");
  status = strut_table_read(arguments->listener, arguments->model, &table);
  if (status != STRUT_OK) return status;
  status = read_figure(arguments, &table, &figure);
  if (!status) status = strut_axes_read(arguments, figure.log_x, figure.log_y, &plot.x, &plot.y);
  if (!status) status = strut_table_draw(&plot, &figure, &table, &error);
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
