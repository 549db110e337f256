/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Doubles as the shortest decimal text that reads back to the same bits, in any locale.
 */
#ifndef STRUT_ENGINE_BASE_NUMBER_TEXT_H
#define STRUT_ENGINE_BASE_NUMBER_TEXT_H

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

#endif
