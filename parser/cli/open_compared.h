/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The models that are compared: read, named, and set against the first.
 */
#ifndef STRUT_PARSER_CLI_OPEN_COMPARED_H
#define STRUT_PARSER_CLI_OPEN_COMPARED_H

#include "engine/study/compare/compare.h"
#include "parser/cli/options.h"

/** Zero-initialise. */
typedef struct strut_compared {
  size_t count;
  strut_compare_input *inputs; /* (count) */
  strut_setup *setups;         /* (count) */
  strut_arena arena;           /* of names and differences */
} strut_compared;

/**
 * Reads every model of the command line; what is wrong with any of them is told on stderr, of all at
 * once. --set goes to the models that have the parameter; STRUT_USAGE where none has. On failure
 * nothing is left to free.
 */
strut_status strut_compared_open(const strut_command *command, const strut_arguments *arguments,
                                 strut_compared *compared);
void strut_compared_free(strut_compared *compared);

#endif
