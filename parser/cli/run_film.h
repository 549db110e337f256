/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * strut run --animate FILE with --speed and --fps.
 */
#ifndef STRUT_PARSER_CLI_RUN_FILM_H
#define STRUT_PARSER_CLI_RUN_FILM_H

#include "engine/output/film/film.h"
#include "parser/cli/options.h"

/** Rows for the table of options. */
#define STRUT_RUN_FILM_OPTIONS                                                                     \
  {STRUT_OPTION_ANIMATE, "animate", "FILE", "make a film: FILE ends with .mp4, .webm or .gif"},    \
      {STRUT_OPTION_SPEED, "speed", "SPEED", "of the film, such as 1/10 or 5; 1 is true"}, {       \
    STRUT_OPTION_FPS, "fps", "NUMBER", "its frames per second (30; gif: 25)"                       \
  }

/**
 * Reads them before anything is computed, and finds out whether the film can be made: ffmpeg is
 * there, FILE can be written. STRUT_USAGE or STRUT_FILE_TROUBLE with the reason on stderr.
 */
strut_status strut_run_film_read(const strut_command *command, const strut_arguments *arguments,
                                 strut_film *film);
/** Makes it, with a bar on a terminal unless `quiet`; and says unless `silent` what was made. */
strut_status strut_run_film_make(strut_film *film, const strut_model *model,
                                 const strut_trajectory *motion, bool quiet, bool silent,
                                 strut_error *error);

#endif
