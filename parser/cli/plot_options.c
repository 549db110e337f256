/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/plot_options.h"

#include <stdio.h>
#include <string.h>

#include "engine/output/draw/canvas.h"
#include "engine/output/file.h"
#include "parser/cli/option_values.h"
#include "parser/cli/streams.h"

static const double POINTS = 72.0 / 0.0254;                                      /* in a metre */
static const double PAGE = 0.18, COLUMN = 0.088, NARROWEST = 0.04, WIDEST = 1.0; /* [m] */

static strut_status read_width(const strut_command *command, const strut_arguments *arguments,
                               strut_plot *plot) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_WIDTH);
  double width = PAGE;
  if (!text) return STRUT_OK;
  if (!plot->path) {
    fprintf(stderr, "strut %s: --width is that of a drawing: give --plot FILE too\n",
            command->name);
    return STRUT_USAGE;
  }
  if (strcmp(text, "column") == 0) {
    width = COLUMN;
  } else if (strcmp(text, "page") != 0) {
    strut_status status =
        strut_option_number(command, arguments, STRUT_OPTION_WIDTH, STRUT_DIM_LENGTH, &width);
    if (status != STRUT_OK) return status;
  }
  if (!(width >= NARROWEST && width <= WIDEST)) {
    fprintf(stderr, "strut %s: --width %s: a drawing is between 40 mm and 1 m wide\n",
            command->name, text);
    return STRUT_USAGE;
  }
  plot->width = width * POINTS;
  return STRUT_OK;
}

/* Whether the file can be made where it is wanted. */
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

strut_status strut_plot_read(const strut_command *command, const strut_arguments *arguments,
                             double usual, strut_plot *plot) {
  *plot = (strut_plot){.path = strut_option_text(arguments, STRUT_OPTION_PLOT),
                       .width = usual > 0 ? usual : PAGE * POINTS};
  strut_status status = read_width(command, arguments, plot);
  return status == STRUT_OK && plot->path ? try_path(plot->path) : status;
}
