/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * strut sweep --emit: the script that runs a study on a cluster.
 */
#ifndef STRUT_PARSER_CLI_SWEEP_EMIT_H
#define STRUT_PARSER_CLI_SWEEP_EMIT_H

#include "parser/cli/options.h"

/** Prints the script for the study of that name. */
strut_status strut_sweep_emit(const strut_arguments *arguments, const char *name);

#endif
