/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The expressions of a search, whose names are columns of the study's table.
 */
#ifndef STRUT_PARSER_STUDY_STUDY_SEARCH_H
#define STRUT_PARSER_STUDY_STUDY_SEARCH_H

#include "parser/study/read_study.h"

/** A column of the table. */
typedef struct strut_table_name {
  const char *name, *unit; /* unit "" or "1": none */
  bool word;
} strut_table_name;

/**
 * Compiles the goal and the conditions of an open study that searches, for a table with these columns.
 * On STRUT_BAD_SCENE strut_study_messages has every finding.
 */
STRUT_API strut_status strut_study_search_bind(strut_study_file *file,
                                               const strut_table_name *columns, size_t count);

#endif
