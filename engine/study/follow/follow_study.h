/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * All branches of periodic motions of a model over one parameter: from steady motions at some of its
 * values, and where a branch doubles its period, from there.
 */
#pragma once

#include "engine/base/flag.h"
#include "engine/output/draw/chart.h"
#include "engine/output/record_files.h"
#include "engine/run/follow/follow.h"
#include "engine/scene/study.h"
#include "engine/scene/value_rows.h"

enum { STRUT_FOLLOW_KICKS = 4, STRUT_FOLLOW_MOST_BASINS = 64, STRUT_FOLLOW_MOST_CURVES = 24 };
enum { STRUT_FOLLOW_MOST_BRANCHES = 24, STRUT_FOLLOW_NOTE = 320, STRUT_FOLLOW_LABEL = 120 };

/** A motion from which a branch is followed. */
typedef struct strut_follow_start {
  double value;     /* of the parameter [SI] */
  const char *from; /* configuration at whose equilibrium the run starts; NULL: as the scene says */
} strut_follow_start;

/** A second parameter, over which curves of special points are followed. */
typedef struct strut_follow_second {
  const char *name, *unit; /* name NULL: there is none; unit "": none */
  strut_file_unit shown;   /* in figures */
  double low, high;        /* its range [SI] */
  double value;            /* where the branches are [SI] */
} strut_follow_second;

typedef struct strut_follow_options {
  const char *name, *unit; /* of the parameter; unit "": none */
  strut_file_unit shown;   /* in figures; its name lives longer than the result */
  double low, high;        /* its range [SI], low < high */
  size_t start_count;
  const strut_follow_start *starts; /* (start_count) at least one */
  strut_follow_scenes scenes;       /* of this parameter and of `second`, if there is one */
  const char *method;               /* NULL: chosen */
  double accuracy;                  /* relative, of velocities; 0: STRUT_FOLLOW_USUAL_PERCENT */
  int32_t steps;                    /* most of a branch each way; 0: STRUT_FOLLOW_USUAL_STEPS */
  int threads;
  const strut_flag *interrupt;
  void (*progress)(void *context, double fraction); /* may be NULL */
  void *progress_context;
  bool basins; /* kick the stable motions at the values of the starts */
  strut_follow_second second;
} strut_follow_options;

typedef struct strut_followed_branch {
  strut_follow_branch branch;
  char label[STRUT_FOLLOW_LABEL]; /* where it comes from */
  int32_t parent;                 /* index of the branch whose doubling it is, or -1 */
} strut_followed_branch;

/** How far a stable motion may be pushed at the start of a period. */
typedef struct strut_follow_basin {
  size_t branch; /* index */
  double value;
  /** Speeds of the smallest kicks found from which it does not come back within 60 periods [m/s];
      INFINITY: none that is sensible. */
  double kick[STRUT_FOLLOW_KICKS];
} strut_follow_basin;
/** "forwards", "backwards", "up", "down". */
STRUT_API const char *strut_follow_kick_name(int i);

typedef struct strut_follow_result {
  char *title;       /* of the model */
  char *name, *unit; /* of the parameter */
  strut_file_unit shown;
  char method[32];
  double low, high, tolerance;
  size_t count;
  strut_followed_branch branches[STRUT_FOLLOW_MOST_BRANCHES];
  size_t note_count;
  char notes[4 * STRUT_FOLLOW_MOST_BRANCHES][STRUT_FOLLOW_NOTE]; /* sentences */
  strut_arena arena;
  size_t basin_count;
  strut_follow_basin basins[STRUT_FOLLOW_MOST_BASINS];
  strut_follow_second second; /* texts belong to the result */
  size_t curve_count;
  strut_follow_branch curves[STRUT_FOLLOW_MOST_CURVES];
} strut_follow_result;

/**
 * Follows all branches. The result is to be freed in any case. STRUT_USAGE with a sentence where the
 * scene has no such motions, or none of the starts leads to a periodic one; with STRUT_INTERRUPTED the
 * result has what was followed so far, and a note.
 */
STRUT_API strut_status strut_follow_make(const strut_follow_options *options,
                                         strut_follow_result *result, strut_error *error);
/** STRUT_USAGE with a sentence where motions of the scene at the lower end cannot be followed at all. */
STRUT_API strut_status strut_follow_possible(const strut_follow_options *options,
                                             strut_error *error);
STRUT_API void strut_follow_free(strut_follow_result *result);

/** Of a result; those of curves of one with a second parameter. */
STRUT_API extern const strut_value_rows strut_follow_values, strut_follow_curves_values;

/**
 * Draws a table of branches.csv or curves.csv, whose marks it changes: velocity or amplitude over the parameter, or
 * curves in the plane of both. Stable motions are solid, unstable ones dashed, special points marked; behind `axes` of a
 * study a colour for each value of the last, a panel for each of the one before.
 */
STRUT_API strut_status strut_follow_figure(const strut_plot *plot, const char *title, size_t axes,
                                           strut_table *table, strut_error *error);
