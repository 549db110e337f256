/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * `strut check STUDY`: studies stand beside models in an editor, and are checked as these are.
 */
#ifndef STRUT_PARSER_PROGRAM_CHECK_STUDY_H
#define STRUT_PARSER_PROGRAM_CHECK_STUDY_H

#include "parser/program/options.h"

/** Is the file a study? False too where it cannot be read. */
bool strut_is_study(const char *path);
/** Checks the study that the arguments name and reports on it. */
strut_status strut_check_study(const strut_command *command, const strut_arguments *arguments);

#endif
