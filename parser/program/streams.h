/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Standard streams: reports on stdout, messages on stderr, and whether all of it was written. */
#pragma once

#include <signal.h>
#include <stdbool.h>

#include "engine/base/flag.h"
#include "engine/base/status.h"
#include "parser/program/options.h"

/**
 * Opens /dev/null for standard streams that are closed, so that no file of results gets their place. Hidden
 * characters of names (strut_text_hidden) appear on stderr, and on stdout where that is a terminal, as "\u202E".
 */
void strut_streams_open(void);
/**
 * Flushes stdout and returns the program's exit code: that of `status`, or of file trouble instead of
 * 0 where not everything could be written, with a message on stderr.
 */
int strut_streams_close(strut_status status);
/** Prints a text on stdout; a failure is reported on stderr and returned as STRUT_FILE_TROUBLE. */
strut_status strut_print(const char *text);
/** Prints a block of strut_allocate and releases it; NULL is reported as out of memory. */
strut_status strut_print_block(char *text);
/** As strut_print_block, but --quiet suppresses the text unless it is JSON or CSV. */
strut_status strut_print_report(const strut_arguments *arguments, char *text);
/** Prints a sentence on stderr as the program's error. */
void strut_print_error(const strut_error *error);
/** Prints the error unless `status` is STRUT_OK; returns `status`. */
strut_status strut_print_failure(strut_status status, const strut_error *error);
/** Reports on stderr that memory is out; returns STRUT_NO_MEMORY. */
strut_status strut_print_out_of_memory(void);

/** Prints every message on stderr. */
const strut_listener *strut_stderr_listener(void);

/** From now on SIGINT and SIGTERM set the flag that is returned; a moment later they kill. */
const strut_flag *strut_interrupt_watch(void);

/*
 * A progress bar on a terminal: one line with the share done and the time left. Work in several parts
 * shows the current part in words with its share and the time spent, as the number of parts is unknown.
 */

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
