/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Texts: numbers as text in any locale, and a text that grows. */
#pragma once

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include "engine/base/status.h"

/** A constant as the code writes it, for help texts. */
#define STRUT_TEXT_OF(constant) STRUT_LITERAL_OF(constant)
#define STRUT_LITERAL_OF(literal) #literal

/** Room that any text of strut_number_text fits in, its NUL included. */
enum { STRUT_NUMBER_TEXT = 32 };

/**
 * Writes value with a decimal point and the fewest digits that identify it (of those the nearest to
 * it), NUL-terminated; returns the length. "0.1", "-0", "1e-07" is "1e-7"; "nan", "inf", "-inf".
 */
STRUT_API size_t strut_number_text(double value, char text[STRUT_NUMBER_TEXT]);

/** Room that any text of strut_duration_text fits in. */
enum { STRUT_DURATION_TEXT = 32 };
/** Writes a time in whole seconds such as "2 min 03 s"; "?" for 1e7 s and more. */
STRUT_API void strut_duration_text(double seconds, char text[STRUT_DURATION_TEXT]);

/* ---- a number with a unit as people like to read it: "9.78 mm/s", "110 s", "3 kN/m" ---- */

enum { STRUT_QUANTITY_TEXT = 64 };

/** A text by value, for use in one call of printf: strut_quantity_of(v, 4, "m").text. */
typedef struct strut_rounded_quantity {
  char text[STRUT_QUANTITY_TEXT];
} strut_rounded_quantity;
/**
 * The value [unit] with an SI prefix and `digits` significant digits (1 to 12), trailing zeros dropped, in any
 * locale. The unit must take a prefix ("m", "N/m"; not "kg"). "none" where the value is not a number, "no limit" where
 * it is infinite.
 */
STRUT_API strut_rounded_quantity strut_quantity_of(double value, int digits, const char *unit);
/** Does the unit take a prefix? "m", "N/m", "Hz"; not "1", "m^2", "kg", nor one that has a prefix, such as "mm". */
STRUT_API bool strut_unit_takes_prefix(const char *unit);
/** As strut_quantity_of for any unit; one that takes no prefix stays unchanged. */
STRUT_API strut_rounded_quantity strut_quantity_of_any(double value, int digits, const char *unit);

/** The unit that a file gives a number in, such as mm, which figures show it in. */
typedef struct strut_file_unit {
  const char *name; /* NULL: none is known */
  double size;      /* in the SI unit */
} strut_file_unit;
/** That of a number in an SI unit; where the file has none, angles are shown in degrees. */
STRUT_API strut_file_unit strut_unit_shown(const char *unit, strut_file_unit given);
/** As strut_quantity_of_any, in the unit of the file if there is one. */
STRUT_API strut_rounded_quantity strut_quantity_shown(double value, int digits, const char *unit,
                                                      strut_file_unit given);

/*
 * Numbers look the same whatever locale the host program has chosen.
 *
 * A function that reads or writes numbers as text puts its body between enter and leave; both act
 * on the calling thread only.
 */

/** Two opaque handles; keep it on the stack between enter and leave. */
typedef struct strut_c_locale {
  void *c, *previous;
} strut_c_locale;

/** Makes "C" the calling thread's locale. Where memory is out it changes nothing. */
STRUT_API strut_c_locale strut_c_locale_enter(void);
/** Restores what enter found. */
STRUT_API void strut_c_locale_leave(strut_c_locale locale);

/* A text that grows. */

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
