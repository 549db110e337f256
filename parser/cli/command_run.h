/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut run: from a model to its motion, figures and files. */
#ifndef STRUT_PARSER_CLI_COMMAND_RUN_H
#define STRUT_PARSER_CLI_COMMAND_RUN_H

#include "parser/cli/options.h"

extern const strut_command strut_command_run;

#endif
