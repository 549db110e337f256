/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What a search for equilibria found, as one JSON object or as tables. Blocks of strut_allocate,
 * NULL when memory is out.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_EQUILIBRIA_REPORT_H
#define STRUT_ENGINE_OUTPUT_REPORT_EQUILIBRIA_REPORT_H

#include "engine/statics/equilibria/equilibria.h"

STRUT_API char *strut_equilibria_json(const strut_equilibria *equilibria, const strut_model *model);
STRUT_API char *strut_equilibria_table(const strut_equilibria *equilibria,
                                       const strut_model *model);

/** "stands", "tips", "below ground", "unstable", "floppy", "no rest". */
STRUT_API const char *strut_outcome_name(strut_outcome fate);

#endif
