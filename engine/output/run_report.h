/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A run's summary as JSON, as a short table for people, and as rows of a page.
 */
#ifndef STRUT_ENGINE_OUTPUT_RUN_REPORT_H
#define STRUT_ENGINE_OUTPUT_RUN_REPORT_H

#include <stdbool.h>

#include "engine/output/json_value.h"
#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

/* ---- a run's summary as JSON and as a short table for people ---- */

/**
 * The summary as one JSON object in a block of strut_allocate, or NULL when memory is out. The same
 * run gives the same bytes unless with_wall_time. Numbers that are not finite become null.
 */
STRUT_API char *strut_summary_json(const strut_summary *summary, const strut_scene *scene,
                                   bool with_wall_time);
/** A table of a screenful in a block of strut_allocate, or NULL when memory is out. */
STRUT_API char *strut_summary_table(const strut_summary *summary, const strut_scene *scene);

/* ---- rows of text, read back from summary.json ---- */

/**
 * Appends {label, value}, ready to show, to the array `to`. `summary` is the text of the file, or
 * NULL: then there are no rows. One that cannot be read makes a row that says so.
 */
STRUT_API void strut_summary_rows(strut_json *json, struct cJSON *to, const char *summary,
                                  const strut_experiment *experiment, const strut_scene *scene);

#endif
