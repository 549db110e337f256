/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Copies of a study and of its model beside its results, so that their directory stands for itself.
 */
#ifndef STRUT_PARSER_CLI_SWEEP_TEXTS_H
#define STRUT_PARSER_CLI_SWEEP_TEXTS_H

#include "parser/cli/sweep_study.h"

/**
 * STRUT_USAGE where the copies would take the place of other files of the user's: results go into
 * the study's own folder, and one of the names is taken there.
 */
strut_status strut_sweep_texts_check(const strut_arguments *arguments,
                                     const strut_sweep_study *study, strut_error *error);
/** Writes study.yaml and model.yaml into the directory of the results, which exists. */
strut_status strut_sweep_texts_write(const strut_arguments *arguments,
                                     const strut_sweep_study *study, strut_error *error);

#endif
