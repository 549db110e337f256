/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What `strut run` draws of a run: options before it, the motion during it, files after it.
 */
#ifndef STRUT_PARSER_CLI_RUN_PICTURES_H
#define STRUT_PARSER_CLI_RUN_PICTURES_H

#include "engine/output/figures/run_figure.h"
#include "parser/cli/plot_options.h"
#include "parser/cli/run_film.h"

enum { STRUT_MOST_TIMES = 100 };

/** Zero-initialise. */
typedef struct strut_run_pictures {
  strut_plot plot;
  strut_run_figure figure;
  strut_film film;
  bool quiet, silent; /* no bar; nothing on stdout besides what was asked for */
  double times[STRUT_MOST_TIMES];
  strut_trajectory motion;
  strut_sink *sink; /* that fills the motion; NULL where nothing is drawn */
} strut_run_pictures;

/** Rows for the table of options. */
#define STRUT_RUN_PICTURE_OPTIONS                                                                  \
  STRUT_PLOT_OPTIONS,                                                                              \
      {STRUT_OPTION_DRAW, "draw", "WHAT", "overview (if not given), period, snapshots or curves"}, \
      {STRUT_OPTION_SCALE, "scale", "X,Y", "draw the motion of a period so many times"},           \
      {STRUT_OPTION_TIMES, "times", "TIME,...", "instants of the snapshots, such as 0 s,80 ms"},   \
      STRUT_RUN_FILM_OPTIONS

/** Reads the options; STRUT_USAGE or STRUT_FILE_TROUBLE with the reason on stderr. */
strut_status strut_run_pictures_read(const strut_command *command, const strut_arguments *arguments,
                                     strut_run_pictures *pictures);
/** Whether the run will have what is to be drawn; STRUT_USAGE. Before anything is computed; the
    experiment must outlive the pictures. */
strut_status strut_run_pictures_check(strut_run_pictures *pictures,
                                      const strut_experiment *experiment, const strut_model *model,
                                      strut_error *error);
/** The sink that the run has to have besides its others, or NULL; *status is its trouble. */
strut_sink *strut_run_pictures_sink(strut_run_pictures *pictures, const strut_scene *scene,
                                    strut_status *status);
/** Draws what was asked for, after the run. The film is not in it. */
strut_status strut_run_pictures_draw(strut_run_pictures *pictures, const strut_model *model,
                                     const strut_summary *summary, strut_error *error);
/** Makes the film, where one was asked for, and says what it is. */
strut_status strut_run_pictures_film(strut_run_pictures *pictures, const strut_model *model,
                                     strut_error *error);
void strut_run_pictures_free(strut_run_pictures *pictures);

#endif
