/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut equilibria: all shapes of a model at rest, and what becomes of each on the ground. */
#ifndef STRUT_PARSER_CLI_COMMAND_EQUILIBRIA_H
#define STRUT_PARSER_CLI_COMMAND_EQUILIBRIA_H

#include "parser/cli/options.h"

extern const strut_command strut_command_equilibria;

#endif
