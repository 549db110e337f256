/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/option_values.h"

#include <stdio.h>

#include "engine/output/draw/canvas.h"
#include "engine/output/file.h"
#include "parser/program/streams.h"

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
  *plot = (strut_plot){.path = strut_option_text(arguments, STRUT_OPTION_PLOT)};
  if (!plot->path) return refuse_without_plot(command, arguments);
  strut_status status = strut_plot_settings_read(command, arguments, usual, plot);
  return status == STRUT_OK ? try_path(plot->path) : status;
}
