/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A shell script as a text that grows. Internal to engine/study.
 */
#ifndef STRUT_ENGINE_STUDY_CLUSTER_SCRIPT_PAGE_H
#define STRUT_ENGINE_STUDY_CLUSTER_SCRIPT_PAGE_H

#include <stdbool.h>
#include <stddef.h>

/** Zero-initialise; `text` is a block of strut_allocate. */
typedef struct strut_page {
  char *text;
  size_t length, room;
  bool failed; /* memory was out; all later writing is ignored */
} strut_page;

void strut_page_say(strut_page *page, const char *text);
/** At most 255 bytes. */
__attribute__((format(printf, 2, 3))) void strut_page_format(strut_page *page, const char *format,
                                                             ...);
/** A word that the shell takes as it stands, whatever it holds. */
void strut_page_word(strut_page *page, const char *word);
/** A line NAME='value'. */
void strut_page_assignment(strut_page *page, const char *name, const char *value);

#endif
