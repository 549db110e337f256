/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/command/plot_options.h"

#include <string.h>

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
  if (!(width >= NARROWEST && width <= WIDEST))
    return strut_usage_error(command, arguments,
                             "--width %s: expected a width between 40 mm and 1 m", text);
  plot->width = width * POINTS;
  return STRUT_OK;
}

strut_status strut_plot_settings_read(const strut_command *command,
                                      const strut_arguments *arguments, double usual,
                                      strut_plot *plot) {
  plot->width = usual > 0 ? usual : PAGE * POINTS;
  plot->title = strut_option_text(arguments, STRUT_OPTION_TITLE);
  strut_status status = read_width(command, arguments, plot);
  if (status != STRUT_OK) return status;
  return strut_axes_read(command, arguments, false, false, &plot->x, &plot->y);
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
  if (!axis->limited)
    return strut_usage_error(command, arguments,
                             "--%c-limits expects two ascending numbers%s, such as 1,10; not '%s'",
                             letter, logarithmic ? " above 0" : "", text);
  axis->low = range[0];
  axis->high = range[1];
  return STRUT_OK;
}

strut_status strut_axes_read(const strut_command *command, const strut_arguments *arguments,
                             bool log_x, bool log_y, strut_axis_choice *x, strut_axis_choice *y) {
  strut_status status = read_axis(command, arguments, 'x', log_x, x);
  return status == STRUT_OK ? read_axis(command, arguments, 'y', log_y, y) : status;
}

/* ---- of runs ---- */

static const char *const views[] = {"overview", "period", "snapshots", "curves", NULL};

/* Refuses an option that belongs to another view. */
static strut_status belongs(const strut_command *command, const strut_arguments *arguments,
                            const strut_plot *plot, const strut_run_figure *figure,
                            const char *text, const char *option, strut_run_view view) {
  if (!text || (plot->path && figure->view == view)) return STRUT_OK;
  return strut_usage_error(command, arguments, "--%s goes with --plot FILE --draw %s", option,
                           views[view]);
}

static strut_status read_scale(const strut_command *command, const strut_arguments *arguments,
                               const strut_plot *plot, strut_run_figure *figure) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_SCALE);
  strut_status status = belongs(command, arguments, plot, figure, text, "scale", STRUT_RUN_PERIOD);
  if (!text || status != STRUT_OK) return status;
  if (strut_option_numbers(text, STRUT_DIM_NONE, figure->scale, 2) == 2 && figure->scale[0] > 0 &&
      figure->scale[1] > 0)
    return STRUT_OK;
  return strut_usage_error(command, arguments,
                           "--scale expects two numbers above 0, such as 10,2; not '%s'", text);
}

static strut_status read_times(const strut_command *command, const strut_arguments *arguments,
                               const strut_plot *plot, strut_run_figure *figure, double *times) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_TIMES);
  strut_status status =
      belongs(command, arguments, plot, figure, text, "times", STRUT_RUN_SNAPSHOTS);
  if (!text || status != STRUT_OK) return status;
  figure->time_count = strut_option_numbers(text, STRUT_DIM_TIME, times, STRUT_MOST_TIMES);
  figure->times = times;
  if (figure->time_count > 0) return STRUT_OK;
  return strut_usage_error(
      command, arguments,
      "--times expects up to %d times with a comma between, such as \"0 s, 80 ms\"; not '%s'",
      STRUT_MOST_TIMES, text);
}

strut_status strut_run_figure_read(const strut_command *command, const strut_arguments *arguments,
                                   const strut_plot *plot, strut_run_figure *figure,
                                   double *times) {
  int view = STRUT_RUN_OVERVIEW;
  strut_status status = strut_option_word(command, arguments, STRUT_OPTION_DRAW, views, &view);
  figure->view = (strut_run_view)view;
  figure->width = plot->width;
  figure->title = plot->title;
  if (status == STRUT_OK) status = read_scale(command, arguments, plot, figure);
  if (status == STRUT_OK) status = read_times(command, arguments, plot, figure, times);
  return status;
}
