/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What studies print and draw: texts for people or JSON, and figures of their tables.
 *
 * Texts are released by strut_release; NULL: out of memory.
 */
#ifndef STRUT_ENGINE_STUDY_REPORT_STUDY_REPORT_H
#define STRUT_ENGINE_STUDY_REPORT_STUDY_REPORT_H

#include <stdbool.h>

#include "engine/base/flag.h"
#include "engine/output/record_files.h"
#include "engine/scene/value_rows.h"
#include "engine/study/results/study_table.h"
#include "engine/study/search/search.h"
#include "engine/study/sensitivity/sensitivity.h"
#include "engine/study/sweep/sweep.h"
#include "engine/study/sweep/sweep_parts.h"

/** The number of points and the columns. */
char *strut_sweep_count_report(const strut_sweep_plan *plan, bool json);
/** What is done, missing and failed in a file of slots. */
char *strut_sweep_status_report(strut_slots *slots, bool json);
/** The end of a sweep; `table`: its path. */
char *strut_sweep_end_report(const strut_sweep_state *state, const char *table, bool json);
/** A line, or an object of a JSON list, for each started or missing shard: *text. */
strut_status strut_shards_report(const char *directory, const strut_shards_found *found,
                                 strut_arena *arena, bool json, char **text, strut_error *error);
/** What a search has found; `table`: the path of its rows. */
char *strut_search_report(const strut_sweep_plan *plan, const strut_search_result *result,
                          const strut_sweep_state *state, const char *table, bool json);
STRUT_API extern const strut_value_rows strut_search_report_values;
/** What a sensitivity analysis has found; `directory` has its table. */
char *strut_sensitivity_report(const strut_sweep_plan *plan, strut_slots *slots,
                               const strut_sensitivity_result *result, const char *directory);

/**
 * Draws a figure of the study as directory/NAME.svg, of its table or of the runs recorded beside it. Of a refined
 * study, maps of the refined axes show the finest grid; refinement may be NULL.
 */
strut_status strut_sweep_figure(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *figure, const strut_table *table,
                                const strut_refinement *refinement, strut_error *error);
/** Draws a figure of a search, of its table, into the file `path`. */
strut_status strut_search_figure(const strut_sweep_plan *plan, const strut_study_figure *figure,
                                 const char *path, const strut_table *table, strut_error *error);
/** Draws `best` beside the start of its search into the file `path`. */
strut_status strut_search_winner_figure(const strut_sweep_plan *plan,
                                        const strut_study_figure *figure, const char *path,
                                        const strut_search_point *best, double width,
                                        const strut_flag *interrupt, strut_error *error);

#endif
