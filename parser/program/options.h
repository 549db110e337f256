/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The command line: one table of options per command defines both its parsing and the help text.
 *
 * Abbreviated option names are rejected: accepting one today could make a new option ambiguous.
 */
#pragma once

#include "engine/output/draw/chart.h"
#include "parser/program/command/arguments.h"
#include "parser/program/command/plot_options.h"

/** Parses argv[1..] of a command. STRUT_USAGE with the reason on stderr. */
strut_status strut_arguments_read(const strut_command *command, int argc, char **argv,
                                  strut_arguments *arguments);
void strut_arguments_free(strut_arguments *arguments);

/** The i-th option of a command, those of every command last; NULL after them. */
const strut_option *strut_option_at(const strut_command *command, size_t i);

/** The option that "--NAME", "--NAME=VALUE" or "-LETTER" is, and in *value what follows the name; NULL: none. */
const strut_option *strut_option_of(const strut_command *command, char *word, char **value);

/** The form of the command that one of its arguments words[0..count) selects, or the command itself. */
const strut_command *strut_command_variant_of(const strut_command *command, int count,
                                              char **words);

/** Prints the help of a command on stdout. */
void strut_command_help(const strut_command *command);

/* Rows that tables of several commands have. */

#define STRUT_SET_OPTION                                                                           \
  { STRUT_FILLS(overrides), "set", "NAME=VALUE", "change a parameter; may be repeated" }
#define STRUT_PRINT_OPTIONS                                                                        \
  {STRUT_FILLS(json), "json", NULL, "print everything as one JSON object"}, {                      \
    STRUT_FILLS(format), "format", "FORMAT", "print tables as text (default) or latex",            \
        .words = "text|latex"                                                                      \
  }
#define STRUT_THREADS_OPTION                                                                       \
  {                                                                                                \
    STRUT_FILLS(threads), "threads", "N",                                                          \
        "maximum number of threads (default: one per processor)", .least = 1, .most = 4096         \
  }
#define STRUT_OUTPUT_OPTION(ARGUMENT, HELP)                                                        \
  { STRUT_FILLS(output), "output", ARGUMENT, HELP, .letter = 'o' }
/** The figure of a command: its file, width and title. */
extern const strut_option strut_plot_options[];

/**
 * Reads all before anything is computed, and checks that FILE can be written: STRUT_USAGE or
 * STRUT_FILE_TROUBLE with the reason on stderr, an option without --plot included. Leaves no trace.
 * `usual` is the default width [pt]; 0: a page's.
 */
strut_status strut_plot_read(const strut_arguments *arguments, double usual, strut_plot *plot);
