/* SPDX-License-Identifier: GPL-3.0-or-later */
/** What options change of an experiment: method, step and span, and how accurately it is run. */
#ifndef STRUT_PARSER_COMMAND_RUN_SETTINGS_H
#define STRUT_PARSER_COMMAND_RUN_SETTINGS_H

#include "engine/base/number_text.h"
#include "engine/scene/experiment.h"
#include "parser/command/arguments.h"

/* Options that change how a scene is run without changing the file: method, step, accuracy. */

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
      {STRUT_OPTION_TOLERANCE, "tolerance", "X", "error tolerance of adaptive and adaptive8"}, {   \
    STRUT_OPTION_STEADY, "steady", "TOLERANCE",                                                    \
        "stop once the motion repeats within TOLERANCE, such as 0.5%"                              \
  }

/* Options that run a scene as another model of itself: rigid bars, lumped masses, other laws. */

/** Rows of a command's table of options. */
#define STRUT_FIDELITY_OPTIONS                                                                     \
  {STRUT_OPTION_BARS, "bars", "MODEL", "elastic or rigid, instead of the file's"},                 \
      {STRUT_OPTION_MASS_MODEL, "mass-model", "MODEL",                                             \
       "consistent or lumped, instead of the file's"},                                             \
      {STRUT_OPTION_FRICTION_LAW, "friction-law", "LAW",                                           \
       "none, karnopp, coulomb, smooth, stribeck or lugre, instead of the file's"},                \
  {                                                                                                \
    STRUT_OPTION_DAMPING_LAW, "damping-law", "LAW",                                                \
        "of the ground: approach_only or hunt_crossley, instead of the file's"                     \
  }

/** The i-th of all these options that is given, or NULL. */
const strut_option *strut_run_option_given(const strut_arguments *arguments, size_t i);
/** What a scene is read for that is then run with them: its step may be given by them. */
strut_purpose strut_run_options_purpose(const strut_arguments *arguments);
/** Applies them to the scene and its experiment. STRUT_USAGE; the listener hears why. */
strut_status strut_run_options_apply(const strut_command *command, const strut_arguments *arguments,
                                     strut_setup *setup);

#endif
