/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Films of a recorded motion: its frames as figures draw them, encoded by the program ffmpeg. */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_RUN_FILM_H
#define STRUT_ENGINE_OUTPUT_FIGURES_RUN_FILM_H

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/output/trajectory.h"
#include "engine/scene/experiment.h"

/** Channels that a film needs from strut_trajectory_sink. */
#define STRUT_FILM_CHANNELS                                                                        \
  ((unsigned)STRUT_CHANNEL_POSITION | STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT)

typedef struct strut_film {
  const strut_experiment *experiment; /* of the run: whose travel is shown */
  const char *path; /* .mp4, .webm (1280 x 720 pixels) or .gif (640 x 360); NULL: no film */
  double speed;     /* 1: real time, 0.1: ten times slower */
  double fps;       /* frames per second; 0: default of the format */
  const strut_flag *interrupt; /* stops soon after it becomes non-zero; may be NULL */
  void (*progress)(void *context, double fraction); /* may be NULL */
  void *progress_context;
} strut_film;

/** Properties of a finished film. */
typedef struct strut_film_made {
  size_t frames;
  int width, height; /* pixels */
  double fps;
  double lasts; /* the film [s] */
  double every; /* mean time between frames of the motion [s]; 0 for a single one */
  double shown; /* time of the motion between frames of the film [s] */
} strut_film_made;

/** Before a run: STRUT_USAGE for another ending, STRUT_FILE_TROUBLE where nothing can be written or ffmpeg is missing. */
STRUT_API strut_status strut_film_check(const char *path, strut_error *error);
/** STRUT_USAGE where a film of a motion of this duration [s] is too long. */
STRUT_API strut_status strut_film_check_length(const strut_film *film, double motion,
                                               strut_error *error);
/** Makes the film from the recorded frames nearest in time; whole or not at all. STRUT_USAGE as above,
    STRUT_FILE_TROUBLE with what ffmpeg says, STRUT_DIVERGED without a frame, STRUT_INTERRUPTED, STRUT_NO_MEMORY. */
STRUT_API strut_status strut_film_make(const strut_film *film, const strut_model *model,
                                       const strut_trajectory *motion, strut_film_made *made,
                                       strut_error *error);

#endif
