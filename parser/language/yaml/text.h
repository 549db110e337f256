/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Characters and places in a UTF-8 text.
 *
 * Lines end where libyaml ends them: at LF, CR, CR LF, NEL (U+0085), LS (U+2028) and PS (U+2029).
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** What strut_text_decode gives for a byte that is not part of valid UTF-8. */
#define STRUT_BAD_CODE UINT32_MAX

/** Reads one code point; returns its bytes (1 to 4). A bad byte: STRUT_BAD_CODE and 1. left >= 1. */
size_t strut_text_decode(const char *text, size_t left, uint32_t *code);
/** Bytes of the line break that begins here (1 to 3), or 0. */
size_t strut_text_break(const char *text, size_t left);
/** Code points in text[0..length); a bad byte counts as one. */
size_t strut_text_points(const char *text, size_t length);
/** Bytes of a byte order mark at the beginning: 3 or 0. */
size_t strut_text_mark(const char *text, size_t length);
/** "UTF-16" or "UTF-32" where the text begins with the byte-order mark of one of them, else NULL. */
const char *strut_text_wide(const char *text, size_t length);
/** True for a code point that no text may hold: controls except tab and breaks, U+FEFF, ... */
bool strut_text_forbidden(uint32_t code);
/** True for a code point of a valid text that a terminal does not show but acts on: what turns the direction of
    writing, breaks lines or is a tag. */
bool strut_text_hidden(uint32_t code);

/** A position that moves forward only. It starts after a byte order mark. */
typedef struct strut_cursor {
  const char *text;
  size_t length, offset; /* bytes */
  size_t index;          /* code points before it */
  uint32_t line, column; /* from 1; columns count code points */
} strut_cursor;

strut_cursor strut_cursor_begin(const char *text, size_t length);
/** Advances by one code point or line break; false at the end. */
bool strut_cursor_step(strut_cursor *cursor);
/** Advances until the byte offset is at least `offset`. */
void strut_cursor_to_offset(strut_cursor *cursor, size_t offset);
/** Advances until the number of code points before it is at least `index`. */
void strut_cursor_to_index(strut_cursor *cursor, size_t index);
/** Advances to the beginning of the line with that number, or to the end of the text. */
void strut_cursor_to_line(strut_cursor *cursor, uint32_t line);
