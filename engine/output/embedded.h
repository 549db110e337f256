/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Files that were put into the program at build time (EmbedFiles.cmake).
 */
#ifndef STRUT_ENGINE_OUTPUT_EMBEDDED_H
#define STRUT_ENGINE_OUTPUT_EMBEDDED_H

#include <stddef.h>

/** A file: `length` bytes of UTF-8 and a NUL. Lists of them end with a row of NULL. */
typedef struct strut_embedded {
  const char *text;
  size_t length;
} strut_embedded;

#endif
