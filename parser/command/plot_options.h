/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options of figures: width, title, axes, and what a figure of a run shows.
 */
#ifndef STRUT_PARSER_COMMAND_PLOT_OPTIONS_H
#define STRUT_PARSER_COMMAND_PLOT_OPTIONS_H

#include "engine/output/draw/chart.h"
#include "engine/output/figures/run_figure.h"
#include "parser/command/arguments.h"

/** Rows for tables of options. */
#define STRUT_PLOT_SETTING_OPTIONS                                                                 \
  {STRUT_OPTION_WIDTH, "width", "WIDTH",                                                           \
   "width of the figure: page (180 mm, default), column (88 mm) or "                               \
   "a length"},                                                                                    \
  {                                                                                                \
    STRUT_OPTION_TITLE, "title", "TEXT", "title of the figure (default: the model's name)"         \
  }

#define STRUT_RUN_FIGURE_OPTIONS                                                                   \
  {STRUT_OPTION_DRAW, "draw", "WHAT", "overview (default), period, snapshots or curves"},          \
      {STRUT_OPTION_SCALE, "scale", "X,Y", "magnification of the motion in the figure period"}, {  \
    STRUT_OPTION_TIMES, "times", "TIME,...", "instants of the snapshots, such as 0 s,80 ms"        \
  }

/** Rows for figures with one pair of axes, which strut_axes_read reads. */
#define STRUT_AXIS_OPTIONS                                                                         \
  {STRUT_OPTION_X_LABEL, "x-label", "TEXT", "label of the x axis, without unit"},                  \
      {STRUT_OPTION_Y_LABEL, "y-label", "TEXT", "label of the (left) y axis, without unit"},       \
      {STRUT_OPTION_X_LIMITS, "x-limits", "LOW,HIGH", "range of the x axis, in its base unit"}, {  \
    STRUT_OPTION_Y_LIMITS, "y-limits", "LOW,HIGH", "range of the (left) y axis, likewise"          \
  }

/**
 * Reads all but the file into a plot. `usual` is the default width [pt]; 0: a page's. STRUT_USAGE; the
 * listener hears why.
 */
strut_status strut_plot_settings_read(const strut_command *command,
                                      const strut_arguments *arguments, double usual,
                                      strut_plot *plot);
/** Reads labels and limits; limits of a logarithmic axis must be above 0. STRUT_USAGE as above. */
strut_status strut_axes_read(const strut_command *command, const strut_arguments *arguments,
                             bool log_x, bool log_y, strut_axis_choice *x, strut_axis_choice *y);

enum { STRUT_MOST_TIMES = 100 };

/** Reads what a figure of a run shows; `times` has room for STRUT_MOST_TIMES and stays in place. As above. */
strut_status strut_run_figure_read(const strut_command *command, const strut_arguments *arguments,
                                   const strut_plot *plot, strut_run_figure *figure, double *times);

#endif
