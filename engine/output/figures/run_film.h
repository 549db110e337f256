/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Films of a recorded motion: its frames as figures draw them, encoded by the program ffmpeg. */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_RUN_FILM_H
#define STRUT_ENGINE_OUTPUT_FIGURES_RUN_FILM_H

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/output/trajectory.h"
#include "engine/scene/experiment.h"

/** Frames per second where none are requested. */
#define STRUT_FILM_FPS 30
#define STRUT_FILM_GIF_FPS 25

typedef struct strut_film {
  const strut_experiment *experiment; /* of the run: whose travel is shown */
  const char *path; /* .mp4, .webm (1280 x 720 pixels) or .gif (640 x 360); NULL: no film */
  double speed;     /* 1: real time, 0.1: ten times slower */
  double fps;       /* frames per second; 0: default of the format */
  const strut_flag *interrupt; /* stops soon after it becomes non-zero; may be NULL */
  void (*progress)(void *context, double fraction); /* may be NULL */
  void *progress_context;
  /* What was made. */
  size_t frames;
  double motion;     /* that is shown [s] */
  double every;      /* mean time between its frames [s]; 0 for a single one */
  int width, height; /* pixels */
} strut_film;

/** Before a run of `motion` [s]: STRUT_USAGE for another ending or too long a film, STRUT_FILE_TROUBLE
    where nothing can be written or ffmpeg is missing. Completes fps, width and height. */
STRUT_API strut_status strut_film_check(strut_film *film, double motion, strut_error *error);
/** Makes a checked film from what snapshots show, the frames nearest in time; whole or not at all. STRUT_FILE_TROUBLE
    with what ffmpeg says, STRUT_DIVERGED without a frame, STRUT_INTERRUPTED, STRUT_NO_MEMORY. */
STRUT_API strut_status strut_film_make(strut_film *film, const strut_model *model,
                                       const strut_trajectory *motion, strut_error *error);

#endif
