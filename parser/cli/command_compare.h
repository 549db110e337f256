/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut compare: any number of structures side by side. */
#ifndef STRUT_PARSER_CLI_COMMAND_COMPARE_H
#define STRUT_PARSER_CLI_COMMAND_COMPARE_H

#include "parser/cli/options.h"

extern const strut_command strut_command_compare;

#endif
