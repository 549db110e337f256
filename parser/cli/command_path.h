/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut path: equilibria as a load grows, past limit points. */
#ifndef STRUT_PARSER_CLI_COMMAND_PATH_H
#define STRUT_PARSER_CLI_COMMAND_PATH_H

#include "parser/cli/options.h"

extern const strut_command strut_command_path;

#endif
