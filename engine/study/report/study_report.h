/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What studies print and draw: texts for people or JSON, and figures of their tables.
 *
 * Texts are released by strut_release; NULL: out of memory.
 */
#pragma once

#include <stdbool.h>

#include "engine/base/flag.h"
#include "engine/output/draw/chart.h"
#include "engine/output/record_files.h"
#include "engine/scene/value_rows.h"
#include "engine/study/results/study_table.h"
#include "engine/study/search/search.h"
#include "engine/study/sensitivity/sensitivity.h"
#include "engine/study/sweep/sweep.h"
#include "engine/study/sweep/sweep_parts.h"

/** The number of points and the columns: rows of a strut_sweep_plan. */
STRUT_API extern const strut_value_rows strut_sweep_count_values;

enum { STRUT_STATUS_FAILURES = 20, STRUT_STATUS_GAPS = 20 };

/** What is done, missing and failed in a file of slots: the first ranges that are missing, the first failures. */
typedef struct strut_slots_progress {
  int64_t shard, points, done, missing, failed;
  int64_t most_points;    /* of the finest grid, of maps that are refined; 0: it is none */
  bool started, finished; /* finished: of a search */
  bool searches;          /* it is one; without gaps and failures, like a refined map */
  size_t gap_count, failure_count;
  double gaps[STRUT_STATUS_GAPS][2];
  struct strut_failed_point {
    int64_t point;
    strut_status status;
    char message[STRUT_SLOT_MESSAGE];
  } failures[STRUT_STATUS_FAILURES];
} strut_slots_progress;
STRUT_API extern const strut_value_rows strut_slots_progress_values;
STRUT_API void strut_slots_progress_find(strut_slots *slots, strut_slots_progress *progress);

/** All shards in a directory; a shard has no gaps and failures. */
typedef struct strut_shards_progress {
  size_t count;
  strut_slots_progress *shards; /* (count) of the arena */
} strut_shards_progress;
STRUT_API extern const strut_value_rows strut_shards_progress_values;
STRUT_API strut_status strut_shards_progress_find(const char *directory,
                                                  const strut_shards_found *found,
                                                  strut_arena *arena,
                                                  strut_shards_progress *progress,
                                                  strut_error *error);

/** The end of a sweep. */
typedef struct strut_sweep_end {
  const strut_sweep_state *state;
  const char *table; /* its path */
} strut_sweep_end;
STRUT_API extern const strut_value_rows strut_sweep_end_values;

/** What a search has found. */
typedef struct strut_search_report {
  const strut_sweep_plan *plan;
  const strut_study_search *search;
  const strut_search_result *result;
  strut_sweep_end end;
} strut_search_report;
STRUT_API extern const strut_value_rows strut_search_report_values;

/** Figures of recorded runs, and of a search. */
static inline bool strut_figure_of_runs(const strut_study_figure *figure) {
  return figure->kind >= STRUT_FIGURE_MOTION && figure->kind <= STRUT_FIGURE_SNAPSHOTS;
}
static inline bool strut_figure_of_search(const strut_study_figure *figure) {
  return figure->kind >= STRUT_FIGURE_BEST;
}

/**
 * Draws a figure of the study as directory/NAME.svg, of its table or of the runs recorded beside it. Of a refined
 * study, maps of the refined axes show the finest grid. `searched`: the result of a study that searches, else NULL.
 */
strut_status strut_sweep_figure(const strut_sweep_plan *plan, const char *directory,
                                const strut_study_figure *figure, const strut_table *table,
                                const strut_search_result *searched, strut_error *error);
/**
 * Draws the table sensitivity.csv of a study: of one point, indices as bars with their 95 % intervals; of several
 * along an axis of numbers, total indices and shares over it. *drawn: false where there is nothing to draw.
 */
strut_status strut_sensitivity_figure(const strut_plot *plot, const strut_study *study,
                                      const strut_table *table, bool *drawn, strut_error *error);
/** Has figures show the axes of the study's table in the units that the study gives them in. */
void strut_sweep_show_units(const strut_sweep_plan *plan, strut_table *table);
/** Draws `best` beside the start of its search into the file `path`. */
strut_status strut_search_winner_figure(const strut_sweep_plan *plan,
                                        const strut_study_figure *figure, const char *path,
                                        const strut_search_point *best, const strut_flag *interrupt,
                                        strut_error *error);
