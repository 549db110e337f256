/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A text that grows.
 */
#ifndef STRUT_ENGINE_BASE_TEXT_BUFFER_H
#define STRUT_ENGINE_BASE_TEXT_BUFFER_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include "engine/base/status.h"

/** Zero-initialise it. */
typedef struct strut_buffer {
  char *text; /* NUL-terminated once something was added; a block of strut_allocate */
  size_t length, room;
  bool failed; /* memory was out: the text is not complete, and nothing more is added */
} strut_buffer;

/** Makes room for so many more bytes and a NUL; false: memory was out. */
STRUT_API bool strut_buffer_reserve(strut_buffer *buffer, size_t more);
/** Appends some bytes of a text. */
STRUT_API void strut_buffer_put(strut_buffer *buffer, const char *text, size_t length);
/** Appends by printf. Call between strut_c_locale_enter and leave for numbers in the C locale. */
STRUT_API void strut_buffer_add(strut_buffer *buffer, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
STRUT_API void strut_buffer_add_list(strut_buffer *buffer, const char *format, va_list arguments)
    __attribute__((format(printf, 2, 0)));
/** Returns the text, to be released by the caller, and zeroes the buffer; NULL if memory was out. */
STRUT_API char *strut_buffer_take(strut_buffer *buffer);

#endif
