/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Numbers look the same whatever locale the host program has chosen.
 *
 * A function that reads or writes numbers as text puts its body between enter and leave; both act
 * on the calling thread only.
 */
#ifndef STRUT_ENGINE_BASE_C_LOCALE_H
#define STRUT_ENGINE_BASE_C_LOCALE_H

#include "engine/base/status.h"

/** Two opaque handles; keep it on the stack between enter and leave. */
typedef struct strut_c_locale {
  void *c, *previous;
} strut_c_locale;

/** Makes "C" the calling thread's locale. Where memory is out it changes nothing. */
STRUT_API strut_c_locale strut_c_locale_enter(void);
/** Restores what enter found. */
STRUT_API void strut_c_locale_leave(strut_c_locale locale);

#endif
