/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A run's summary as JSON and as a short table for people.
 */
#ifndef STRUT_ENGINE_OUTPUT_JSON_H
#define STRUT_ENGINE_OUTPUT_JSON_H

#include <stdbool.h>

#include "engine/run/measure/summary.h"
#include "engine/scene/experiment.h"

/**
 * The summary as one JSON object in a block of strut_allocate, or NULL when memory is out. The same
 * run gives the same bytes unless with_wall_time. Numbers that are not finite become null.
 */
STRUT_API char *strut_summary_json(const strut_summary *summary, const strut_scene *scene,
                                   bool with_wall_time);
/** A table of a screenful in a block of strut_allocate, or NULL when memory is out. */
STRUT_API char *strut_summary_table(const strut_summary *summary, const strut_scene *scene);

#endif
