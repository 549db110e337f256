/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A study: one model at many points, as a plain description.
 *
 * Points are the product of all axes, the last axis fastest. An axis gives one or several
 * parameters of the model, by a list or by a range that is never expanded, so that a billion points
 * need no memory. Variants of the model are the first axis, with the single column "variant". Texts
 * and arrays are owned by the creator of the study.
 */
#ifndef STRUT_ENGINE_SCENE_STUDY_H
#define STRUT_ENGINE_SCENE_STUDY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/base/export.h"

/** Most points of a study, and most values of one list. */
#define STRUT_STUDY_MOST_POINTS ((int64_t)1000000000)

/** Form of the values of an axis. */
typedef enum strut_range_kind {
  STRUT_RANGE_LIST, /* number, or word where the parameter is a text */
  STRUT_RANGE_EVEN, /* count values from `from` to `to`, both among them */
  STRUT_RANGE_STEP, /* from + i * step: `to` is not one of them */
  STRUT_RANGE_RATIO /* as EVEN, of the logarithms */
} strut_range_kind;

/** One parameter along its axis. */
typedef struct strut_study_column {
  const char *name, *unit; /* unit "1": none */
  bool word;               /* a text parameter: a LIST of words */
  strut_range_kind kind;
  double from, to, step;    /* SI */
  const double *number;     /* (count of the axis) of a LIST */
  const char *const *words; /* (count of the axis) of a LIST of words */
} strut_study_column;

/** Value of a parameter at a point. */
typedef struct strut_study_value {
  double number;    /* SI */
  const char *word; /* of a text parameter, else NULL */
} strut_study_value;

typedef struct strut_study_axis {
  int64_t count; /* values, >= 1 */
  size_t column_count;
  strut_study_column *columns; /* (column_count) they go together */
} strut_study_axis;

/**
 * Values kept of the summary of a run: X(NAME, word of the language), in the order of the table.
 */
#define STRUT_KEEP_TABLE(X)                                                                        \
  X(VELOCITY, "velocity")                                                                          \
  X(SPREAD, "velocity_spread")                                                                     \
  X(INTERVAL, "velocity_interval")                                                                 \
  X(MOTION, "motion")                                                                              \
  X(REPEATS, "repeats")                                                                            \
  X(PERIODS, "periods")                                                                            \
  X(DISTANCE, "distance")                                                                          \
  X(DURATION, "duration")                                                                          \
  X(SETTLE_TIME, "settle_time")                                                                    \
  X(STEPS, "steps")                                                                                \
  X(EVALUATIONS, "force_evaluations")                                                              \
  X(CHECKS, "check_evaluations")                                                                   \
  X(EVENTS, "events")                                                                              \
  X(METHOD, "method")                                                                              \
  X(STEP, "step")                                                                                  \
  X(STEP_LIMIT, "step_limit")                                                                      \
  X(EXPECTED, "expected_error")                                                                    \
  X(ENERGY, "energy")                                                                              \
  X(WORK, "work")                                                                                  \
  X(LOSSES, "losses")                                                                              \
  X(RESIDUAL, "residual")                                                                          \
  X(CONTACTS, "contacts")                                                                          \
  X(POSITIONS, "positions")                                                                        \
  X(OUTCOME, "outcome")                                                                            \
  X(QUANTITIES, "quantities")                                                                      \
  X(KEPT, "accuracy_kept")

typedef enum strut_keep {
#define STRUT_KEEP_ENUM(name, word) STRUT_KEEP_##name,
  STRUT_KEEP_TABLE(STRUT_KEEP_ENUM)
#undef STRUT_KEEP_ENUM
      STRUT_KEEP_COUNT
} strut_keep;

/** Kinds of figures, in the order of the language. */
typedef enum strut_study_figure_kind {
  STRUT_FIGURE_LINES,    /* of the table: x, y, series */
  STRUT_FIGURE_MAP,      /* of the table: x, y, color */
  STRUT_FIGURE_MOTION,   /* lines of recorded runs, node by node */
  STRUT_FIGURE_PERIOD,   /* node trajectories over the last period of each run */
  STRUT_FIGURE_SNAPSHOTS /* shapes of each run */
} strut_study_figure_kind;

/** Colour scale of a map, as strut_colours of the figures. */
typedef enum strut_study_colours {
  STRUT_STUDY_COLOURS_AUTO,
  STRUT_STUDY_COLOURS_SEQUENTIAL,
  STRUT_STUDY_COLOURS_DIVERGING,
  STRUT_STUDY_COLOURS_GREY
} strut_study_colours;

/** A figure of the table or of recorded runs. */
typedef struct strut_study_figure {
  const char *name;
  strut_study_figure_kind kind;
  /* columns of the table; NULL where none is named */
  const char *x, *y, *series, *color, *panels, *difference;
  const char *band, *only;         /* "COLUMN=TEXT", or NULL */
  const char *title;               /* or NULL */
  const char *x_label, *y_label;   /* or NULL: the columns' names */
  double x_limits[2], y_limits[2]; /* in the columns' units; 0, 0: from the data */
  strut_study_colours colours;     /* of a MAP */
  double from, to;                 /* of MOTION [s]; without limits infinite */
  double scale[2];                 /* of PERIOD; 0: 1 */
  size_t time_count;               /* of SNAPSHOTS; 0: six */
  const double *times;             /* (time_count) [s] */
} strut_study_figure;

typedef struct strut_study {
  const char *name, *description, *model; /* model: its file, from the study's folder */
  size_t axis_count, figure_count;
  strut_study_axis *axes;
  unsigned keep; /* bits 1 << strut_keep; 0: what is usual, if no quantity is kept either */
  size_t quantity_count;
  const char **quantities; /* (quantity_count) measured quantities that are kept by name */
  bool trajectories;       /* a directory of results for each run */
  bool half_step;          /* run each point again with half the step */
  double check_accuracy;   /* or with this accuracy; 0: not */
  strut_study_figure *figures;
} strut_study;

#endif
