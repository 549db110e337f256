/* SPDX-License-Identifier: GPL-3.0-or-later */
/** A path of equilibria as a curve in CSV. */
#ifndef STRUT_ENGINE_OUTPUT_PATH_CSV_H
#define STRUT_ENGINE_OUTPUT_PATH_CSV_H

#include "engine/statics/path/path.h"

/**
 * In a block of strut_allocate, NULL where memory was out: one row per point: the parameter ("factor" and, of loads that are alike, "force [N]"; else "value"
 * with its unit), arc, eigenvalues below zero beyond the point; x and y of every node [m], tension
 * of every member, reactions of what is held, normal forces of contacts [N]. Events stand among the
 * points with their kind in the column "event".
 */
STRUT_API char *strut_path_csv(const strut_path *path, const strut_scene *scene);

#endif
