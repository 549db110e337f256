/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A path of equilibria as a table for people, as JSON, and as a curve in CSV.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_PATH_REPORT_H
#define STRUT_ENGINE_OUTPUT_REPORT_PATH_REPORT_H

#include "engine/statics/path/path.h"

/** Texts in blocks of strut_allocate; NULL: memory was out. */
STRUT_API char *strut_path_json(const strut_path *path, const strut_scene *scene);
STRUT_API char *strut_path_table(const strut_path *path, const strut_scene *scene);
/**
 * One row per point: the parameter ("factor" and, of loads that are alike, "force [N]"; else "value"
 * with its unit), arc, eigenvalues below zero as the path goes on; x and y of every node [m], tension
 * of every member, reactions of what is held, normal forces of contacts [N]. Events stand among the
 * points with their kind in the column "event".
 */
STRUT_API char *strut_path_csv(const strut_path *path, const strut_scene *scene);

#endif
