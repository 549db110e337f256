/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options that change how a scene is run without changing the file: method, step, accuracy.
 */
#ifndef STRUT_PARSER_CLI_RUN_SETTINGS_H
#define STRUT_PARSER_CLI_RUN_SETTINGS_H

#include "engine/scene/scene.h"
#include "parser/cli/options.h"

/** Rows of a command's table of options. */
#define STRUT_RUN_SETTING_OPTIONS                                                                  \
  {STRUT_OPTION_ACCURACY, "accuracy", "X",                                                         \
   "choose method and step so that the velocity is right to X, such as 1%"},                       \
      {STRUT_OPTION_BUDGET, "budget", "N",                                                         \
       "work that --accuracy may take, in fine runs by a fixed step; 20 if not given"},            \
      {STRUT_OPTION_INTEGRATOR, "integrator", "NAME", "the method, instead of the file's"},        \
      {STRUT_OPTION_STEP, "step", "TIME", "the time step, instead of the file's"},                 \
      {STRUT_OPTION_TOLERANCE, "tolerance", "X", "of the method adaptive"}, {                      \
    STRUT_OPTION_STEADY, "steady", "TOLERANCE",                                                    \
        "stop when the motion repeats itself within TOLERANCE, such as 0.5%"                       \
  }

/** Puts the options into the experiment. STRUT_USAGE with the reason on stderr. */
strut_status strut_run_settings_apply(const strut_command *command,
                                      const strut_arguments *arguments, strut_experiment *e);

#endif
