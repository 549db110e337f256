/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Doubles as the shortest decimal text that reads back to the same bits, in any locale.
 */
#ifndef STRUT_ENGINE_BASE_NUMBER_TEXT_H
#define STRUT_ENGINE_BASE_NUMBER_TEXT_H

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

#endif
