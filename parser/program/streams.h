/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Standard streams: reports on stdout, messages on stderr, and whether all of it was written.
 */
#ifndef STRUT_PARSER_PROGRAM_STREAMS_H
#define STRUT_PARSER_PROGRAM_STREAMS_H

#include <signal.h>

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

#endif
