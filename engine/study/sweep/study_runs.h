/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the runs of a study recorded, where it has `trajectories: yes`: as a table, and as pictures.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_STUDY_RUNS_H
#define STRUT_ENGINE_STUDY_SWEEP_STUDY_RUNS_H

#include "engine/output/record_files.h"
#include "engine/output/trajectory.h"
#include "engine/study/sweep/sweep.h"

/** An opened run. */
typedef struct strut_study_run {
  int64_t point;
  const strut_study_value *values; /* (axis columns of the plan) */
  const char *const *texts;        /* the same as texts */
  const strut_scene *scene;
  const strut_trajectory *motion;
} strut_study_run;

/** The i-th name of the columns behind those of the axes, or NULL after the last; "node" is first. */
STRUT_API const char *strut_study_motion_column(size_t i);

/**
 * The motion as a table in an arena of its own: for each run in turn a row for each time and node,
 * with the columns of the axes and `node`, `time`, `elapsed`, `x`, `y`, `dx`, `dy`. Only the rows that
 * the figure draws, as far as its `only`, `from` and `to` say so. Numbers of runs have no texts.
 * STRUT_USAGE where there are none, or too many; STRUT_NO_MEMORY, STRUT_FILE_TROUBLE.
 */
STRUT_API strut_status strut_study_motion(const strut_sweep_plan *plan, const char *directory,
                                          const strut_study_figure *figure, strut_table *table,
                                          strut_error *error);
/**
 * Draws each run by itself into directory/NAME.svg, or NAME-TEXT-TEXT.svg after the axes along which they
 * differ (what is zipped by its first); with `difference` those of the second text, the others dashed over
 * them. As strut_study_motion.
 */
STRUT_API strut_status strut_study_pictures(const strut_sweep_plan *plan, const char *directory,
                                            const strut_study_figure *figure, double width,
                                            strut_error *error);

/** An opened run, from which pictures and motions are drawn. Zero-initialise. */
typedef struct strut_study_opened {
  strut_study_run run;
  strut_study_value *values;
  const char **texts;
  strut_setup setup;
  strut_trajectory motion;
  strut_arena arena;
} strut_study_opened;
/** Does the figure's `only` select this text of a column? */
STRUT_API bool strut_study_shows(const strut_study_figure *figure, const char *column,
                                 const char *text);
/**
 * Opens the run of a point. *there is false where it recorded nothing, or the figure leaves it out;
 * nothing is open then. Close it after a failure too.
 */
STRUT_API strut_status strut_study_run_open(const strut_sweep_plan *plan, const char *directory,
                                            const strut_study_figure *figure, int64_t point,
                                            strut_study_opened *opened, bool *there,
                                            strut_error *error);
STRUT_API void strut_study_run_close(strut_study_opened *opened);

#endif
