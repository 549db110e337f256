/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut export: a model's matrices for other programs. */
#ifndef STRUT_PARSER_CLI_COMMAND_EXPORT_H
#define STRUT_PARSER_CLI_COMMAND_EXPORT_H

#include "parser/cli/options.h"

extern const strut_command strut_command_export;

#endif
