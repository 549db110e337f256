/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What the parts of a study of branches share. Internal to engine/study/follow. */
#pragma once

#include "engine/base/flag.h"
#include "engine/output/buffer.h"
#include "engine/output/draw/figure.h"
#include "engine/output/record_files.h"
#include "engine/output/result_values.h"
#include "engine/run/follow/follow.h"
#include "engine/study/follow/follow_study.h"
#include "engine/study/sweep/sweep.h"

/** Finds the smallest kicks that a stable motion y (both) at the system's value does not survive. */
bool strut_follow_push(strut_follow_system *system, const double *unknowns,
                       strut_follow_basin *basin);
/** Adds a sentence to the result's notes. */
__attribute__((format(printf, 2, 3))) void strut_follow_note(strut_follow_result *result,
                                                             const char *format, ...);

/**
 * Follows the curves through all special points of the result's branches; `like` is an open system over the
 * first parameter with the motions' units.
 */
strut_status strut_follow_find_curves(const strut_follow_options *options,
                                      strut_follow_result *result, const strut_follow_system *like,
                                      strut_error *error);
/** Of a multiplier. */
extern const strut_value_rows strut_follow_multiplier_values;

/* A study that follows motions: all branches over a parameter at every point of its axes.
 *
 * A point's branches are the files branches/POINT.csv and branches/POINT.json of the results, its row says
 * how many there are, and what they reach. A point is done once its row is there, which is written last.
 */

/** The scene of the axes' values where the followed parameter has the value [SI]; from any thread. */
typedef struct strut_follow_points {
  strut_status (*setup)(void *context, const strut_study_value *values, double value,
                        strut_setup *setup, strut_error *error);
  void *context;
} strut_follow_points;

/** Adds the columns of a point's row behind those of the axes. */
STRUT_API strut_status strut_follow_points_columns(strut_sweep_plan *plan, strut_error *error);
/**
 * STRUT_BAD_SCENE where motions of the first point cannot be followed: its scene has no drive that repeats,
 * or a memory.
 */
STRUT_API strut_status strut_follow_points_check(const strut_sweep_plan *plan,
                                                 const strut_follow_points *points,
                                                 strut_error *error);
/**
 * Follows at every point that has no row yet, as strut_sweep_run. A failed point gets a row with the reason. With
 * STRUT_INTERRUPTED what was followed of points under way is in branches/POINT-partial.csv. Files and rows
 * depend on their point alone.
 */
STRUT_API strut_status strut_follow_points_run(const strut_sweep_plan *plan, strut_slots *slots,
                                               const strut_follow_points *points,
                                               const strut_sweep_options *options,
                                               strut_sweep_state *state, strut_error *error);

/* follow_points.c */

/**
 * Writes directory/name with the branches of all points, by point; `partial`: with what was followed of
 * interrupted points too, and a column that says which points are finished. *rows (may be NULL): how many.
 */
STRUT_API strut_status strut_follow_points_combine(const strut_sweep_plan *plan, strut_slots *slots,
                                                   const char *directory, const char *name,
                                                   bool partial, int64_t *rows, strut_error *error);
/** All reports as one JSON text in *json, a block of strut_allocate. */
STRUT_API strut_status strut_follow_points_json(const strut_sweep_plan *plan, strut_slots *slots,
                                                const char *directory, char **json,
                                                strut_error *error);
/** What people read of the rows of all points. */
typedef struct strut_follow_points_rows {
  const strut_sweep_plan *plan;
  strut_slots *slots;
} strut_follow_points_rows;
STRUT_API extern const strut_value_rows strut_follow_points_values;
