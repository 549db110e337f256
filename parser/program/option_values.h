/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options of figures: file, width, title, axes.
 */
#ifndef STRUT_PARSER_PROGRAM_OPTION_VALUES_H
#define STRUT_PARSER_PROGRAM_OPTION_VALUES_H

#include "engine/output/draw/chart.h"
#include "parser/command/plot_options.h"
#include "parser/program/options.h"

/** Rows for a command's table of options. */
#define STRUT_PLOT_OPTIONS                                                                         \
  {STRUT_OPTION_PLOT, "plot", "FILE", "draw a figure into FILE (.svg, .pdf or .png)"},             \
      STRUT_PLOT_SETTING_OPTIONS

/**
 * Reads all before anything is computed, and checks that FILE can be written: STRUT_USAGE or
 * STRUT_FILE_TROUBLE with the reason on stderr, an option without --plot included. Leaves no trace.
 * `usual` is the default width [pt]; 0: a page's.
 */
strut_status strut_plot_read(const strut_command *command, const strut_arguments *arguments,
                             double usual, strut_plot *plot);
#endif
