/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * A study opened for a command: read, its extremes tried, its columns and its identity known.
 */
#ifndef STRUT_PARSER_CLI_SWEEP_STUDY_H
#define STRUT_PARSER_CLI_SWEEP_STUDY_H

#include "engine/study/sweep/sweep.h"
#include "parser/cli/options.h"
#include "parser/study/read_study.h"

/** Stays where it is while in use. Zero-initialise; strut_sweep_study_close releases it. */
typedef struct strut_sweep_study {
  strut_study_file file;
  strut_sweep_plan plan;
  strut_slots_plan slots; /* of all points in one file */
} strut_sweep_study;

/**
 * Opens the study that the command's argument names. Messages go to stderr; close it after a failure
 * too. The first point and the ends of every axis must make a model.
 */
strut_status strut_sweep_study_open(const strut_arguments *arguments, strut_sweep_study *study);
void strut_sweep_study_close(strut_sweep_study *study);

#endif
