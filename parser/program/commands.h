/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The program's commands (in files command_*.c), and the table that finds them by name. */
#pragma once

#include "engine/scene/value_rows.h"
#include "parser/program/options.h"

extern const strut_command strut_command_check;
extern const strut_command strut_command_compare;
extern const strut_command strut_command_equilibria;
extern const strut_command strut_command_examples;
extern const strut_command strut_command_export;
extern const strut_command strut_command_form;
extern const strut_command strut_command_keys;
extern const strut_command strut_command_modes;
extern const strut_command strut_command_path;
extern const strut_command strut_command_plot;
extern const strut_command strut_command_rigidity;
extern const strut_command strut_command_run;
extern const strut_command strut_command_sweep;
extern const strut_command strut_command_tradeoff;
extern const strut_command strut_command_view;

/* Forms of commands. */

extern const strut_command strut_command_merge;
extern const strut_command strut_command_periodic;
extern const strut_command strut_command_schema;

/** The i-th command, or NULL after the last. */
const strut_command *strut_command_at(size_t i);
/** The command of that name, or NULL. */
const strut_command *strut_command_named(const char *name);
/** The same, with the reason and a suggestion on stderr. */
const strut_command *strut_command_find(const char *name);

/** Is it the name of a section or a key of the language, which `strut keys` explains? */
bool strut_keys_know(const char *name);

/** Prints the help of the whole program on stdout. */
void strut_program_help(void);

/** Calls `each` with FOLDER/NAME.yaml of every model that comes with strut, in order. */
void strut_examples_list(void (*each)(void *context, const char *model), void *context);

/** Width of what is printed. */
int strut_report_width(const strut_arguments *arguments);
/** Prints a result as JSON where that is wanted, or else as text unless --quiet suppresses it. */
strut_status strut_print_values(const strut_arguments *arguments, const strut_value_rows *rows,
                                const void *result, const struct strut_scene *scene);

/**
 * Runs a command by its analysis: finds out whether all results can be written, opens and compiles the model,
 * computes, writes, prints and draws. Messages go to stderr.
 */
strut_status strut_analysis_run(const strut_arguments *arguments);
/** Opens the model that the arguments name for statics. */
strut_status strut_analysis_open(struct strut_analysis *analysis, char **text);

/** Prints the words that complete the last of `words` (count >= 0), which may be empty. */
strut_status strut_complete(int count, char **words);
