/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Figures of a run, from its recorded motion: an overview, the ways of the nodes over one period,
 * shapes at several instants, curves over time.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_RUN_FIGURE_H
#define STRUT_ENGINE_OUTPUT_FIGURES_RUN_FIGURE_H

#include "engine/model/model.h"
#include "engine/output/trajectory.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

typedef enum strut_run_view {
  STRUT_RUN_OVERVIEW,  /* the last shape, the ways to it, and curves of the last periods */
  STRUT_RUN_PERIOD,    /* the nodes' ways over the last period, dark to bright, exaggerated */
  STRUT_RUN_SNAPSHOTS, /* shapes side by side */
  STRUT_RUN_CURVES     /* all that was recorded over time */
} strut_run_view;

typedef struct strut_run_figure {
  const strut_experiment *experiment; /* of the run */
  strut_run_view view;
  double width;        /* [pt] */
  double scale[2];     /* of PERIOD: motion along x and y is drawn so many times; 0: once */
  size_t time_count;   /* of SNAPSHOTS; 0: six, spread over what was recorded */
  const double *times; /* (time_count) [s]; the frame nearest to each is drawn */
  /* Of PERIOD and SNAPSHOTS: another motion of the same nodes, dashed over it, and what it is
     called; or NULL. */
  const strut_trajectory *other;
  const char *other_name;
} strut_run_figure;

/** Channels that a view needs, strut_channel bits. */
STRUT_API unsigned strut_run_figure_channels(strut_run_view view);
/**
 * Whether a run of the model as its scene says will have what the figure draws: STRUT_USAGE with
 * the reason where a period has too few samples to be seen, or nothing is recorded at a time.
 */
STRUT_API strut_status strut_run_figure_check(const strut_run_figure *figure,
                                              const strut_model *model, strut_error *error);
/**
 * Draws it into the file `path`. The summary tells velocity, status and duration. STRUT_USAGE where
 * there is no frame to draw; STRUT_NO_MEMORY; else as strut_canvas_open and strut_canvas_commit.
 */
STRUT_API strut_status strut_run_figure_draw(const char *path, const strut_run_figure *figure,
                                             const strut_model *model,
                                             const strut_trajectory *motion,
                                             const strut_summary *summary, strut_error *error);

#endif
