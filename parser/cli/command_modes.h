/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut modes: natural frequencies and shapes at an equilibrium. */
#ifndef STRUT_PARSER_CLI_COMMAND_MODES_H
#define STRUT_PARSER_CLI_COMMAND_MODES_H

#include "parser/cli/options.h"

extern const strut_command strut_command_modes;

#endif
