/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * --plot FILE and --width, which every command that draws a figure has.
 */
#ifndef STRUT_PARSER_CLI_PLOT_OPTIONS_H
#define STRUT_PARSER_CLI_PLOT_OPTIONS_H

#include "parser/cli/options.h"

/** Where a figure goes, and how wide it is. path is NULL where none is asked for. */
typedef struct strut_plot {
  const char *path;
  double width; /* [pt] */
} strut_plot;

/** Rows for a command's table of options. */
#define STRUT_PLOT_OPTIONS                                                                         \
  {STRUT_OPTION_PLOT, "plot", "FILE", "draw it: FILE ends with .svg, .pdf or .png"}, {             \
    STRUT_OPTION_WIDTH, "width", "WIDTH",                                                          \
        "of the drawing: page (180 mm), column (88 mm), or a "                                     \
        "length such as 120 mm"                                                                    \
  }

/**
 * Reads both before anything is computed, and finds out whether FILE can be written: STRUT_USAGE or
 * STRUT_FILE_TROUBLE with the reason on stderr, --width without --plot included. Leaves no trace.
 * Where `usual` is 0 the usual width is a page's, else `usual` [pt].
 */
strut_status strut_plot_read(const strut_command *command, const strut_arguments *arguments,
                             double usual, strut_plot *plot);

#endif
