/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A comparison as a table for people, as CSV with a row for each structure, and as JSON.
 */
#ifndef STRUT_ENGINE_STUDY_COMPARE_COMPARE_REPORT_H
#define STRUT_ENGINE_STUDY_COMPARE_COMPARE_REPORT_H

#include "engine/study/compare/compare.h"

/**
 * Texts in blocks of strut_allocate; NULL: memory was out. The CPU time in them is a measurement and
 * differs from run to run; nothing else does.
 */
STRUT_API char *strut_compare_table(const strut_compare *result, int columns);
/** Units in the header; empty where there is no value. */
STRUT_API char *strut_compare_csv(const strut_compare *result);
/** With the reasons of what is empty, all states, barriers, contacts, nodes and differences. */
STRUT_API char *strut_compare_json(const strut_compare *result);

#endif
