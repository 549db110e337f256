/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What options change of an experiment: method, step and span, and how accurately it is run. */
#ifndef STRUT_PARSER_PROGRAM_COMMAND_RUN_SETTINGS_H
#define STRUT_PARSER_PROGRAM_COMMAND_RUN_SETTINGS_H

#include "engine/scene/experiment.h"
#include "parser/program/command/arguments.h"

/**
 * Tables of options that change how a scene is run without changing the file: method, step and accuracy; those of
 * them that a run has which is advanced from outside; rigid bars, lumped masses and other laws; the first and these.
 */
extern const strut_option strut_run_setting_options[], strut_method_options[],
    strut_fidelity_options[], strut_experiment_options[];
#define STRUT_FORCE_OPTION                                                                         \
  { STRUT_FILLS(force), "force", NULL, "run even if the step exceeds the stability limit" }

/** The i-th of all these options that is given, or NULL. */
const strut_option *strut_run_option_given(const strut_arguments *arguments, size_t i);
/** What a scene is read for that is then run with them: its step may be given by them. */
strut_purpose strut_run_options_purpose(const strut_arguments *arguments);
/** Applies them to the scene and its experiment. STRUT_USAGE; the listener hears why. */
strut_status strut_run_options_apply(const strut_arguments *arguments, strut_setup *setup);

#endif
