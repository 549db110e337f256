/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * strut plot TABLE: figures of tables.
 */
#ifndef STRUT_PARSER_CLI_COMMAND_PLOT_H
#define STRUT_PARSER_CLI_COMMAND_PLOT_H

#include "parser/cli/options.h"

extern const strut_command strut_command_plot;

#endif
