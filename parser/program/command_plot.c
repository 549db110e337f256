/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/figures/table_figure.h"
#include "parser/program/options.h"
#include "parser/program/streams.h"
#include "parser/yaml/diagnostics.h"

static const strut_option options[] = {
    {STRUT_OPTION_PLOT, "plot", "FILE", "write the figure into FILE (.svg, .pdf or .png)"},
    {STRUT_OPTION_WIDTH, "width", "WIDTH",
     "width of the figure: page (180 mm, default), column (88 mm) or a length"},
    {STRUT_OPTION_KIND, "kind", "KIND", "curves (default) or map"},
    {STRUT_OPTION_X, "x", "COLUMN", "column of the x axis (default: the first)"},
    {STRUT_OPTION_Y, "y", "COLUMN,...", "columns of the y axis (default: the second)"},
    {STRUT_OPTION_BY, "by", "COLUMN", "one curve for each value of the column"},
    {STRUT_OPTION_PANELS, "panels", "COLUMN", "one panel for each value of the column"},
    {STRUT_OPTION_BAND, "band", "COLUMN=TEXT", "grey background where COLUMN is TEXT"},
    {STRUT_OPTION_ONLY, "only", "COLUMN=TEXT", "only rows in which COLUMN is TEXT"},
    {STRUT_OPTION_DIFFERENCE, "difference", "COLUMN",
     "draw the column's second text minus its first; hatch maps where they differ"},
    {STRUT_OPTION_LABEL, "label", "COLUMN", "values of a map"},
    {STRUT_OPTION_DOUBT, "doubt", "COLUMN", "hatch a map where COLUMN is not 0"},
    {STRUT_OPTION_LOG, "log", "AXES", "logarithmic axes: x, y or xy"},
    {STRUT_OPTION_TITLE, "title", "TEXT", "title above the figure"},
    STRUT_AXIS_OPTIONS,
    {STRUT_OPTION_COLORS, "colors", "SCALE",
     "colour scale of a map: auto (default), sequential, diverging or grey"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static const char *column_name_at(const void *context, size_t i) {
  const strut_table *table = context;
  return i < table->column_count ? table->columns[i].name : NULL;
}

/* The column of that name, of `length` bytes; STRUT_NO_COLUMN with a message. */
static int find_column(const strut_table *table, const char *option, const char *name,
                       size_t length) {
  char word[200];
  for (size_t i = 0; i < table->column_count; i++)
    if (strlen(table->columns[i].name) == length &&
        memcmp(table->columns[i].name, name, length) == 0)
      return (int)i;
  snprintf(word, sizeof word, "%.*s", (int)length, name);
  const char *near = strut_did_you_mean(word, column_name_at, table);
  fprintf(stderr, "strut plot: --%s: the table has no column '%s'", option, word);
  if (near) fprintf(stderr, "; did you mean '%s'?", near);
  fputc('\n', stderr);
  return STRUT_NO_COLUMN;
}

/* Reads an option that names a column: false with a message if the table has no such column. */
static bool read_column(const strut_arguments *arguments, const strut_table *table,
                        strut_option_id id, const char *option, int *column) {
  const char *text = strut_option_text(arguments, id);
  if (!text) return true;
  *column = find_column(table, option, text, strlen(text));
  return *column != STRUT_NO_COLUMN;
}

static bool read_y(const strut_arguments *arguments, const strut_table *table,
                   strut_table_figure *figure) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_Y);
  figure->y_count = 1;
  figure->y[0] = table->column_count > 1 ? 1 : 0;
  if (!text) return true;
  figure->y_count = 0;
  for (const char *at = text;; at++) {
    size_t length = strcspn(at, ",");
    if (figure->y_count == STRUT_MOST_Y) {
      fprintf(stderr, "strut plot: --y: at most %d columns\n", STRUT_MOST_Y);
      return false;
    }
    int column = find_column(table, "y", at, length);
    if (column == STRUT_NO_COLUMN) return false;
    figure->y[figure->y_count++] = column;
    at += length;
    if (!*at) return true;
  }
}

/* COLUMN=TEXT. */
static bool read_match(const strut_arguments *arguments, const strut_table *table,
                       strut_option_id id, const char *option, int *column, const char **value) {
  const char *text = strut_option_text(arguments, id);
  if (!text) return true;
  const char *equals = strchr(text, '=');
  if (!equals) {
    fprintf(stderr, "strut plot: --%s expects COLUMN=TEXT, not '%s'\n", option, text);
    return false;
  }
  *column = find_column(table, option, text, (size_t)(equals - text));
  *value = equals + 1;
  return *column != STRUT_NO_COLUMN;
}

static bool read_choice(const strut_arguments *arguments, const strut_table *table,
                        strut_table_choice *choice) {
  return read_match(arguments, table, STRUT_OPTION_ONLY, "only", &choice->only,
                    &choice->only_value) &&
         read_column(arguments, table, STRUT_OPTION_DIFFERENCE, "difference", &choice->difference);
}

static bool read_log(const strut_arguments *arguments, strut_table_figure *figure) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_LOG);
  if (!text) return true;
  figure->log_x = strcmp(text, "x") == 0 || strcmp(text, "xy") == 0;
  figure->log_y = strcmp(text, "y") == 0 || strcmp(text, "xy") == 0;
  if (figure->log_x || figure->log_y) return true;
  fprintf(stderr, "strut plot: --log expects x, y or xy, not '%s'\n", text);
  return false;
}

/* Words of --colors, in the order of strut_colours. */
static const char *const scales[] = {"auto", "sequential", "diverging", "grey", NULL};

static strut_status draw_map(const strut_arguments *arguments, const strut_plot *plot,
                             const strut_table *table, strut_error *error) {
  int third = table->column_count > 2 ? 2 : STRUT_NO_COLUMN;
  strut_table_map_figure figure = {.title = strut_option_text(arguments, STRUT_OPTION_TITLE),
                                   .width = plot->width,
                                   .y = table->column_count > 1 ? 1 : 0,
                                   .value = third,
                                   .panels = STRUT_NO_COLUMN,
                                   .doubt = STRUT_NO_COLUMN,
                                   .choice = STRUT_TABLE_ALL};
  bool good = read_column(arguments, table, STRUT_OPTION_X, "x", &figure.x) &&
              read_column(arguments, table, STRUT_OPTION_Y, "y", &figure.y) &&
              read_column(arguments, table, STRUT_OPTION_LABEL, "label", &figure.value) &&
              read_column(arguments, table, STRUT_OPTION_PANELS, "panels", &figure.panels) &&
              read_column(arguments, table, STRUT_OPTION_DOUBT, "doubt", &figure.doubt) &&
              read_choice(arguments, table, &figure.choice) &&
              strut_axes_read(&strut_command_plot, arguments, false, false, &figure.x_axis,
                              &figure.y_axis) == STRUT_OK;
  int colours = STRUT_COLOURS_AUTO;
  if (good && strut_option_word(&strut_command_plot, arguments, STRUT_OPTION_COLORS, scales,
                                &colours) != STRUT_OK)
    return STRUT_USAGE;
  figure.colours = (strut_colours)colours;
  if (good && figure.value == STRUT_NO_COLUMN) {
    fprintf(stderr, "strut plot: a map needs a third column\n");
    good = false;
  }
  return good ? strut_table_map(plot->path, &figure, table, error) : STRUT_USAGE;
}

static strut_status draw_curves(const strut_arguments *arguments, const strut_plot *plot,
                                const strut_table *table, strut_error *error) {
  strut_table_figure figure = {.title = strut_option_text(arguments, STRUT_OPTION_TITLE),
                               .width = plot->width,
                               .by = STRUT_NO_COLUMN,
                               .panels = STRUT_NO_COLUMN,
                               .band = STRUT_NO_COLUMN,
                               .choice = STRUT_TABLE_ALL};
  bool good =
      read_column(arguments, table, STRUT_OPTION_X, "x", &figure.x) &&
      read_y(arguments, table, &figure) &&
      read_column(arguments, table, STRUT_OPTION_BY, "by", &figure.by) &&
      read_column(arguments, table, STRUT_OPTION_PANELS, "panels", &figure.panels) &&
      read_match(arguments, table, STRUT_OPTION_BAND, "band", &figure.band, &figure.band_value) &&
      read_choice(arguments, table, &figure.choice) && read_log(arguments, &figure) &&
      strut_axes_read(&strut_command_plot, arguments, figure.log_x, figure.log_y, &figure.x_axis,
                      &figure.y_axis) == STRUT_OK;
  return good ? strut_table_curves(plot->path, &figure, table, error) : STRUT_USAGE;
}

/* Kinds of diagrams, and the options that belong to some of them only. */
static const char *const kinds[] = {"curves", "map", NULL};
static strut_status (*const draws[])(const strut_arguments *arguments, const strut_plot *plot,
                                     const strut_table *table,
                                     strut_error *error) = {draw_curves, draw_map};
static const struct {
  strut_option_id id;
  const char *name;
  unsigned kinds; /* a bit for each that has it */
} limited[] = {
    {STRUT_OPTION_BY, "by", 1},         {STRUT_OPTION_PANELS, "panels", 3},
    {STRUT_OPTION_BAND, "band", 1},     {STRUT_OPTION_LABEL, "label", 2},
    {STRUT_OPTION_DOUBT, "doubt", 2},   {STRUT_OPTION_LOG, "log", 1},
    {STRUT_OPTION_ONLY, "only", 3},     {STRUT_OPTION_DIFFERENCE, "difference", 3},
    {STRUT_OPTION_COLORS, "colors", 2},
};

static strut_status read_kind(const strut_arguments *arguments, int *kind) {
  strut_status status =
      strut_option_word(&strut_command_plot, arguments, STRUT_OPTION_KIND, kinds, kind);
  for (size_t i = 0; i < sizeof limited / sizeof *limited && status == STRUT_OK; i++) {
    if (!strut_option_text(arguments, limited[i].id) || limited[i].kinds >> *kind & 1) continue;
    fprintf(stderr, "strut plot: --kind %s has no option --%s\n", kinds[*kind], limited[i].name);
    status = STRUT_USAGE;
  }
  return status;
}

static strut_status run_plot(const strut_arguments *arguments) {
  strut_plot plot;
  strut_table table;
  strut_error error = {0};
  int kind = 0;
  strut_status status = read_kind(arguments, &kind);
  if (status == STRUT_OK) status = strut_plot_read(&strut_command_plot, arguments, 0, &plot);
  if (status != STRUT_OK) return status;
  if (!plot.path) {
    fprintf(stderr, "strut plot: missing --plot FILE\n");
    return STRUT_USAGE;
  }
  status = strut_table_read(arguments->model, &table);
  if (status != STRUT_OK) return status;
  status = draws[kind](arguments, &plot, &table, &error);
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
