/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/run_pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "parser/cli/option_values.h"
#include "parser/cli/streams.h"

static const char *const views[] = {"overview", "period", "snapshots", "curves", NULL};

/* An option that goes with one view only. */
static strut_status belongs(const strut_command *command, const strut_run_pictures *p,
                            const char *text, const char *option, strut_run_view view) {
  if (!text || (p->plot.path && p->figure.view == view)) return STRUT_OK;
  fprintf(stderr, "strut %s: --%s goes with --plot FILE --draw %s\n", command->name, option,
          views[view]);
  return STRUT_USAGE;
}

static strut_status read_scale(const strut_command *command, const strut_arguments *arguments,
                               strut_run_pictures *p) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_SCALE);
  strut_status status = belongs(command, p, text, "scale", STRUT_RUN_PERIOD);
  if (!text || status != STRUT_OK) return status;
  if (strut_option_numbers(text, STRUT_DIM_NONE, p->figure.scale, 2) == 2 &&
      p->figure.scale[0] > 0 && p->figure.scale[1] > 0)
    return STRUT_OK;
  fprintf(stderr, "strut %s: --scale expects two numbers above 0, such as 10,2; not '%s'\n",
          command->name, text);
  return STRUT_USAGE;
}

static strut_status read_times(const strut_command *command, const strut_arguments *arguments,
                               strut_run_pictures *p) {
  const char *text = strut_option_text(arguments, STRUT_OPTION_TIMES);
  strut_status status = belongs(command, p, text, "times", STRUT_RUN_SNAPSHOTS);
  if (!text || status != STRUT_OK) return status;
  p->figure.time_count = strut_option_numbers(text, STRUT_DIM_TIME, p->times, STRUT_MOST_TIMES);
  p->figure.times = p->times;
  if (p->figure.time_count > 0) return STRUT_OK;
  fprintf(stderr,
          "strut %s: --times expects up to %d times with a comma between, such as \"0 s, 80 ms\"; "
          "not '%s'\n",
          command->name, STRUT_MOST_TIMES, text);
  return STRUT_USAGE;
}

strut_status strut_run_pictures_read(const strut_command *command, const strut_arguments *arguments,
                                     strut_run_pictures *p) {
  int view = STRUT_RUN_OVERVIEW;
  const char *draw = strut_option_text(arguments, STRUT_OPTION_DRAW);
  strut_status status = strut_plot_read(command, arguments, 0, &p->plot);
  if (status == STRUT_OK)
    status = strut_option_word(command, arguments, STRUT_OPTION_DRAW, views, &view);
  if (status == STRUT_OK && draw && !p->plot.path) {
    fprintf(stderr, "strut %s: --draw says what is drawn: give --plot FILE too\n", command->name);
    status = STRUT_USAGE;
  }
  p->figure.view = (strut_run_view)view;
  p->figure.width = p->plot.width;
  if (status == STRUT_OK) status = read_scale(command, arguments, p);
  if (status == STRUT_OK) status = read_times(command, arguments, p);
  p->quiet = arguments->quiet;
  p->silent = arguments->quiet || arguments->json;
  return status == STRUT_OK ? strut_run_film_read(command, arguments, &p->film) : status;
}

strut_status strut_run_pictures_check(strut_run_pictures *p, const strut_experiment *experiment,
                                      const strut_model *model, strut_error *error) {
  p->figure.experiment = p->film.experiment = experiment;
  strut_span span = strut_experiment_span(experiment, model->scene);
  strut_status status = strut_film_check_length(&p->film, span.duration - span.record_start, error);
  if (status != STRUT_OK || !p->plot.path) return status;
  return strut_run_figure_check(&p->figure, model, error);
}

strut_sink *strut_run_pictures_sink(strut_run_pictures *p, const strut_scene *scene,
                                    strut_status *status) {
  *status = STRUT_OK;
  if (!p->plot.path && !p->film.path) return NULL;
  unsigned channels = p->plot.path ? strut_run_figure_channels(p->figure.view) : 0;
  if (p->film.path) channels |= STRUT_FILM_CHANNELS;
  p->sink = strut_trajectory_sink(&p->motion, scene, channels, STRUT_TRAJECTORY_ROOM);
  if (!p->sink) *status = STRUT_NO_MEMORY;
  return p->sink;
}

strut_status strut_run_pictures_draw(strut_run_pictures *p, const strut_model *model,
                                     const strut_summary *summary, strut_error *error) {
  if (!p->plot.path) return STRUT_OK;
  return strut_run_figure_draw(p->plot.path, &p->figure, model, &p->motion, summary, error);
}

strut_status strut_run_pictures_film(strut_run_pictures *p, const strut_model *model,
                                     strut_error *error) {
  return strut_run_film_make(&p->film, model, &p->motion, p->quiet, p->silent, error);
}

void strut_run_pictures_free(strut_run_pictures *p) {
  strut_trajectory_sink_free(p->sink);
  strut_trajectory_free(&p->motion);
}
