/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Numbers look the same whatever locale the host program has chosen.
 *
 * A function that reads or writes numbers as text puts its body between enter and leave; both act
 * on the calling thread only.
 */
#ifndef STRUT_ENGINE_BASE_NUMBER_TEXT_H
#define STRUT_ENGINE_BASE_NUMBER_TEXT_H

#include <stddef.h>

#include "engine/base/status.h"

/** Two opaque handles; keep it on the stack between enter and leave. */
typedef struct strut_c_locale {
  void *c, *previous;
} strut_c_locale;

/** Makes "C" the calling thread's locale. Where memory is out it changes nothing. */
STRUT_API strut_c_locale strut_c_locale_enter(void);
/** Restores what enter found. */
STRUT_API void strut_c_locale_leave(strut_c_locale locale);

/* Doubles as the shortest decimal text that reads back to the same bits, in any locale. */

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
