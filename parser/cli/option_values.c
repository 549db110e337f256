/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/option_values.h"

#include <stdio.h>
#include <string.h>

#include "engine/output/draw/canvas.h"
#include "engine/output/file.h"
#include "parser/cli/streams.h"

static const double POINTS = 72.0 / 0.0254;                                      /* in a metre */
static const double PAGE = 0.18, COLUMN = 0.088, NARROWEST = 0.04, WIDEST = 1.0; /* [m] */

static strut_status read_width(const strut_command *command, const strut_arguments *arguments,
                               strut_plot *plot) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_WIDTH);
  double width = PAGE;
  if (!text) return STRUT_OK;
  if (strcmp(text, "column") == 0) {
    width = COLUMN;
  } else if (strcmp(text, "page") != 0) {
    strut_status status =
        strut_option_number(command, arguments, STRUT_OPTION_WIDTH, STRUT_DIM_LENGTH, &width);
    if (status != STRUT_OK) return status;
  }
  if (!(width >= NARROWEST && width <= WIDEST)) {
    fprintf(stderr, "strut %s: --width %s: expected a width between 40 mm and 1 m\n", command->name,
            text);
    return STRUT_USAGE;
  }
  plot->width = width * POINTS;
  return STRUT_OK;
}

/* Checks that the file can be created. */
static strut_status try_path(const char *path) {
  strut_file file;
  strut_error error = {0};
  strut_status status = strut_canvas_check_name(path, &error);
  if (status == STRUT_OK) status = strut_file_open_path(&file, path, &error);
  if (status == STRUT_OK) {
    strut_file_abandon(&file);
  } else {
    strut_print_error(&error);
  }
  return status;
}

/* Reports the first option of a figure that was given without --plot. */
static strut_status refuse_without_plot(const strut_command *command,
                                        const strut_arguments *arguments) {
  for (const strut_option *o = command->options; o->id != STRUT_OPTION_END; o++) {
    bool figure = o->id == STRUT_OPTION_WIDTH || o->id == STRUT_OPTION_DRAW ||
                  (o->id >= STRUT_OPTION_TITLE && o->id <= STRUT_OPTION_Y_LIMITS);
    if (!figure || !strut_option_text(arguments, o->id)) continue;
    fprintf(stderr, "strut %s: --%s needs --plot FILE\n", command->name, o->name);
    return STRUT_USAGE;
  }
  return STRUT_OK;
}

strut_status strut_plot_read(const strut_command *command, const strut_arguments *arguments,
                             double usual, strut_plot *plot) {
  *plot = (strut_plot){.path = strut_option_text(arguments, STRUT_OPTION_PLOT),
                       .width = usual > 0 ? usual : PAGE * POINTS,
                       .title = strut_option_text(arguments, STRUT_OPTION_TITLE)};
  if (!plot->path) return refuse_without_plot(command, arguments);
  strut_status status = read_width(command, arguments, plot);
  if (status == STRUT_OK)
    status = strut_axes_read(command, arguments, false, false, &plot->x, &plot->y);
  return status == STRUT_OK ? try_path(plot->path) : status;
}

/* --x-label and --x-limits, or those of y. */
static strut_status read_axis(const strut_command *command, const strut_arguments *arguments,
                              char letter, bool logarithmic, strut_axis_choice *axis) {
  bool x = letter == 'x';
  const char *text =
      strut_option_text(arguments, x ? STRUT_OPTION_X_LIMITS : STRUT_OPTION_Y_LIMITS);
  double range[2];
  *axis = (strut_axis_choice){
      .label = strut_option_text(arguments, x ? STRUT_OPTION_X_LABEL : STRUT_OPTION_Y_LABEL)};
  if (!text) return STRUT_OK;
  axis->limited = strut_option_numbers(text, STRUT_DIM_NONE, range, 2) == 2 &&
                  range[0] < range[1] && (!logarithmic || range[0] > 0);
  if (!axis->limited) {
    fprintf(stderr,
            "strut %s: --%c-limits expects two ascending numbers%s, such as 1,10; not '%s'\n",
            command->name, letter, logarithmic ? " above 0" : "", text);
    return STRUT_USAGE;
  }
  axis->low = range[0];
  axis->high = range[1];
  return STRUT_OK;
}

strut_status strut_axes_read(const strut_command *command, const strut_arguments *arguments,
                             bool log_x, bool log_y, strut_axis_choice *x, strut_axis_choice *y) {
  strut_status status = read_axis(command, arguments, 'x', log_x, x);
  return status == STRUT_OK ? read_axis(command, arguments, 'y', log_y, y) : status;
}
