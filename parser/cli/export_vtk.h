/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * strut export RUN|MODEL --format vtk -o DIR.
 */
#ifndef STRUT_PARSER_CLI_EXPORT_VTK_H
#define STRUT_PARSER_CLI_EXPORT_VTK_H

#include "parser/cli/options.h"

/** Writes all frames of a run, or one of a model's shape, and says what it wrote. */
strut_status strut_export_vtk(const strut_command *command, const strut_arguments *arguments);

#endif
