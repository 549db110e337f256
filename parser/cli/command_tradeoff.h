/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut tradeoff: what an answer costs, by method, step and model. */
#ifndef STRUT_PARSER_CLI_COMMAND_TRADEOFF_H
#define STRUT_PARSER_CLI_COMMAND_TRADEOFF_H

#include "parser/cli/options.h"

extern const strut_command strut_command_tradeoff;

#endif
