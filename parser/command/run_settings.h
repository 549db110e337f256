/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What options change of an experiment: method, step and span, and how accurately it is run. */
#ifndef STRUT_PARSER_COMMAND_RUN_SETTINGS_H
#define STRUT_PARSER_COMMAND_RUN_SETTINGS_H

#include "engine/scene/experiment.h"
#include "parser/command/arguments.h"

/** Tables of options that change how a scene is run without changing the file: method, step and accuracy. */
extern const strut_option strut_run_setting_options[];
/** Options that run a scene as another model of itself: rigid bars, lumped masses, other laws. */
extern const strut_option strut_fidelity_options[];
/** Rows that a run advanced from outside has, too. */
#define STRUT_FORCE_OPTION                                                                         \
  { STRUT_FILLS(force), "force", NULL, "run even if the step exceeds the stability limit" }
#define STRUT_METHOD_OPTION                                                                        \
  {                                                                                                \
    STRUT_FILLS(integrator), "integrator", "NAME",                                                 \
        "integration method, instead of that of the file", .words = STRUT_INTEGRATOR_WORDS         \
  }
#define STRUT_STEP_OPTION                                                                          \
  {                                                                                                \
    STRUT_FILLS(step), "step", "TIME", "time step, instead of that of the file",                   \
        .measure = STRUT_MEASURE_TIME, STRUT_ABOVE_ZERO                                            \
  }
#define STRUT_TOLERANCE_OPTION                                                                     \
  {                                                                                                \
    STRUT_FILLS(tolerance), "tolerance", "X", "error tolerance of adaptive and adaptive8",         \
        STRUT_ABOVE_ZERO                                                                           \
  }

/** The i-th of all these options that is given, or NULL. */
const strut_option *strut_run_option_given(const strut_arguments *arguments, size_t i);
/** What a scene is read for that is then run with them: its step may be given by them. */
strut_purpose strut_run_options_purpose(const strut_arguments *arguments);
/** Applies them to the scene and its experiment. STRUT_USAGE; the listener hears why. */
strut_status strut_run_options_apply(const strut_arguments *arguments, strut_setup *setup);

#endif
