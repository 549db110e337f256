/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STRUT_PARSER_CLI_COMMAND_SWEEP_H
#define STRUT_PARSER_CLI_COMMAND_SWEEP_H

#include "parser/cli/options.h"

/** strut sweep STUDY: runs a study's points. */
extern const strut_command strut_command_sweep;

#endif
