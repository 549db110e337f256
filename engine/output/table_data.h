/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A table as figures take it: named columns of numbers or texts.
 */
#ifndef STRUT_ENGINE_OUTPUT_TABLE_DATA_H
#define STRUT_ENGINE_OUTPUT_TABLE_DATA_H

#include <stddef.h>

#include "engine/base/memory.h"

typedef struct strut_table_column {
  const char *name, *unit; /* unit may be "" */
  const char *const *text; /* (rows) as written; NULL, or NULL entries, if only values are known */
  const double *value;     /* (rows), NAN for empty cells; NULL: not all are numbers */
} strut_table_column;

/** Owned by its arena. Zero-initialise. */
typedef struct strut_table {
  size_t column_count, row_count;
  strut_table_column *columns;
  strut_arena arena;
} strut_table;

#endif
