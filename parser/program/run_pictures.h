/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What `strut run` draws of a run: options before it, the motion during it, files after it.
 */
#ifndef STRUT_PARSER_PROGRAM_RUN_PICTURES_H
#define STRUT_PARSER_PROGRAM_RUN_PICTURES_H

#include "engine/output/figures/run_figure.h"
#include "engine/output/figures/run_film.h"
#include "parser/program/options.h"

/** Zero-initialise. */
typedef struct strut_run_pictures {
  strut_plot plot;
  strut_run_figure figure;
  strut_film film;
  bool quiet, silent; /* no progress bar; no report of the film on stdout */
  double times[STRUT_MOST_TIMES];
  strut_trajectory motion;
  strut_sink *sink; /* fills the motion; NULL if nothing is drawn */
} strut_run_pictures;

/** The table of what a film has beside a figure. */
extern const strut_option strut_film_options[];

/** Reads the options; STRUT_USAGE or STRUT_FILE_TROUBLE with the reason on stderr. */
strut_status strut_run_pictures_read(const strut_arguments *arguments,
                                     strut_run_pictures *pictures);
/** Checks before the run that it will record what is to be drawn; STRUT_USAGE if not. */
strut_status strut_run_pictures_check(strut_run_pictures *pictures,
                                      const strut_experiment *experiment, const strut_model *model,
                                      strut_error *error);
/** The sink that collects the motion, or NULL where none is needed or *status is an error. */
strut_sink *strut_run_pictures_sink(strut_run_pictures *pictures, const strut_scene *scene,
                                    strut_status *status);
/** Draws the figure after the run, if one was requested. */
strut_status strut_run_pictures_draw(strut_run_pictures *pictures, const strut_model *model,
                                     const strut_summary *summary, strut_error *error);
/** Makes the film, if one was requested, and reports it. Last, as it takes longest: the results are on the screen by then. */
strut_status strut_run_pictures_film(strut_run_pictures *pictures, const strut_model *model);
void strut_run_pictures_free(strut_run_pictures *pictures);

#endif
