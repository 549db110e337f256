/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * The parts of `strut evaluate`: requests as lines of JSON, and the files of DAKOTA.
 */
#ifndef STRUT_PARSER_PROGRAM_EVALUATE_H
#define STRUT_PARSER_PROGRAM_EVALUATE_H

#include "engine/study/sweep/evaluation.h"
#include "parser/program/options.h"
#include "parser/study/study_request.h"

/** What all evaluations of a process have in common. */
typedef struct strut_evaluate_task {
  const strut_arguments *arguments;
  const strut_study_file *file;
  strut_request_choice choice; /* of the command line */
  strut_evaluator *evaluator;
  const volatile sig_atomic_t *interrupt;
} strut_evaluate_task;

/** Answers every line. Messages about streams go to stderr. */
strut_status strut_evaluate_lines(const strut_evaluate_task *task);
/** Answers one parameters file with a results file. Messages go to stderr. */
strut_status strut_evaluate_dakota(const strut_evaluate_task *task, const char *parameters,
                                   const char *results);

#endif
