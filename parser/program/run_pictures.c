/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/run_pictures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "parser/program/options.h"
#include "parser/program/progress.h"
#include "parser/program/streams.h"

/* ---- films ---- */

enum { SHORT = 2 /* a shorter film is too short to watch [s] */, DIGITS = 4 };

static const double LEAST_SPEED = 1e-9, MOST_SPEED = 1e6, LEAST_FPS = 1, MOST_FPS = 120;

/* A number in a range; "1/10" as well as "0.1". */
static strut_status read_number(const strut_command *command, const strut_arguments *arguments,
                                strut_option_id id, const char *name, double low, double high,
                                double *value) {
  strut_status status = strut_option_number(command, arguments, id, STRUT_DIM_NONE, value);
  if (status != STRUT_OK || !strut_option_text(arguments, id)) return status;
  if (*value >= low && *value <= high) return STRUT_OK;
  fprintf(stderr, "strut %s: --%s expects a number from %g to %g, such as %s\n", command->name,
          name, low, high, id == STRUT_OPTION_SPEED ? "1/10" : "30");
  return STRUT_USAGE;
}

strut_status strut_run_film_read(const strut_command *command, const strut_arguments *arguments,
                                 strut_film *film) {
  strut_error error = {0};
  *film = (strut_film){.path = strut_option_text(arguments, STRUT_OPTION_ANIMATE), .speed = 1};
  bool more = strut_option_text(arguments, STRUT_OPTION_SPEED) ||
              strut_option_text(arguments, STRUT_OPTION_FPS);
  if (!film->path && more) {
    fprintf(stderr, "strut %s: --speed and --fps need --animate FILE\n", command->name);
    return STRUT_USAGE;
  }
  if (!film->path) return STRUT_OK;
  strut_status status = read_number(command, arguments, STRUT_OPTION_SPEED, "speed", LEAST_SPEED,
                                    MOST_SPEED, &film->speed);
  if (status == STRUT_OK)
    status =
        read_number(command, arguments, STRUT_OPTION_FPS, "fps", LEAST_FPS, MOST_FPS, &film->fps);
  if (status != STRUT_OK) return status;
  status = strut_film_check(film->path, &error);
  if (status != STRUT_OK) strut_print_error(&error);
  return status;
}

/* A speed that makes the film last about five seconds, as 1/20 or 1/5: one digit over all. */
static double better_speed(double motion) {
  double slower = 5 / motion, power = pow(10, floor(log10(slower)));
  double digit = slower / power;
  return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

static void print_film(const strut_film *film, const strut_film_made *made) {
  double motion = made->lasts * film->speed;
  printf("\n  film %s: %d x %d, %zu frames, %s", film->path, made->width, made->height,
         made->frames, strut_quantity_of((double)made->frames / made->fps, DIGITS, "s").text);
  printf(film->speed == 1 ? " at real speed\n" : " at %.4g times real speed\n", film->speed);
  if (made->lasts < SHORT && motion > 0)
    printf("  the recording lasts only %s; --speed 1/%.0f makes a film of %s\n",
           strut_quantity_of(motion, DIGITS, "s").text, fmax(2, better_speed(motion)),
           strut_quantity_of(motion * fmax(2, better_speed(motion)), 2, "s").text);
  if (made->every > 1.5 * made->shown)
    printf(
        "  recorded every %s but shown every %s; with a shorter output.every motion is smoother\n",
        strut_quantity_of(made->every, DIGITS, "s").text,
        strut_quantity_of(made->shown, DIGITS, "s").text);
}

strut_status strut_run_film_make(strut_film *film, const strut_model *model,
                                 const strut_trajectory *motion, bool quiet, bool silent,
                                 strut_error *error) {
  strut_film_made made = {0};
  if (!film->path) return STRUT_OK;
  strut_progress progress = strut_progress_begin(quiet);
  /* After an interrupted run the film still shows what was recorded. */
  const strut_flag *interrupt = strut_interrupt_watch();
  film->interrupt = *interrupt ? NULL : interrupt;
  film->progress = progress.wanted ? strut_progress_show : NULL;
  film->progress_context = &progress;
  strut_status status = strut_film_make(film, model, motion, &made, error);
  strut_progress_end(&progress);
  if (status == STRUT_OK && !silent) print_film(film, &made);
  return status;
}

/* ---- figures, and both ---- */

strut_status strut_run_pictures_read(const strut_command *command, const strut_arguments *arguments,
                                     strut_run_pictures *p) {
  strut_status status = strut_plot_read(command, arguments, 0, &p->plot);
  if (status == STRUT_OK)
    status = strut_run_figure_read(command, arguments, &p->plot, &p->figure, p->times);
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
