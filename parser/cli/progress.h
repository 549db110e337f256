/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A bar with how far it is and the time left, on a terminal only; one line, as wide as there is
 * room.
 */
#ifndef STRUT_PARSER_CLI_PROGRESS_H
#define STRUT_PARSER_CLI_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

typedef struct strut_progress {
  bool wanted;        /* stderr is a terminal and nobody asked for quiet */
  bool colour;        /* the terminal knows escape sequences and NO_COLOR is not set */
  bool shown;         /* there is a bar to erase */
  bool unicode;       /* the locale writes UTF-8: the bar is made of blocks */
  const char *phase;  /* the part of the work that the bar is for, or NULL: there is one part */
  double phase_start; /* when that began [s] */
  double start;       /* [s] of the monotonic clock */
  double span;        /* simulated time that the whole stands for [s]; 0: it is not told */
  int columns;        /* of the terminal */
} strut_progress;

strut_progress strut_progress_begin(bool quiet);
/** Draws; `context` is the strut_progress, fraction 0 to 1. */
void strut_progress_show(void *context, double fraction);
/** Another part of the work begins: `context` is the strut_progress, `name` a constant text. */
void strut_progress_phase(void *context, const char *name);
/** "2 min 03 s" */
void strut_progress_time(char *text, size_t size, double seconds);
/** A bar of so many columns into 3 * width + 1 bytes: in blocks down to an eighth, or in ASCII. */
void strut_progress_bar(char *bar, int width, double fraction, bool unicode);
/** Erases the bar. */
void strut_progress_end(strut_progress *progress);

#endif
