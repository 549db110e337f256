/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figures of a run from its recorded motion: an overview, node trajectories over one period,
 * snapshots, curves over time.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/model/model.h"
#include "engine/output/draw/chart.h"
#include "engine/output/trajectory.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

typedef enum strut_run_view {
  STRUT_RUN_OVERVIEW,  /* the last shape, the paths to it, and curves of the last periods */
  STRUT_RUN_PERIOD,    /* node trajectories over the last period, dark to bright, enlarged */
  STRUT_RUN_SNAPSHOTS, /* shapes side by side */
  STRUT_RUN_CURVES     /* everything recorded over time */
} strut_run_view;

typedef struct strut_run_figure {
  const strut_experiment *experiment; /* of the run */
  strut_run_view view;
  strut_plot plot;     /* path NULL: nothing is drawn */
  double scale[2];     /* of PERIOD: enlargement of motion along x and y; 0: 1 */
  size_t time_count;   /* of SNAPSHOTS; 0: six, spread over the record */
  const double *times; /* (time_count) [s]; the frame nearest to each is drawn */
  /* Of PERIOD and SNAPSHOTS: a second motion of the same nodes, drawn dashed, and its
     name; or NULL. */
  const strut_trajectory *other;
  const char *other_name;
} strut_run_figure;

/** Channels that a view needs, strut_channels bits. */
static inline unsigned strut_run_figure_channels(strut_run_view view) {
  static const unsigned shown[] = {
      [STRUT_RUN_OVERVIEW] = STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ANGLE,
      [STRUT_RUN_PERIOD] = 0,
      [STRUT_RUN_SNAPSHOTS] = STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT,
      [STRUT_RUN_CURVES] = STRUT_CHANNEL_FORCE | STRUT_CHANNEL_CONTACT | STRUT_CHANNEL_ENERGY |
                           STRUT_CHANNEL_ANGLE | STRUT_CHANNEL_MOMENT | STRUT_CHANNEL_AREA |
                           STRUT_CHANNEL_PRESSURE};
  return STRUT_CHANNEL_POSITION | shown[view];
}
/**
 * Checks before a run that its record will contain what the figure draws: STRUT_USAGE with the
 * reason where a period has too few samples, or a time is outside the record.
 */
STRUT_API strut_status strut_run_figure_check(const strut_run_figure *figure,
                                              const strut_scene *scene, strut_error *error);
/**
 * Draws it. The summary provides velocity, status and duration. STRUT_USAGE
 * where there is no frame to draw; STRUT_NO_MEMORY; else as strut_canvas_open and
 * strut_canvas_commit.
 */
STRUT_API strut_status strut_run_figure_draw(const strut_run_figure *figure,
                                             const strut_model *model,
                                             const strut_trajectory *motion,
                                             const strut_summary *summary, strut_error *error);

/* Films of a recorded motion: its frames as figures draw them, encoded by the program ffmpeg. */

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
