/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A tradeoff as a table for people, as JSON and as CSV.
 */
#ifndef STRUT_ENGINE_STUDY_TRADEOFF_TRADEOFF_REPORT_H
#define STRUT_ENGINE_STUDY_TRADEOFF_TRADEOFF_REPORT_H

#include "engine/study/tradeoff/tradeoff.h"

/**
 * Texts in blocks of strut_allocate; NULL: memory was out. CPU times in them are measurements: they
 * differ from run to run, everything else does not while the budget suffices.
 */
STRUT_API char *strut_tradeoff_table(const strut_tradeoff *result);
/** setups: the operating points, whose parameters are told. */
STRUT_API char *strut_tradeoff_json(const strut_tradeoff *result, const strut_setup *const *setups);
/** One row per setting, the spreads over the operating points; diverged: "inf". */
STRUT_API char *strut_tradeoff_csv(const strut_tradeoff *result);

#endif
