/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the runs of a study recorded, where it has `trajectories: yes`: as a table, and as pictures.
 */
#ifndef STRUT_ENGINE_STUDY_SWEEP_STUDY_RUNS_H
#define STRUT_ENGINE_STUDY_SWEEP_STUDY_RUNS_H

#include "engine/output/record_files.h"
#include "engine/study/sweep/sweep.h"

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

#endif
