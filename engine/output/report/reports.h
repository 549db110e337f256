/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Reports of statics: tables that fit a screen, JSON and CSV, each in a block of strut_allocate. */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_REPORTS_H
#define STRUT_ENGINE_OUTPUT_REPORT_REPORTS_H

#include "engine/model/model.h"
#include "engine/statics/equilibria/equilibria.h"
#include "engine/statics/form/form.h"
#include "engine/statics/modes/modes.h"
#include "engine/statics/modes/waves.h"
#include "engine/statics/path/path.h"
#include "engine/statics/rigidity/rigidity.h"

/*
 * What a search for equilibria found, as one JSON object or as tables. Blocks of strut_allocate,
 * NULL when memory is out.
 */

/** Lists the equilibria that stand and their barriers; with `all` every equilibrium and its shape. */
STRUT_API char *strut_equilibria_table(const strut_equilibria *equilibria, const strut_model *model,
                                       bool all);

/* ---- a form that was found, as a table and as JSON ---- */

/** Texts in blocks of strut_allocate; NULL: memory was out. The scene is the one found. */
STRUT_API char *strut_form_table(const strut_form *form, const strut_setup *setup);

/* ---- natural frequencies and shapes as JSON, as a table for people, and as CSV ---- */

/** Blocks of strut_allocate, or NULL when memory is out. */
STRUT_API char *strut_modes_table(const strut_model *model, const strut_modes *modes);

/* ---- waves of a structure that repeats: bands, gaps, speeds; CSV has the samples along the zone ---- */

/** Blocks of strut_allocate, or NULL when memory is out. */
STRUT_API char *strut_waves_table(const strut_model *model, const strut_waves *waves);

/* ---- a path of equilibria as a table for people, as JSON, and as a curve in CSV ---- */

/** Texts in blocks of strut_allocate; NULL: memory was out. */
STRUT_API char *strut_path_table(const strut_path *path, const strut_scene *scene);
/**
 * One row per point: the parameter ("factor" and, of loads that are alike, "force [N]"; else "value"
 * with its unit), arc, eigenvalues below zero beyond the point; x and y of every node [m], tension
 * of every member, reactions of what is held, normal forces of contacts [N]. Events stand among the
 * points with their kind in the column "event".
 */
STRUT_API char *strut_path_csv(const strut_path *path, const strut_scene *scene);

/* ---- the report of strut rigidity, as JSON and as a table ---- */

/** Both in a block of strut_allocate, or NULL: out of memory. `at` is the name of the shape. */
STRUT_API char *strut_rigidity_table(const strut_rigidity *rigidity, const strut_model *model,
                                     const char *at);

#endif
