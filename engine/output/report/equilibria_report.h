/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a search for equilibria found, as one JSON object or as tables. Blocks of strut_allocate,
 * NULL when memory is out.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_EQUILIBRIA_REPORT_H
#define STRUT_ENGINE_OUTPUT_REPORT_EQUILIBRIA_REPORT_H

#include "engine/statics/equilibria/equilibria.h"

STRUT_API char *strut_equilibria_json(const strut_equilibria *equilibria, const strut_model *model);
/** Lists the equilibria that stand and their barriers; with `all` every equilibrium and its shape. */
STRUT_API char *strut_equilibria_table(const strut_equilibria *equilibria, const strut_model *model,
                                       bool all);

/** Oddities of a shape: coinciding nodes, crossing members. */
typedef struct strut_shape_flaws {
  bool collapsed;    /* two nodes coincide, or a member has no length, within 1e-4 model sizes */
  int32_t crossings; /* pairs of members that cross, away from their ends */
} strut_shape_flaws;

/** q: (length) positions [m]. */
STRUT_API strut_shape_flaws strut_find_shape_flaws(const strut_model *model, const double *q);

/** "stands", "tips", "below ground", "unstable", "floppy", "no rest". */
STRUT_API const char *strut_outcome_name(strut_outcome fate);

#endif
