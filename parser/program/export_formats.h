/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Formats of `strut export` that describe a model.
 */
#ifndef STRUT_PARSER_PROGRAM_EXPORT_FORMATS_H
#define STRUT_PARSER_PROGRAM_EXPORT_FORMATS_H

#include "parser/program/options.h"

/** --format build: a list and drawings for those who build it. Messages go to stderr. */
strut_status strut_export_build(const strut_arguments *arguments);
/** --format mjcf: the model file of MuJoCo; what it does not say is listed on stderr. */
strut_status strut_export_mjcf(const strut_arguments *arguments);
/** --code DIR: the model as C that steps itself. */
strut_status strut_export_code(const strut_arguments *arguments);

#endif
