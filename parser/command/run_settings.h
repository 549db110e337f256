/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options that change how a scene is run without changing the file: method, step, accuracy.
 */
#ifndef STRUT_PARSER_COMMAND_RUN_SETTINGS_H
#define STRUT_PARSER_COMMAND_RUN_SETTINGS_H

#include "engine/base/number_text.h"
#include "engine/scene/experiment.h"
#include "parser/command/arguments.h"

/** Rows for a table of options. */
#define STRUT_RUN_SETTING_OPTIONS                                                                  \
  {STRUT_OPTION_ACCURACY, "accuracy", "X",                                                         \
   "choose method and step for a relative error of the velocity of X, such as 1%"},                \
      {STRUT_OPTION_BUDGET, "budget", "N",                                                         \
       "limit on the work of --accuracy, in units of one fine fixed-step run "                     \
       "(default " STRUT_TEXT_OF(STRUT_USUAL_BUDGET) ")"},                                         \
      {STRUT_OPTION_INTEGRATOR, "integrator", "NAME",                                              \
       "integration method, instead of that of the file"},                                         \
      {STRUT_OPTION_STEP, "step", "TIME", "time step, instead of that of the file"},               \
      {STRUT_OPTION_TOLERANCE, "tolerance", "X", "error tolerance of the method adaptive"}, {      \
    STRUT_OPTION_STEADY, "steady", "TOLERANCE",                                                    \
        "stop once the motion repeats within TOLERANCE, such as 0.5%"                              \
  }

/** Applies the options to the scene. STRUT_USAGE; the listener hears why. */
strut_status strut_run_settings_apply(const strut_command *command,
                                      const strut_arguments *arguments, strut_experiment *e);

#endif
