/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The command line: one table of options per command defines both its parsing and the help text.
 *
 * Abbreviated option names are rejected: accepting one today could make a new option ambiguous.
 */
#ifndef STRUT_PARSER_PROGRAM_OPTIONS_H
#define STRUT_PARSER_PROGRAM_OPTIONS_H

#include "parser/command/arguments.h"

/** Parses argv[1..] of a command. STRUT_USAGE with the reason on stderr. */
strut_status strut_arguments_read(const strut_command *command, int argc, char **argv,
                                  strut_arguments *arguments);
void strut_arguments_free(strut_arguments *arguments);

/** The i-th option of a command, those of every command last; NULL after them. */
const strut_option *strut_option_at(const strut_command *command, size_t i);

/** Prints the help of a command on stdout. */
void strut_command_help(const strut_command *command);

#endif
