/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What of a scene a foreign format has no words for, as a list in one sentence. */
#ifndef STRUT_ENGINE_OUTPUT_UNTOLD_H
#define STRUT_ENGINE_OUTPUT_UNTOLD_H

#include <stddef.h>
#include <stdio.h>

typedef struct strut_untold {
  char text[600]; /* empty: nothing is refused */
  size_t used;
} strut_untold;

/** Adds `what` to the list where there are any of it. */
static inline void strut_untold_add(strut_untold *r, size_t count, const char *what) {
  if (!count || r->used >= sizeof r->text - 1) return;
  int n = snprintf(r->text + r->used, sizeof r->text - r->used, "%s%s", r->used ? ", " : "", what);
  r->used += n > 0 ? (size_t)n : 0;
}

#endif
