/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut rigidity: self-stress, mechanisms and what they mean. */
#ifndef STRUT_PARSER_CLI_COMMAND_RIGIDITY_H
#define STRUT_PARSER_CLI_COMMAND_RIGIDITY_H

#include "parser/cli/options.h"

extern const strut_command strut_command_rigidity;

#endif
