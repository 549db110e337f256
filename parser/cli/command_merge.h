/* SPDX-License-Identifier: GPL-3.0-or-later */
/** strut merge DIR: the shards of a study become its table. */
#ifndef STRUT_PARSER_CLI_COMMAND_MERGE_H
#define STRUT_PARSER_CLI_COMMAND_MERGE_H

#include "parser/cli/options.h"

extern const strut_command strut_command_merge;

#endif
