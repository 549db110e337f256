/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut keys: every key of the language. */
#ifndef STRUT_PARSER_CLI_COMMAND_KEYS_H
#define STRUT_PARSER_CLI_COMMAND_KEYS_H

#include "parser/cli/options.h"

extern const strut_command strut_command_keys;

#endif
