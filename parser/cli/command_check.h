/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut check: what a model amounts to, in words and figures. */
#ifndef STRUT_PARSER_CLI_COMMAND_CHECK_H
#define STRUT_PARSER_CLI_COMMAND_CHECK_H

#include "parser/cli/options.h"

extern const strut_command strut_command_check;

#endif
