/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Natural frequencies and shapes as JSON, as a table for people, and as CSV.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_MODES_REPORT_H
#define STRUT_ENGINE_OUTPUT_REPORT_MODES_REPORT_H

#include "engine/statics/modes/modes.h"

/** Blocks of strut_allocate, or NULL when memory is out. */
STRUT_API char *strut_modes_json(const strut_model *model, const strut_modes *modes);
STRUT_API char *strut_modes_table(const strut_model *model, const strut_modes *modes);
/** A row for each mode, shapes left out. */
STRUT_API char *strut_modes_csv(const strut_modes *modes);

#endif
