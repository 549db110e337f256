/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Options that run a scene as another model of itself: rigid bars, lumped masses, other laws.
 */
#ifndef STRUT_PARSER_COMMAND_FIDELITY_SETTINGS_H
#define STRUT_PARSER_COMMAND_FIDELITY_SETTINGS_H

#include "engine/scene/experiment.h"
#include "parser/command/arguments.h"

/** Rows of a command's table of options. */
#define STRUT_FIDELITY_OPTIONS                                                                     \
  {STRUT_OPTION_BARS, "bars", "MODEL", "elastic or rigid, instead of the file's"},                 \
      {STRUT_OPTION_MASS_MODEL, "mass-model", "MODEL",                                             \
       "consistent or lumped, instead of the file's"},                                             \
      {STRUT_OPTION_FRICTION_LAW, "friction-law", "LAW",                                           \
       "none, karnopp, coulomb or smooth, instead of the file's"},                                 \
  {                                                                                                \
    STRUT_OPTION_DAMPING_LAW, "damping-law", "LAW",                                                \
        "of the ground: approach_only or hunt_crossley, instead of the file's"                     \
  }

/** Puts the options into the experiment. STRUT_USAGE; the listener hears why. */
strut_status strut_model_options_apply(const strut_command *command,
                                       const strut_arguments *arguments, strut_scene *scene);

#endif
