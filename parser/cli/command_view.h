/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut view: a run or a model as one HTML file. */
#ifndef STRUT_PARSER_CLI_COMMAND_VIEW_H
#define STRUT_PARSER_CLI_COMMAND_VIEW_H

#include "parser/cli/options.h"

extern const strut_command strut_command_view;

#endif
