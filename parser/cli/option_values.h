/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options of figures: file, width, title, axes.
 */
#ifndef STRUT_PARSER_CLI_OPTION_VALUES_H
#define STRUT_PARSER_CLI_OPTION_VALUES_H

#include "engine/output/draw/plot.h"
#include "parser/cli/options.h"
#include "parser/command/option_values.h"

/** Rows for a command's table of options. */
#define STRUT_PLOT_OPTIONS                                                                         \
  {STRUT_OPTION_PLOT, "plot", "FILE", "draw a figure into FILE (.svg, .pdf or .png)"},             \
      {STRUT_OPTION_WIDTH, "width", "WIDTH",                                                       \
       "width of the figure: page (180 mm, default), column (88 mm) or "                           \
       "a length"},                                                                                \
  {                                                                                                \
    STRUT_OPTION_TITLE, "title", "TEXT", "title of the figure (default: the model's name)"         \
  }

/** Rows for figures with one pair of axes, which strut_axes_read reads. */
#define STRUT_AXIS_OPTIONS                                                                         \
  {STRUT_OPTION_X_LABEL, "x-label", "TEXT", "label of the x axis, without unit"},                  \
      {STRUT_OPTION_Y_LABEL, "y-label", "TEXT", "label of the (left) y axis, without unit"},       \
      {STRUT_OPTION_X_LIMITS, "x-limits", "LOW,HIGH", "range of the x axis, in its base unit"}, {  \
    STRUT_OPTION_Y_LIMITS, "y-limits", "LOW,HIGH", "range of the (left) y axis, likewise"          \
  }

/**
 * Reads all before anything is computed, and checks that FILE can be written: STRUT_USAGE or
 * STRUT_FILE_TROUBLE with the reason on stderr, an option without --plot included. Leaves no trace.
 * `usual` is the default width [pt]; 0: a page's.
 */
strut_status strut_plot_read(const strut_command *command, const strut_arguments *arguments,
                             double usual, strut_plot *plot);
/** Reads labels and limits; limits of a logarithmic axis must be above 0. STRUT_USAGE as above. */
strut_status strut_axes_read(const strut_command *command, const strut_arguments *arguments,
                             bool log_x, bool log_y, strut_axis_choice *x, strut_axis_choice *y);

#endif
