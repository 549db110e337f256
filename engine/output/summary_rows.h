/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a run amounts to as rows of text, read back from its summary.json.
 */
#ifndef STRUT_ENGINE_OUTPUT_SUMMARY_ROWS_H
#define STRUT_ENGINE_OUTPUT_SUMMARY_ROWS_H

#include "engine/output/json_value.h"
#include "engine/scene/experiment.h"

/**
 * Appends {label, value}, ready to show, to the array `to`. `summary` is the text of the file, or
 * NULL: then there are no rows. One that cannot be read makes a row that says so.
 */
STRUT_API void strut_summary_rows(strut_json *json, struct cJSON *to, const char *summary,
                                  const strut_experiment *experiment, const strut_scene *scene);

#endif
