/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Tables as text: cells separated by commas, semicolons or tabs (RFC 4180) below a header such as "velocity [m/s]". */
#pragma once

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "parser/language/expression/expression.h"
#include "parser/language/yaml/document.h"

/** A name and the unit in brackets behind it, or on the line below; "" without. */
typedef struct strut_csv_title {
  const char *name, *unit;
} strut_csv_title;

/** A table as cells; all of it is in the arena, which the caller frees. The text must outlive it. */
typedef struct strut_csv {
  size_t column_count, row_count; /* without the header */
  strut_csv_title *titles;        /* (column_count) */
  char **cell;                    /* (1 + row_count, column_count), the names first */
  const char *text, *copy;        /* as given; with its cells terminated */
  strut_arena arena;
} strut_csv;

/** As many header lines as the file shows. */
enum { STRUT_CSV_ANY_HEADER = 0 };

/**
 * Reads a text whose first `header` lines are its header; the names are on the last of them that has no
 * units. Lines below it that are empty or begin with # are left out. STRUT_BAD_SCENE where it is empty, has
 * no rows or lines of different length, as the diagnostics say, whose source it must be; STRUT_NO_MEMORY. The
 * arena must be freed after a failure too.
 */
STRUT_API strut_status strut_csv_read(const char *text, size_t length, int header,
                                      strut_diagnostics *diagnostics, strut_csv *csv);

/** The place of a cell, by its number in csv->cell. */
STRUT_API strut_place strut_csv_place(const strut_csv *csv, size_t cell);

/**
 * A number times 10^decimal, rounded once, or NAN for an empty cell, "nan", "NA", "null", "none" and "-";
 * false for any other text.
 */
STRUT_API bool strut_csv_number(const char *text, int decimal, double *value);
/** What one of a unit is, of "mm" or "1/(240 Hz)"; false where the text is none. */
bool strut_csv_unit(const char *text, strut_quantity *one);
/** "1" or "-" */
bool strut_csv_is_dimensionless(const char *text);
