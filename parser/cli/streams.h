/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The standard streams, from their state at the start to the last byte that must arrive.
 */
#ifndef STRUT_PARSER_CLI_STREAMS_H
#define STRUT_PARSER_CLI_STREAMS_H

#include "engine/base/status.h"

/** Takes the place of streams that are closed, so that no file of results lands in it. */
void strut_streams_open(void);
/**
 * Makes sure that all of stdout has been written and returns the program's exit code: that of
 * `status`, or of file trouble instead of 0, with a message on stderr.
 */
int strut_streams_close(strut_status status);
/** Prints a text on stdout; a failure is told on stderr and returned as STRUT_FILE_TROUBLE. */
strut_status strut_print(const char *text);
/** Prints a sentence on stderr as the program's error. */
void strut_print_error(const strut_error *error);
/** The same for memory, which has nothing else to say; returns STRUT_NO_MEMORY. */
strut_status strut_print_out_of_memory(void);

#endif
