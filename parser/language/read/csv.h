/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Tables as text: comma-separated cells (RFC 4180) below a header such as "velocity [m/s]".
 */
#ifndef STRUT_PARSER_LANGUAGE_READ_CSV_H
#define STRUT_PARSER_LANGUAGE_READ_CSV_H

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "parser/language/yaml/diagnostics.h"

/** A name and the unit in brackets behind it; "" without. */
typedef struct strut_csv_title {
  const char *name, *unit;
} strut_csv_title;

/** A table as cells; all of it is in the arena, which the caller frees. */
typedef struct strut_csv {
  size_t column_count, row_count; /* without the header */
  strut_csv_title *titles;        /* (column_count) */
  const char **cell;              /* (1 + row_count, column_count), the header first */
  strut_place *place;             /* likewise */
  strut_arena arena;
} strut_csv;

/**
 * Reads a text. STRUT_BAD_SCENE where it is empty, has no rows or lines of different length, as the
 * diagnostics say, whose source it must be; STRUT_NO_MEMORY. The arena must be freed after a failure too.
 */
STRUT_API strut_status strut_csv_read(const char *text, size_t length,
                                      strut_diagnostics *diagnostics, strut_csv *csv);

/** A number, or NAN for an empty cell, "nan", "null", "none" and "-"; false for any other text. */
STRUT_API bool strut_csv_number(const char *text, double *value);

#endif
