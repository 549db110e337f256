/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the views of a run share.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_RUN_PARTS_H
#define STRUT_ENGINE_OUTPUT_FIGURES_RUN_PARTS_H

#include "engine/output/draw/axes.h"
#include "engine/output/draw/structure.h"
#include "engine/output/figures/run_figure.h"

/** A run being drawn. */
typedef struct strut_run_scene {
  const strut_run_figure *figure;
  const strut_model *model;
  const strut_trajectory *motion;
  const strut_summary *summary;
  double period;      /* [s]; 0: there is none */
  double force_limit; /* largest force of a member in any frame [N] */
  double contact_limit; /* largest force of the ground in the frames drawn [N] */
  strut_arena arena;
} strut_run_scene;

/** Positions of a frame as the model's coordinates, padded, in the arena; NULL: no memory. */
double *strut_run_shape(strut_run_scene *run, size_t frame);
/** First frame of the last `duration` seconds; there are two frames at least if there are two. */
size_t strut_run_since(const strut_run_scene *run, double duration);
/** Where the measured point is along x in a frame [m]. */
double strut_run_measured(const strut_run_scene *run, size_t frame);
/** Its name: a node's, or "centre of mass". */
const char *strut_run_measured_name(const strut_run_scene *run);
/** The ways of all nodes from one frame to another, a trail each. False: no memory. */
bool strut_run_draw_trails(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                           size_t first, size_t last);
/** The frame's structure in colours of force, on the ground, with the ground's forces. */
bool strut_run_draw_frame(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                          size_t frame, bool names);
/** Takes a frame into account for the length of the ground's arrows, before any is drawn. */
void strut_run_expect_frame(strut_run_scene *run, size_t frame);
/** The scale of colours for that. */
void strut_run_draw_scale(const strut_run_scene *run, strut_canvas *canvas, strut_box box);
/** Title, and below it a line of what came out; returns the height taken [pt]. */
double strut_run_draw_title(const strut_run_scene *run, strut_canvas *canvas, strut_box box,
                            const char *what);

/** Curves for a figure: each a row of panels; used by the overview and by the curves. */
enum { STRUT_RUN_WAY, STRUT_RUN_HEIGHTS, STRUT_RUN_FORCES, STRUT_RUN_NORMALS, STRUT_RUN_ENERGIES,
       STRUT_RUN_PANELS };
/** Whether there is anything to draw in a panel. */
bool strut_run_panel_wanted(const strut_run_scene *run, int panel);
/** Draws one from frame `first` on. */
strut_status strut_run_draw_panel(strut_run_scene *run, strut_canvas *canvas, strut_box box,
                                  int panel, size_t first);

/** Heights that the views need for a width [pt], and what they draw. */
double strut_run_overview_height(strut_run_scene *run);
strut_status strut_run_overview(strut_run_scene *run, strut_canvas *canvas);
double strut_run_period_height(strut_run_scene *run);
strut_status strut_run_period(strut_run_scene *run, strut_canvas *canvas);
double strut_run_snapshots_height(strut_run_scene *run);
strut_status strut_run_snapshots(strut_run_scene *run, strut_canvas *canvas);
double strut_run_curves_height(strut_run_scene *run);
strut_status strut_run_curves(strut_run_scene *run, strut_canvas *canvas);

#endif
