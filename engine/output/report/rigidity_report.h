/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The report of strut rigidity, as JSON and as a table.
 */
#ifndef STRUT_ENGINE_OUTPUT_REPORT_RIGIDITY_REPORT_H
#define STRUT_ENGINE_OUTPUT_REPORT_RIGIDITY_REPORT_H

#include "engine/statics/rigidity/rigidity.h"

/** Both in a block of strut_allocate, or NULL: out of memory. `at` is the name of the shape. */
STRUT_API char *strut_rigidity_json(const strut_rigidity *rigidity, const strut_model *model,
                                    const char *at);
STRUT_API char *strut_rigidity_table(const strut_rigidity *rigidity, const strut_model *model,
                                     const char *at);

#endif
