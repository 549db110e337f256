/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Shared by the views of a run.
 */
#ifndef STRUT_ENGINE_OUTPUT_FIGURES_RUN_PARTS_H
#define STRUT_ENGINE_OUTPUT_FIGURES_RUN_PARTS_H

#include "engine/output/draw/figure.h"
#include "engine/output/figures/run_figure.h"

/** A run being drawn. */
typedef struct strut_run_scene {
  const strut_run_figure *figure;
  const strut_model *model;
  const strut_trajectory *motion;
  const strut_summary *summary;
  size_t frames;        /* that can be drawn; a diverged run ends earlier */
  double period;        /* [s]; 0: not periodic, or too few frames */
  double force_limit;   /* of the colours: largest force of a member in any frame [N] */
  strut_beyond beyond;  /* but for frames with far larger ones */
  double contact_limit; /* largest force of the ground in the frames drawn [N] */
  strut_arena arena;
} strut_run_scene;

enum { STRUT_RUN_NOTE = 600 };
/** Width of enlarged node trajectories [pt]. */
#define STRUT_RUN_TRAIL 1.5
/** Length of the arrow for the largest force of the ground [pt]. */
#define STRUT_RUN_ARROW 20.0

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
double *strut_run_coordinates(strut_run_scene *run, size_t frame);
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
/** Bounds of one frame, with a minimum size. */
strut_bounds strut_run_frame_bounds(const strut_run_scene *run, size_t frame);
/** Widens the bounds to the ground where it is near. */
void strut_run_add_ground(const strut_run_scene *run, strut_bounds *bounds);

/** Widens the scale of the contact arrows to a frame, before any is drawn. */
void strut_run_expect_frame(strut_run_scene *run, size_t frame);
/** The frame's structure in colours of force, on the ground, with the forces of the ground. False: out of memory. */
bool strut_run_shape(strut_run_scene *run, size_t frame, strut_shape *shape);
/** The figure's second motion, with its own arena, which the caller frees; false where there is none. */
bool strut_run_find_other(const strut_run_scene *run, strut_run_scene *other);
/** Members of the second motion, dashed, to be seen below the first's. False: out of memory. */
bool strut_run_other_shape(strut_run_scene *other, size_t frame, strut_shape *shape);
/** The pen of the second motion's trails, likewise. */
strut_pen strut_run_other_pen(void);
/** Appends "; thick dashes: NAME" to a text where there is another motion. */
void strut_run_describe_other(const strut_run_scene *run, char *text, size_t size);
/** The scale of the colours of force; without a name where none were recorded. */
strut_colour_scale strut_run_scale(const strut_run_scene *run);
/** The key entry of the contact arrows, left out where there are none. NULL: out of memory. */
const strut_key_item *strut_run_arrow_item(strut_run_scene *run);

/** Curves over time, a kind of quantity in each panel. */
enum {
  STRUT_RUN_DISPLACEMENT,
  STRUT_RUN_NORMALS,
  STRUT_RUN_DRIVE,
  STRUT_RUN_HEIGHTS,
  STRUT_RUN_FORCES,
  STRUT_RUN_ANGLES,
  STRUT_RUN_MOMENTS,
  STRUT_RUN_PRESSURES,
  STRUT_RUN_AREAS,
  STRUT_RUN_ENERGIES,
  STRUT_RUN_PANELS
};
/** True if a panel has something to draw. */
bool strut_run_panel_wanted(const strut_run_scene *run, int panel);
/** Fills one in from frame `first` on. False: out of memory. */
bool strut_run_panel(strut_run_scene *run, int kind, size_t first, strut_panel *panel);

/**
 * Fills in the panels of each view, in the run's arena, with what stands below them, and says in `note`
 * (STRUT_RUN_NOTE bytes) what it shows. False: out of memory.
 */
bool strut_run_overview(strut_run_scene *run, strut_figure *figure, char *note);
bool strut_run_period(strut_run_scene *run, strut_figure *figure, char *note);
bool strut_run_snapshots(strut_run_scene *run, strut_figure *figure, char *note);
bool strut_run_curves(strut_run_scene *run, strut_figure *figure, char *note);

#endif
