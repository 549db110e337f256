/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/run_pictures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/number_text.h"
#include "engine/output/buffer.h"
#include "parser/program/options.h"
#include "parser/program/progress.h"
#include "parser/program/streams.h"

const strut_option strut_film_options[] = {
    {STRUT_FILLS(animate), "animate", "FILE", "make a film: FILE ends with .mp4, .webm or .gif"},
    {STRUT_FILLS(speed), "speed", "SPEED",
     "speed of the film, such as 1/10 or 5 (default 1, real time)", .low = 1e-9, .high = 1e6},
    {STRUT_FILLS(fps), "fps", "NUMBER",
     "frames per second (default " STRUT_TEXT_OF(STRUT_FILM_FPS) "; gif: " STRUT_TEXT_OF(
         STRUT_FILM_GIF_FPS) ")",
     .low = 1, .high = 120},
    {.name = NULL}};

strut_status strut_run_pictures_read(const strut_arguments *arguments,
                                     strut_run_pictures *pictures) {
  strut_status status = strut_plot_read(arguments, 0, &pictures->plot);
  if (!status)
    status = strut_run_figure_read(arguments, &pictures->plot, &pictures->figure, pictures->times);
  pictures->quiet = arguments->quiet;
  pictures->silent = arguments->quiet || arguments->json;
  pictures->film = (strut_film){.path = arguments->animate,
                                .speed = arguments->speed.text ? arguments->speed.value : 1,
                                .fps = arguments->fps.value};
  if (!status && !pictures->film.path && (arguments->speed.text || arguments->fps.text))
    return strut_usage_error(arguments, "--speed and --fps need --animate FILE");
  return status;
}

strut_status strut_run_pictures_check(strut_run_pictures *pictures,
                                      const strut_experiment *experiment, const strut_model *model,
                                      strut_error *error) {
  pictures->figure.experiment = pictures->film.experiment = experiment;
  strut_span span = strut_experiment_span(experiment, model->scene);
  strut_status status = STRUT_OK;
  if (pictures->film.path)
    status = strut_film_check(&pictures->film, span.duration - span.record_start, error);
  if (status != STRUT_OK || !pictures->plot.path) return status;
  return strut_run_figure_check(&pictures->figure, model, error);
}

strut_sink *strut_run_pictures_sink(strut_run_pictures *pictures, const strut_scene *scene,
                                    strut_status *status) {
  *status = STRUT_OK;
  if (!pictures->plot.path && !pictures->film.path) return NULL;
  strut_channels channels =
      pictures->plot.path ? strut_run_figure_channels(pictures->figure.view) : 0;
  if (scene->table_count) channels |= pictures->figure.experiment->channels; /* beside data */
  if (pictures->film.path) channels |= strut_run_figure_channels(STRUT_RUN_SNAPSHOTS);
  pictures->sink = strut_trajectory_sink(&pictures->motion, scene, channels, STRUT_TRAJECTORY_ROOM);
  if (!pictures->sink) *status = STRUT_NO_MEMORY;
  return pictures->sink;
}

strut_status strut_run_pictures_draw(strut_run_pictures *pictures, const strut_model *model,
                                     const strut_summary *summary, strut_error *error) {
  if (!pictures->plot.path) return STRUT_OK;
  return strut_run_figure_draw(pictures->plot.path, &pictures->figure, model, &pictures->motion,
                               summary, error);
}

/* And what would make it better: a speed at which it lasts five seconds, more recorded frames. */
static void print_film(const strut_film *film) {
  enum { SHORT = 2, WATCHED = 5 /* [s] */, DIGITS = 4 };
  double slower = ceil(WATCHED / film->motion), shown = film->speed / film->fps;
  printf("\n  film %s: %d x %d, %zu frames, %s", film->path, film->width, film->height,
         film->frames, strut_quantity_of((double)film->frames / film->fps, DIGITS, "s").text);
  printf(film->speed == 1 ? " at real speed\n" : " at %.4g times real speed\n", film->speed);
  if (film->motion < SHORT * film->speed && film->motion > 0)
    printf("  the recording lasts only %s; --speed 1/%.0f makes a film of %s\n",
           strut_quantity_of(film->motion, DIGITS, "s").text, slower,
           strut_quantity_of(film->motion * slower, 2, "s").text);
  if (film->every > 1.5 * shown)
    printf(
        "  recorded every %s but shown every %s; with a shorter output.every motion is smoother\n",
        strut_quantity_of(film->every, DIGITS, "s").text,
        strut_quantity_of(shown, DIGITS, "s").text);
}

strut_status strut_run_pictures_film(strut_run_pictures *pictures, const strut_model *model) {
  strut_error error = {0};
  if (!pictures->film.path) return STRUT_OK;
  fflush(stdout);
  strut_progress progress = strut_progress_begin(pictures->quiet);
  /* After an interrupted run the film still shows what was recorded. */
  const strut_flag *interrupt = strut_interrupt_watch();
  pictures->film.interrupt = *interrupt ? NULL : interrupt;
  pictures->film.progress = progress.wanted ? strut_progress_show : NULL;
  pictures->film.progress_context = &progress;
  strut_status status = strut_film_make(&pictures->film, model, &pictures->motion, &error);
  strut_progress_end(&progress);
  if (status != STRUT_OK) strut_print_error(&error);
  if (status == STRUT_OK && !pictures->silent) print_film(&pictures->film);
  return status;
}

void strut_run_pictures_free(strut_run_pictures *pictures) {
  strut_trajectory_sink_free(pictures->sink);
  strut_trajectory_free(&pictures->motion);
}
