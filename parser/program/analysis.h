/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What all commands do alike that open a model, compute something of it at rest, and report it. */
#ifndef STRUT_PARSER_PROGRAM_ANALYSIS_H
#define STRUT_PARSER_PROGRAM_ANALYSIS_H

#include "engine/model/model.h"
#include "parser/program/open_model.h"
#include "parser/program/option_values.h"

/** A model that a command has opened and compiled, and where its results go. */
typedef struct strut_analysis {
  const strut_arguments *arguments;
  const char *const *names; /* of the files that -o DIR receives: JSON, then CSV or NULL */
  strut_plot plot;
  strut_setup setup;
  strut_model *model;
} strut_analysis;

/** Computes and reports; leaves in error what was not printed yet. */
typedef strut_status (*strut_analyse)(strut_analysis *analysis, strut_error *error);

/**
 * Finds out whether all results can be written, opens the model STRUT_OPEN_FOR_ANY, compiles it and
 * calls `analyse`. Messages go to stderr.
 */
strut_status strut_analysis_run(const strut_command *command, const strut_arguments *arguments,
                                const char *const *names, strut_analyse analyse);

/** True where the JSON of results is written or printed; of large structures it takes long to make. */
bool strut_report_needs_json(const strut_arguments *arguments);

/**
 * Writes the files of -o and prints the JSON or the table: blocks of strut_allocate, which are
 * released; NULL means memory is out. csv is NULL where there is no such file, json where it is not
 * needed.
 */
strut_status strut_report(const strut_arguments *arguments, const char *const *names, char *json,
                          char *csv, char *table, strut_error *error);

#endif
