/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Texts that grow by cells of CSV and by base64, and files put into the program. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "engine/base/text.h"

/**
 * The text, of which no more than `length` bytes count, as a cell of CSV: RFC 4180 requires quotes around one
 * with a comma, a quote or a break. Writes up to 2 length + 2 bytes to `cell`; returns their number.
 */
STRUT_API size_t strut_csv_quote(const char *text, size_t length, char *cell);
/** Appends a cell with a printf-style text. */
STRUT_API void strut_csv_add_text(strut_buffer *csv, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/** Appends a cell with a number as its shortest text; empty for NAN. */
STRUT_API void strut_csv_add_number(strut_buffer *csv, double value);

/** Appends (count) bytes in base64, without line breaks. */
STRUT_API void strut_base64_add(strut_buffer *buffer, const void *bytes, size_t count);

/* ---- files that were put into the program at build time (EmbedFiles.cmake) ---- */

/** A file: `length` bytes of UTF-8 and a NUL. Lists of them end with a row of NULL. */
typedef struct strut_embedded {
  const char *text;
  size_t length;
} strut_embedded;
