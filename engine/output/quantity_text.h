/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A number with a unit as people like to read it: "9.78 mm/s", "110 s", "3 kN/m".
 */
#ifndef STRUT_ENGINE_OUTPUT_QUANTITY_TEXT_H
#define STRUT_ENGINE_OUTPUT_QUANTITY_TEXT_H

#include "engine/base/export.h"

enum { STRUT_QUANTITY_TEXT = 64 };

/**
 * Writes value [unit] with an SI prefix and `digits` significant digits (1 to 12), trailing zeros
 * dropped, in any locale; returns text. The unit must take a prefix ("m", "N/m"; not "kg"). "none"
 * where the value is not a number, "no limit" where it is infinite.
 */
STRUT_API const char *strut_quantity_text(double value, int digits, const char *unit,
                                          char text[STRUT_QUANTITY_TEXT]);

/** As strut_quantity_text, by value for use in one call of printf: strut_quantity_of(v, 4, "m").text. */
typedef struct strut_quantity {
  char text[STRUT_QUANTITY_TEXT];
} strut_quantity;
STRUT_API strut_quantity strut_quantity_of(double value, int digits, const char *unit);
/** As strut_quantity_of for any unit; units that take no prefix ("1", "m^2", "kg m/s") stay unchanged. */
STRUT_API strut_quantity strut_quantity_of_any(double value, int digits, const char *unit);

#endif
