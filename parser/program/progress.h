/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A progress bar on a terminal: one line with the share done and the time left. Work in several parts
 * shows the current part in words with its share and the time spent, as the number of parts is unknown.
 */
#ifndef STRUT_PARSER_PROGRAM_PROGRESS_H
#define STRUT_PARSER_PROGRAM_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

/** Columns of the terminal on that descriptor, else the value of COLUMNS, else `usual`. */
int strut_terminal_columns(int descriptor, int usual);

typedef struct strut_progress {
  bool wanted;            /* stderr is a terminal, and --quiet is not given */
  bool colour;            /* the terminal knows escape sequences and NO_COLOR is not set */
  bool shown;             /* there is a bar to erase */
  const char *phase;      /* part of the work that the bar shows, in words; NULL: the whole */
  double run_start, last; /* of the phase's present run: clock [s] and the last fraction */
  double start;           /* [s] of the monotonic clock */
  double span;            /* simulated time of the whole [s]; 0: not shown */
  int columns;            /* of the terminal */
} strut_progress;

strut_progress strut_progress_begin(bool quiet);
/** Draws; `context` is the strut_progress, fraction 0 to 1. */
void strut_progress_show(void *context, double fraction);
/** Starts another part of the work: `context` is the strut_progress, `name` a constant text. */
void strut_progress_phase(void *context, const char *name);
/** Writes a bar of `width` columns into width + 1 bytes. */
void strut_progress_bar(char *bar, int width, double fraction);
/** Erases the bar. */
void strut_progress_end(strut_progress *progress);

#endif
