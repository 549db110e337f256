/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut form: shapes in equilibrium, and the rest lengths that hold them. */
#ifndef STRUT_PARSER_CLI_COMMAND_FORM_H
#define STRUT_PARSER_CLI_COMMAND_FORM_H

#include "parser/cli/options.h"

extern const strut_command strut_command_form;

#endif
