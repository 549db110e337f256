/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/base/c_locale.h"

#include <locale.h>

strut_c_locale strut_c_locale_enter(void) {
  locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  strut_c_locale result = {(void *)c, NULL};
  if (c) result.previous = (void *)uselocale(c);
  return result;
}

void strut_c_locale_leave(strut_c_locale locale) {
  if (!locale.c) return;
  uselocale((locale_t)locale.previous);
  freelocale((locale_t)locale.c);
}
