/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut write: a model as it would be run, with every value written out. */
#ifndef STRUT_PARSER_CLI_COMMAND_WRITE_H
#define STRUT_PARSER_CLI_COMMAND_WRITE_H

#include "parser/cli/options.h"

extern const strut_command strut_command_write;

#endif
