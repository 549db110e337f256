/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A run's summary as JSON, as a short table for people, and as rows of a page. */
#pragma once

#include <stdbool.h>

#include "engine/base/memory.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

/* ---- a run's summary as JSON and as a short table for people ---- */

/**
 * The summary as one JSON object in a block of strut_allocate, or NULL when memory is out. The same
 * run gives the same bytes unless with_wall_time. Numbers that are not finite become null.
 */
STRUT_API char *strut_summary_json(const strut_summary *summary, const strut_scene *scene,
                                   bool with_wall_time);
/** Tables of a screenful, or in LaTeX if `width` is STRUT_REPORT_LATEX; a block of strut_allocate, or NULL. */
STRUT_API char *strut_summary_table(const strut_summary *summary, const strut_scene *scene,
                                    int width);

/* ---- rows of text, read back from summary.json ---- */

typedef struct strut_shown_row {
  const char *label, *value;
} strut_shown_row;

/** Rows of text, ready to show. Zero-initialise; release with strut_shown_free. */
typedef struct strut_shown {
  size_t count;
  strut_shown_row *list; /* (count) */
  bool failed;           /* memory was out */
  strut_arena arena;
} strut_shown;

/** Appends a row; both texts are copied. */
STRUT_API void strut_show(strut_shown *to, const char *label, const char *value);
STRUT_API void strut_shown_free(strut_shown *shown);
/**
 * Appends the rows of a summary, the text of the file, or NULL: then there are none. One that cannot be read
 * makes a row that says so.
 */
STRUT_API void strut_summary_rows(strut_shown *to, const char *summary,
                                  const strut_experiment *experiment, const strut_scene *scene);
