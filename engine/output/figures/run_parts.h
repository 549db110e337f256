/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Shared by the views of a run. */
#pragma once

#include "engine/output/draw/figure.h"
#include "engine/output/figures/run_figure.h"

/** A run being drawn. */
typedef struct strut_run_scene {
  const strut_run_figure *figure;
  const strut_model *model;
  const strut_trajectory *motion;
  const strut_summary *summary;
  size_t frames;       /* that can be drawn; a diverged run ends earlier */
  double period;       /* of the motion [s]; 0: not periodic, or too few frames */
  int32_t repeats;     /* periods of the drive in it */
  double force_limit;  /* of the colours: largest force of a member in any frame [N] */
  strut_beyond beyond; /* but for frames with far larger ones */
  strut_figure *page;  /* that is filled in */
} strut_run_scene;

/** Shorter than the time between any two frames [s]. */
#define STRUT_RUN_MOMENT 1e-9

/** Sets frames and period, before anything is drawn. */
void strut_run_count_frames(strut_run_scene *run);
/** Finds the scale of forces, from the largest of each frame, but for a few frames with far larger ones. */
void strut_run_find_limits(strut_run_scene *run);
/** Positions (nodes, 2) of a frame. */
const double *strut_run_positions(const strut_run_scene *run, size_t frame);
/** Those as the model's coordinates, padded; NULL: no memory. */
double *strut_run_coordinates(const strut_run_scene *run, size_t frame);
/** The frame nearest to a time [s]; the earlier one of two. */
size_t strut_run_nearest(const strut_run_scene *run, double time);
/** First frame of the last periods, or of a part of what is not periodic; there are two frames at least if there are two. */
size_t strut_run_first(const strut_run_scene *run, double periods, double part);
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

/** Adds the frame's structure in colours of force, on the ground, with the forces of the ground. */
strut_shape *strut_run_add_shape(const strut_run_scene *run, strut_panel *panel, size_t frame);
/** Scale bar, and scale of the colours of force. */
void strut_run_add_scales(const strut_run_scene *run);

/** Fill in the panels of each view with what stands below them, and say what it shows. */
const char *strut_run_overview(strut_run_scene *run, strut_figure *figure);
const char *strut_run_period(strut_run_scene *run, strut_figure *figure);
const char *strut_run_snapshots(strut_run_scene *run, strut_figure *figure);
const char *strut_run_curves(strut_run_scene *run, strut_figure *figure);
