/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Shared by the views of a run.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_RUN_PARTS_H
#define STRUT_ENGINE_OUTPUT_FIGURES_RUN_PARTS_H

#include "engine/output/draw/chart.h"
#include "engine/output/draw/legend.h"
#include "engine/output/draw/structure.h"
#include "engine/output/figures/run_figure.h"

/** A run being drawn. */
typedef struct strut_run_scene {
  const strut_run_figure *figure;
  const strut_model *model;
  const strut_trajectory *motion;
  const strut_summary *summary;
  strut_canvas *ruler;  /* to measure texts before there is a page */
  size_t frames;        /* that can be drawn; a diverged run ends earlier */
  double period;        /* [s]; 0: not periodic, or too few frames */
  double force_limit;   /* of the colours: largest force of a member in any frame [N] */
  strut_beyond beyond;  /* but for frames with far larger ones */
  double contact_limit; /* largest force of the ground in the frames drawn [N] */
  double arrow;         /* length of the arrow for that [pt] */
  strut_heading heading;
  double head; /* its height [pt] */
  strut_arena arena;
} strut_run_scene;

/** Margins around all figures [pt]. */
#define STRUT_RUN_EDGE 5.0
enum { STRUT_RUN_NOTE = 600 };
/** Width of enlarged node trajectories [pt]. */
#define STRUT_RUN_TRAIL 1.5

/** Shorter than the time between any two frames [s]. */
#define STRUT_RUN_MOMENT 1e-9

/** Sets frames and period, before anything is drawn. */
void strut_run_count_frames(strut_run_scene *run);
/**
 * Finds the scale of forces, from the largest of each frame, but for a few frames with far larger ones.
 * False: out of memory.
 */
bool strut_run_find_limits(strut_run_scene *run);
/** Positions (nodes, 2) of a frame. */
const double *strut_run_positions(const strut_run_scene *run, size_t frame);
/** Those as the model's coordinates, padded, in the arena; NULL: no memory. */
double *strut_run_shape(strut_run_scene *run, size_t frame);
/** The frame nearest to a time [s]; the earlier one of two. */
size_t strut_run_nearest(const strut_run_scene *run, double time);
/** First frame of the last `duration` seconds; there are two frames at least if there are two. */
size_t strut_run_since(const strut_run_scene *run, double duration);
/** Time from one frame to the last [s]. */
double strut_run_time_from(const strut_run_scene *run, size_t frame);
/** Coordinate of the measured point along an axis, 0 or 1, in a frame [m]. */
double strut_run_measured(const strut_run_scene *run, size_t frame, int axis);
/** Name of the measured point: a node's, or "centre of mass". */
const char *strut_run_measured_name(const strut_run_scene *run);
/** Height of the ground's line at x [m]; only where there is one. */
double strut_run_ground_at(const strut_run_scene *run, double x);
/** The larger extent of bounds [m]. */
double strut_run_extent(const strut_bounds *bounds);
/** Bounds of one frame, with a minimum size. */
strut_bounds strut_run_frame_bounds(const strut_run_scene *run, size_t frame);
/** Widens the bounds to the ground where it is near. */
void strut_run_add_ground(const strut_run_scene *run, strut_bounds *bounds);
/** Height [pt] of a drawing of these bounds in `width`, between `least` and `most` of the width. */
double strut_run_drawing_height(const strut_bounds *bounds, double width, double margin,
                                double least, double most);

/** Widens the scale of the contact arrows to a frame, before any is drawn. */
void strut_run_expect_frame(strut_run_scene *run, size_t frame);
/** The frame's structure in colours of force, on the ground. */
bool strut_run_draw_frame(strut_run_scene *run, strut_canvas *canvas, const strut_window *window,
                          size_t frame);
/** The forces of the ground on it. */
void strut_run_draw_reactions(strut_run_scene *run, strut_canvas *canvas,
                              const strut_window *window, size_t frame);
/** A path through (count) positions [m], clipped to the window's box. */
void strut_run_draw_path(strut_canvas *canvas, const strut_window *window, const double (*path)[2],
                         size_t count, double width);
/**
 * The figure's second motion, with its own arena, which the caller frees; false where there is
 * none.
 */
bool strut_run_find_other(const strut_run_scene *run, strut_run_scene *other);
/** Draws the second motion's members in a shape of its model, dashed: before the first's. */
void strut_run_draw_other(const strut_run_scene *other, strut_canvas *canvas,
                          const strut_window *window, const double *q);
/** Draws the second motion's path through (count) positions [m], dashed, likewise; false: out of memory. */
bool strut_run_draw_other_path(strut_run_scene *other, strut_canvas *canvas,
                               const strut_window *window, const double (*path)[2], size_t count);
/** Appends "; thick dashes: NAME" to a text where there is another motion. */
void strut_run_describe_other(const strut_run_scene *run, char *text, size_t size);
/** Names of the nodes of a shape, unless there are many. */
void strut_run_draw_names(const strut_run_scene *run, strut_canvas *canvas,
                          const strut_window *window, const double *q);
/** The scale of the colours of force. */
void strut_run_draw_scale(const strut_run_scene *run, strut_canvas *canvas, strut_box box);
/**
 * The key entry of the contact arrows; false where there are none. `text` has room for 120 bytes.
 */
bool strut_run_arrow_item(const strut_run_scene *run, char text[120], strut_key_item *item);

/** Curves over time, a kind of quantity in each panel. */
enum {
  STRUT_RUN_DISPLACEMENT,
  STRUT_RUN_NORMALS,
  STRUT_RUN_DRIVE,
  STRUT_RUN_HEIGHTS,
  STRUT_RUN_FORCES,
  STRUT_RUN_ANGLES,
  STRUT_RUN_MOMENTS,
  STRUT_RUN_ENERGIES,
  STRUT_RUN_PANELS
};
/** True if a panel has something to draw. */
bool strut_run_panel_wanted(const strut_run_scene *run, int panel);
/** Draws one from frame `first` on. */
strut_status strut_run_draw_panel(strut_run_scene *run, strut_canvas *canvas, strut_box box,
                                  int panel, size_t first);

/**
 * What each view shows, for the heading (at most STRUT_RUN_NOTE bytes), its height [pt] for the figure's
 * width, and its drawing below the heading.
 */
void strut_run_overview_describe(strut_run_scene *run, char *text);
double strut_run_overview_height(strut_run_scene *run);
strut_status strut_run_overview(strut_run_scene *run, strut_canvas *canvas);
void strut_run_period_describe(strut_run_scene *run, char *text);
double strut_run_period_height(strut_run_scene *run);
strut_status strut_run_period(strut_run_scene *run, strut_canvas *canvas);
void strut_run_snapshots_describe(strut_run_scene *run, char *text);
double strut_run_snapshots_height(strut_run_scene *run);
strut_status strut_run_snapshots(strut_run_scene *run, strut_canvas *canvas);
void strut_run_curves_describe(strut_run_scene *run, char *text);
double strut_run_curves_height(strut_run_scene *run);
strut_status strut_run_curves(strut_run_scene *run, strut_canvas *canvas);

#endif
