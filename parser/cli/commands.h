/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * What the program can do: its commands by name, and the help of the whole.
 */
#ifndef STRUT_PARSER_CLI_COMMANDS_H
#define STRUT_PARSER_CLI_COMMANDS_H

#include "parser/cli/options.h"

/** The command of that name, or NULL with the reason and a suggestion on stderr. */
const strut_command *strut_command_find(const char *name);

/** The help of the program as a whole, on stdout. */
void strut_program_help(void);

#endif
